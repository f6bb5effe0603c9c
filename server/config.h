/// The settings of the daemon. Each comes from a flag, else from an environment variable, else from its default.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "api/operations.h"
#include "server/http/allowed_hosts.h"
#include "server/http/client_address.h"
#include "server/http/connection_limits.h"
#include "server/http/cors.h"
#include "server/http/key_limits.h"
#include "server/http/public_url.h"
#include "server/http/units.h"
#include "server/jobs/job_settings.h"
#include "server/observe/log.h"

namespace remesh::server {

struct Config {
  Address bind{"127.0.0.1", 8080};
  std::optional<Address> ops_bind;  ///< a separate port for liveness, readiness and metrics
  std::string api_key_file;         ///< empty if there is none
  std::string api_key;  ///< read from the environment only, because a flag would show in the list of processes
  KeyRules key_rules;
  bool allow_anonymous = false;  ///< permits listening beyond loopback without any API key
  Cors cors;
  AllowedHosts allowed_hosts;
  PublicUrl public_url;
  TrustedProxies trusted_proxies;

  /// Meshes up to this many corners are computed on one thread. Below this size, a second thread makes a request no
  /// faster and takes time from other requests. Measured on boxes: 2,000 faces take 1.14 ms on one thread and 1.26 ms
  /// on two, 3,900 take 2.13 and 2.08, 8,100 take 3.7 and 3.3.
  static constexpr std::size_t kSerialCorners = 3 * 4096;

  api::Limits limits{.serial_corners = kSerialCorners};
  int max_running = 0;  ///< 0 until it is set; the default is the number of workers
  std::uint64_t memory_budget = 1ull << 30;
  std::chrono::milliseconds drain_time{25'000};
  jobs::JobSettings jobs;  ///< the default of the store on the command line is `sqlite` instead

  ConnectionLimits connections;
  /// The folder for large answers to slow readers. `auto` means the folder of the job store, else the temporary folder.
  std::string spool_dir = "auto";
  std::uint64_t max_spooled = 8ull << 30;

  log::Format log_format = log::Format::kAuto;
  log::Level log_level = log::Level::kInfo;
};

/// The action that the command line asks for.
enum class Command { kServe, kHealth, kPrintConfig, kCheckConfig, kExit };

struct Invocation {
  Command command = Command::kServe;
  int exit_code = 0;  ///< set for kExit: 0 after help or version, 2 if the configuration is wrong
  Config config;
};

/// Reads the command line and the environment. The text of `--help` and `--version` goes to `out`, and error messages
/// go to `err`.
Invocation read_command_line(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

/// The name of a role on the command line.
std::string role_name(jobs::Role role);

/// Environment variables whose names begin like settings but that are no settings. They are most likely misspelt.
std::vector<std::string> unknown_variables();

/// All settings as lines of `flag=value`.
std::string print_config(const Config& config);

}  // namespace remesh::server
