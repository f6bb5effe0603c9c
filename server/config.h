/// What the daemon is told at its start: flag, else environment variable, else default.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "api/service.h"
#include "server/http/cors.h"
#include "server/http/gate.h"
#include "server/http/units.h"
#include "server/jobs/job_settings.h"
#include "server/observe/log.h"

namespace remesh::server {

struct Config {
  Address bind{"127.0.0.1", 8080};
  std::optional<Address> ops_bind;  ///< liveness, readiness and metrics on a port of their own
  std::string api_key_file;         ///< empty: none
  std::string api_key;              ///< from the environment only: a flag would show in the list of processes
  bool allow_anonymous = false;     ///< to listen beyond loopback, as long as there are no keys to ask for
  Cors cors;

  int workers = 1;
  std::uint64_t max_body = 256ull << 20;
  std::uint64_t max_decompressed = 1024ull << 20;
  std::uint64_t max_ratio = 100;
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
  std::uint64_t max_output_faces = 50'000'000;
  int max_running = 0;         ///< 0 while not told: the workers' number
  std::size_t queue_size = 0;  ///< 0 while not told: 4 a worker, at least 16
  std::uint64_t memory_budget = 1ull << 30;
  std::chrono::milliseconds request_timeout{300'000};
  std::chrono::milliseconds drain_time{25'000};
  jobs::JobSettings jobs;  ///< the command line's default for its store is another: `sqlite`

  std::size_t max_connections = 512;
  std::size_t max_connections_per_address = 64;
  std::chrono::milliseconds idle_timeout{3'000};  ///< 0: no connection is kept
  GateLimits gate;

  log::Format log_format = log::Format::kAuto;
  log::Level log_level = log::Level::kInfo;

  api::Limits api_limits() const;
};

/// What the command line asks for.
enum class Command { kServe, kHealth, kPrintConfig, kCheckConfig, kExit };

struct Invocation {
  Command command = Command::kServe;
  int exit_code = 0;  ///< of kExit: help or version was printed, or the configuration is wrong
  Config config;
};

/// Reads command line and environment; `--help`, `--version` and complaints go to `out` and `err`.
Invocation read_command_line(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

/// The names that `role` has on the command line.
std::string role_name(jobs::Role role);

/// Variables of the environment that look like settings and are none: misspelt, most likely.
std::vector<std::string> unknown_variables();

/// All settings, one `flag=value` a line.
std::string print_config(const Config& config);

}  // namespace remesh::server
