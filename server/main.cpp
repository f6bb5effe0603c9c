/// The program remeshd: configuration, the daemon and signals. Everything else is in the library.
#include <sys/resource.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <vector>

#include "core/base/version.h"
#include "server/config.h"
#include "server/daemon.h"
#include "server/http_server.h"
#include "server/observe/heap_tops.h"
#include "server/observe/log.h"

namespace remesh::server {
namespace {

/// The exit codes for failure and for misuse. 0 means success.
constexpr int kFailed = 1, kMisuse = 2;

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

/// Raises the limit of open descriptors. Shells set 1024 but permit more, which --max-connections may need.
void raise_descriptor_limit() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

void reload_keys(Daemon& daemon) {
  try {
    daemon.reload_keys();
    log::write(log::Level::kInfo, "keys read again");
  } catch (const std::exception& error) {
    log::write(log::Level::kError, "API keys cannot be read again, so all keys of the file are refused until they can",
               {{"error", std::string(error.what())}});
  }
}

/// Waits for one of the signals.
/// Output: its number, or 0 if the time is over.
int wait_for_signal(const sigset_t& signals, std::optional<std::chrono::milliseconds> time) {
  if (!time) {
    int number = 0;
    while (sigwait(&signals, &number) != 0) {
    }
    return number;
  }
  const timespec span{time->count() / 1000, (time->count() % 1000) * 1'000'000};
  const int number = sigtimedwait(&signals, nullptr, &span);
  return number > 0 ? number : 0;
}

/// Returns how much of the time for draining is for running work. The rest is for stopping what is left then: cancelled
/// work may take two seconds to stop, and its answers one to be sent.
std::chrono::milliseconds time_for_work(std::chrono::milliseconds drain_time) {
  constexpr std::chrono::milliseconds kForStopping{3000};
  return std::max(drain_time - kForStopping, drain_time / 4);
}

/// Adds the settings in force that help to understand a failure.
void add_settings(const Config& config, const Daemon& daemon, std::vector<log::Field>& fields) {
  fields.push_back({"workers", std::int64_t{config.limits.workers}});
  fields.push_back({"max_running", std::int64_t{config.max_running}});
  fields.push_back({"queue_size", static_cast<std::int64_t>(config.limits.queue.max_large)});
  fields.push_back({"memory_budget", format_bytes(config.memory_budget)});
  fields.push_back({"keys", static_cast<std::int64_t>(daemon.key_count())});
  fields.push_back({"role", role_name(config.jobs.role)});
  fields.push_back({"store", daemon.keeps_jobs() ? jobs::without_password(config.jobs.store) : "none"});
  if (!daemon.keeps_jobs()) return;
  if (config.jobs.store == "sqlite") fields.push_back({"state_dir", jobs::find_state_dir(config.jobs.state_dir)});
  if (!config.jobs.blob_dir.empty()) fields.push_back({"blob_dir", config.jobs.blob_dir});
}

int serve(const Config& config) {
  // The signals are blocked before any thread exists, including the log's, so that all threads inherit the mask and
  // only this thread waits for them. This also makes it possible to stop process 1 of a container, where unhandled
  // signals are ignored.
  sigset_t signals = stop_signals();
  sigaddset(&signals, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is then an error of write()
  ::umask(S_IRWXG | S_IRWXO);     // the files that are written contain customers' meshes
  raise_descriptor_limit();
  log::set_up(config.log_format, config.log_level);

  Daemon daemon(config, Operations{});
  daemon.start();
  std::vector<log::Field> fields{{"address", Address{config.bind.host, daemon.port()}.text()}};
  if (config.ops_bind) fields.push_back({"ops_address", Address{config.ops_bind->host, daemon.ops_port()}.text()});
  fields.push_back({"version", std::string(remesh::version())});
  add_settings(config, daemon, fields);
  log::write(log::Level::kInfo, "listening", fields);
  for (const std::string& name : unknown_variables())
    log::write(log::Level::kWarning, "no setting has this variable", {{"variable", name}});

  while (wait_for_signal(signals, std::nullopt) == SIGHUP) reload_keys(daemon);
  log::write(log::Level::kInfo, "draining", {{"at_most", format_duration(config.drain_time)}});
  daemon.begin_drain();
  const Clock::time_point deadline = Clock::now() + time_for_work(config.drain_time);
  while (!daemon.is_idle() && Clock::now() < deadline) {
    const int again = wait_for_signal(stop_signals(), std::chrono::milliseconds(20));
    if (again != 0) break;  // a second signal ends the wait at once
  }
  daemon.stop();
  log::write(log::Level::kInfo, "stopped");
  return EXIT_SUCCESS;
}

/// Asks the server at the configured address. If a server listens on all addresses, it is asked on loopback.
int ask_health(const Config& config) {
  Address address = config.ops_bind.value_or(config.bind);
  if (address.host == "0.0.0.0") address.host = "127.0.0.1";
  if (address.host == "::") address.host = "::1";
  const int status = probe(address, "/livez");
  if (status == 200) return EXIT_SUCCESS;
  std::cerr << "remeshd: " << address.text() << (status == 0 ? " does not answer" : " answers, but is not healthy")
            << "\n";
  return kFailed;
}

/// The settings are valid, since the command line was read. Refuses variables that are none: the daemon would start
/// without what their author wanted.
int check_variables() {
  const std::vector<std::string> unknown = unknown_variables();
  for (const std::string& name : unknown) std::cerr << "remeshd: no setting has the variable " << name << "\n";
  if (!unknown.empty()) return kMisuse;
  std::cout << "the configuration is valid\n";
  return EXIT_SUCCESS;
}

int run(int argc, char** argv) {
  const Invocation invocation = read_command_line(argc, argv, std::cout, std::cerr);
  switch (invocation.command) {
    case Command::kExit: return invocation.exit_code;
    case Command::kHealth: return ask_health(invocation.config);
    case Command::kPrintConfig: std::cout << print_config(invocation.config); return EXIT_SUCCESS;
    case Command::kCheckConfig: return check_variables();
    case Command::kServe: break;
  }
  return serve(invocation.config);
}

}  // namespace
}  // namespace remesh::server

int main(int argc, char** argv) {
  // The allocator would raise these thresholds by itself after a large mesh. Until then it would return memory and
  // request it again several times in each request. Unused memory is returned between requests instead (MemoryWatch).
  remesh::server::HeapTops::set_thresholds();
  try {
    // TBB's threads must end last, because until then they own memory that the pools gave them.
    tbb::task_scheduler_handle scheduler{tbb::attach{}};
    const int code = remesh::server::run(argc, argv);
    tbb::finalize(scheduler, std::nothrow);
    return code;
  } catch (const std::exception& error) {
    std::cerr << "remeshd: " << error.what() << "\n";
    return remesh::server::kFailed;
  }
}
