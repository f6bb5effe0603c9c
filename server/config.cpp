#include "server/config.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <stdexcept>

#include "api/machine_limits.h"
#include "api/quoting.h"
#include "core/remesh.h"
#include "server/http/api_keys.h"
#include "server/jobs/database.h"
#include "server/work/memory_budget.h"

namespace remesh::server {
namespace {

/// One setting, with the functions that parse and show it. The table of all settings below defines the configuration.
struct Setting {
  std::string flag;
  std::string help;
  std::function<void(Config&, const std::string&)> set;
  std::function<std::string(const Config&)> get;
  bool is_switch = false;

  std::string variable() const {
    std::string name = "REMESHD_" + flag.substr(2);
    for (char& c : name) c = c == '-' ? '_' : c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return name;
  }
};

std::uint64_t at_least(std::uint64_t least, std::uint64_t value) {
  if (value < least) throw std::invalid_argument("it must be at least " + std::to_string(least));
  return value;
}

std::uint64_t between(std::uint64_t least, std::uint64_t most, std::uint64_t value) {
  if (value > most) throw std::invalid_argument("it must be at most " + std::to_string(most));
  return at_least(least, value);
}

std::chrono::milliseconds positive_duration(const std::string& text) {
  const std::chrono::milliseconds duration = parse_duration(text);
  if (duration.count() == 0) throw std::invalid_argument("it must be more than 0");
  return duration;
}

bool parse_bool(const std::string& text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  throw std::invalid_argument("\"" + text + "\" is neither true nor false");
}

template <typename T>
struct Choice {
  const char* name;
  T value;
};
const std::vector<Choice<log::Format>> kFormats{
    {"auto", log::Format::kAuto}, {"text", log::Format::kText}, {"json", log::Format::kJson}};
const std::vector<Choice<log::Level>> kLevels{{"debug", log::Level::kDebug},
                                              {"info", log::Level::kInfo},
                                              {"warning", log::Level::kWarning},
                                              {"error", log::Level::kError},
                                              {"off", log::Level::kOff}};

const std::vector<Choice<jobs::Role>> kRoles{
    {"serve", jobs::Role::kServe}, {"work", jobs::Role::kWork}, {"both", jobs::Role::kBoth}};

template <typename T>
T parse_choice(const std::vector<Choice<T>>& choices, const std::string& text) {
  std::string names;
  for (const Choice<T>& choice : choices) {
    if (text == choice.name) return choice.value;
    names += std::string(names.empty() ? "" : ", ") + choice.name;
  }
  throw std::invalid_argument("\"" + text + "\" is not one of: " + names);
}

template <typename T>
std::string choice_name(const std::vector<Choice<T>>& choices, T value) {
  const auto choice = std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.value == value; });
  return choice->name;
}

Setting bytes(std::string flag, std::string help, std::uint64_t& (*member)(Config&)) {
  return {std::move(flag), std::move(help),
          [member](Config& c, const std::string& text) { member(c) = at_least(1, parse_bytes(text)); },
          [member](Config c) { return format_bytes(member(c)); }};
}
/// A limit that can be absent, which is stored as 0.
Setting byte_limit(std::string flag, std::string help, std::uint64_t& (*member)(Config&)) {
  return {
      std::move(flag), std::move(help),
      [member](Config& c, const std::string& text) { member(c) = text == "none" ? 0 : at_least(1, parse_bytes(text)); },
      [member](Config c) { return member(c) == 0 ? "none" : format_bytes(member(c)); }};
}
/// A number that can be absent, which is stored as 0.
Setting count_limit(std::string flag, std::string help, std::uint64_t& (*member)(Config&)) {
  return {std::move(flag), std::move(help),
          [member](Config& c, const std::string& text) {
            member(c) = text == "none" ? 0 : between(1, 1'000'000, parse_count(text));
          },
          [member](Config c) { return member(c) == 0 ? "none" : format_count(member(c)); }};
}
Setting count(std::string flag, std::string help, std::uint64_t& (*member)(Config&)) {
  // Setting this limit higher would have no effect, because the core numbers elements with 32 bits.
  return {std::move(flag), std::move(help),
          [member](Config& c, const std::string& text) { member(c) = between(1, 2'000'000'000, parse_count(text)); },
          [member](Config c) { return format_count(member(c)); }};
}
Setting duration(std::string flag, std::string help, std::chrono::milliseconds& (*member)(Config&)) {
  return {std::move(flag), std::move(help),
          [member](Config& c, const std::string& text) { member(c) = positive_duration(text); },
          [member](Config c) { return format_duration(member(c)); }};
}

/// Errors: std::invalid_argument - the text names no kind of store.
std::string checked_store(const std::string& text) {
  if (text != "sqlite" && text != "none") jobs::make_postgres_driver(text);
  return text;
}

const std::vector<Setting>& settings() {
  static const std::vector<Setting> table{
      {"--bind", "address and port to listen on", [](Config& c, const auto& text) { c.bind = parse_address(text); },
       [](const Config& c) { return c.bind.text(); }},
      {"--ops-bind", "address and port of a second listener for /livez, /readyz and /metrics (none: off)",
       [](Config& c, const auto& text) {
         c.ops_bind = text == "none" ? std::nullopt : std::optional(parse_address(text));
       },
       [](const Config& c) { return c.ops_bind ? c.ops_bind->text() : "none"; }},
      {"--allow-anonymous",
       "permit listening on addresses beyond loopback without an API key; then everyone who can reach the "
       "address may use this server",
       [](Config& c, const auto& text) { c.allow_anonymous = parse_bool(text); },
       [](const Config& c) { return c.allow_anonymous ? "true" : "false"; }, true},
      {"--api-key-file",
       "file with one API key per line, which may have a name before it (NAME KEY); a client must send one of them "
       "(none: no key is required); read again on SIGHUP",
       [](Config& c, const auto& text) { c.api_key_file = text == "none" ? "" : text; },
       [](const Config& c) { return c.api_key_file.empty() ? "none" : c.api_key_file; }},
      count_limit(
          "--max-running-per-key",
          "largest number of requests with work of one API key at the same time, and of its jobs that run at the same "
          "time in the whole store (none: no limit); beyond it requests are answered with 429, and jobs wait",
          [](Config & c) -> auto& { return c.key_rules.max_running; }),
      count_limit(
          "--max-rate-per-key",
          "largest number of requests with work of one API key in a minute, of which all may come at once (none: no "
          "limit); beyond it 429",
          [](Config & c) -> auto& { return c.key_rules.max_rate; }),
      {"--cors-origin",
       "origins of web pages that may use this server from a browser, separated by commas; *: all origins (none: "
       "no page of another site)",
       [](Config& c, const auto& text) { c.cors = text == "none" ? Cors() : Cors(text); },
       [](const Config& c) { return c.cors.text(); }},
      {"--allowed-hosts",
       "if no API key is required: DNS names, separated by commas, under which this server may be addressed, "
       "besides IP addresses and localhost; *: all names (none: no further name)",
       [](Config& c, const auto& text) { c.allowed_hosts = text == "none" ? AllowedHosts() : AllowedHosts(text); },
       [](const Config& c) { return c.allowed_hosts.text(); }},
      {"--public-url", "URL under which clients reach this server through a proxy (none: the URL of each request)",
       [](Config& c, const auto& text) { c.public_url = text == "none" ? PublicUrl() : PublicUrl(text); },
       [](const Config& c) { return c.public_url.text(); }},
      {"--trusted-proxies",
       "addresses and networks of proxies, separated by commas, whose header fields X-Forwarded-For, Forwarded "
       "and X-Forwarded-Prefix are trusted, and whose connections are not limited by address (none: no proxy is "
       "trusted)",
       [](Config& c, const auto& text) {
         c.trusted_proxies = text == "none" ? TrustedProxies() : TrustedProxies(text);
       },
       [](const Config& c) { return c.trusted_proxies.text(); }},
      {"--workers", "threads for one request (default: the cores that this process may use)",
       [](Config& c, const auto& text) { c.limits.workers = static_cast<int>(between(1, 1024, parse_count(text))); },
       [](const Config& c) { return std::to_string(c.limits.workers); }},
      {"--max-running",
       "largest number of requests that compute at the same time; while all of them take long, up to the same "
       "number of small requests may compute as well (default: the number of workers)",
       [](Config& c, const auto& text) { c.max_running = static_cast<int>(between(1, 1024, parse_count(text))); },
       [](const Config& c) { return std::to_string(c.max_running); }},
      {"--queue-size",
       "largest number of requests with bodies over 1 MiB that wait for a worker; smaller requests are limited "
       "by their total size and expected waiting time (default: 4 per worker, at least 16)",
       [](Config& c, const auto& text) { c.limits.queue.max_large = between(1, 1'000'000, parse_count(text)); },
       [](const Config& c) { return std::to_string(c.limits.queue.max_large); }},
      duration(
          "--request-timeout", "longest computing time of a request",
          [](Config & c) -> auto& { return c.limits.request_timeout; }),
      bytes(
          "--max-body", "largest size of a request's body", [](Config & c) -> auto& { return c.limits.max_body; }),
      bytes(
          "--max-decompressed", "largest size of a gzip body, or of a gzip mesh in a body, after decompression",
          [](Config & c) -> auto& { return c.limits.decompression.max_bytes; }),
      {"--max-ratio", "largest ratio of decompressed to compressed size; the first MiB does not count",
       [](Config& c, const auto& text) { c.limits.decompression.max_ratio = between(1, 1'000'000, parse_count(text)); },
       [](const Config& c) { return std::to_string(c.limits.decompression.max_ratio); }},
      count(
          "--max-vertices", "largest number of vertices of an input mesh",
          [](Config & c) -> auto& { return c.limits.input.max_vertices; }),
      count(
          "--max-faces", "largest number of faces of an input mesh",
          [](Config & c) -> auto& { return c.limits.input.max_faces; }),
      count(
          "--max-output-faces", "largest number of faces of a result",
          [](Config & c) -> auto& { return c.limits.max_output_faces; }),
      bytes(
          "--memory-budget",
          "memory that all requests together may use (default: 70 % of the memory that this "
          "process may use)",
          [](Config & c) -> auto& { return c.memory_budget; }),
      {"--store", "store of jobs: sqlite, a URL postgres://..., or none (there are no jobs)",
       [](Config& c, const auto& text) { c.jobs.store = checked_store(text); },
       [](const Config& c) { return jobs::without_password(c.jobs.store); }},
      {"--store-password-file",
       "file with the password for PostgreSQL, read again for each connection (none: the password is in the URL)",
       [](Config& c, const auto& text) { c.jobs.store_password_file = text == "none" ? "" : text; },
       [](const Config& c) { return c.jobs.store_password_file.empty() ? "none" : c.jobs.store_password_file; }},
      {"--state-dir",
       "folder of the SQLite file; auto: the first of these folders that can be written to: $STATE_DIRECTORY, "
       "$XDG_STATE_HOME/remeshd, ~/.local/state/remeshd, /var/lib/remeshd",
       [](Config& c, const auto& text) { c.jobs.state_dir = text; }, [](const Config& c) { return c.jobs.state_dir; }},
      {"--blob-dir",
       "folder, shared by all daemons, for the inputs and results of jobs (none: they are stored "
       "in the database)",
       [](Config& c, const auto& text) { c.jobs.blob_dir = text == "none" ? "" : text; },
       [](const Config& c) { return c.jobs.blob_dir.empty() ? "none" : c.jobs.blob_dir; }},
      {"--role", "what this daemon does: serve (answer requests, but run no jobs), work (only run jobs), or both",
       [](Config& c, const auto& text) { c.jobs.role = parse_choice(kRoles, text); },
       [](const Config& c) { return role_name(c.jobs.role); }},
      {"--max-queued-jobs", "largest number of waiting jobs in the whole store",
       [](Config& c, const auto& text) {
         c.jobs.max_queued = static_cast<std::int64_t>(between(1, 1'000'000'000, parse_count(text)));
       },
       [](const Config& c) { return format_count(static_cast<std::uint64_t>(c.jobs.max_queued)); }},
      duration(
          "--job-timeout", "longest computing time of a job", [](Config & c) -> auto& { return c.jobs.job_timeout; }),
      duration(
          "--job-queue-timeout", "longest time that a job may wait for a worker",
          [](Config & c) -> auto& { return c.jobs.rules.queue_timeout; }),
      duration(
          "--job-lease",
          "a job is given to another worker if its present worker has shown no sign of life for "
          "this long",
          [](Config & c) -> auto& { return c.jobs.rules.lease; }),
      duration(
          "--store-timeout",
          "longest time that a request waits for the store of jobs, in all its calls "
          "together; after it the answer is 503",
          [](Config & c) -> auto& { return c.jobs.rules.timeout; }),
      byte_limit(
          "--max-stored",
          "largest size of the inputs and results of all jobs together (none: no limit); beyond "
          "it new jobs are answered with 507",
          [](Config & c) -> auto& { return c.jobs.rules.max_stored; }),
      byte_limit(
          "--max-stored-per-key",
          "largest size of the inputs and results of all jobs of one API key (none: no "
          "limit); beyond it new jobs are answered with 507",
          [](Config & c) -> auto& { return c.jobs.rules.max_stored_per_owner; }),
      {"--job-attempts", "number of workers that may crash on a job before the job fails",
       [](Config& c, const auto& text) {
         c.jobs.rules.max_attempts = static_cast<int>(between(1, 1000, parse_count(text)));
       },
       [](const Config& c) { return std::to_string(c.jobs.rules.max_attempts); }},
      duration(
          "--result-ttl", "how long the results of jobs are kept",
          [](Config & c) -> auto& { return c.jobs.rules.result_ttl; }),
      {"--max-connections", "largest number of open connections",
       [](Config& c, const auto& text) { c.connections.max_connections = between(1, 100'000, parse_count(text)); },
       [](const Config& c) { return std::to_string(c.connections.max_connections); }},
      {"--max-connections-per-address", "largest number of open connections from one IPv4 address or IPv6 /64 network",
       [](Config& c, const auto& text) {
         c.connections.max_connections_per_address = between(1, 100'000, parse_count(text));
       },
       [](const Config& c) { return std::to_string(c.connections.max_connections_per_address); }},
      {"--idle-timeout", "how long a connection may stay open without a request (none: one request per connection)",
       [](Config& c, const auto& text) {
         c.connections.idle_timeout = text == "none" ? std::chrono::milliseconds(0) : positive_duration(text);
       },
       [](const Config& c) {
         return c.connections.idle_timeout.count() == 0 ? "none" : format_duration(c.connections.idle_timeout);
       }},
      {"--spool-dir",
       "folder for large answers to clients that read slowly; auto: the folder of jobs, or if there is none the "
       "temporary folder",
       [](Config& c, const auto& text) { c.spool_dir = text; }, [](const Config& c) { return c.spool_dir; }},
      bytes(
          "--max-spooled", "largest total size of the answers in --spool-dir",
          [](Config & c) -> auto& { return c.max_spooled; }),
      {"--max-head", "largest size of a request's head",
       [](Config& c, const auto& text) {
         c.connections.gate.head.max_bytes = between(1024, 16 << 20, parse_bytes(text));
       },
       [](const Config& c) { return format_bytes(c.connections.gate.head.max_bytes); }},
      {"--max-fields", "largest number of header fields of a request",
       [](Config& c, const auto& text) { c.connections.gate.head.max_fields = between(8, 100'000, parse_count(text)); },
       [](const Config& c) { return std::to_string(c.connections.gate.head.max_fields); }},
      duration(
          "--head-timeout", "time in which a request's head must arrive; also the grace period of its body",
          [](Config & c) -> auto& { return c.connections.gate.head_timeout; }),
      bytes(
          "--min-body-rate", "bytes per second that a client must send or receive after the grace period",
          [](Config & c) -> auto& { return c.connections.gate.min_body_rate; }),
      duration(
          "--write-timeout", "grace period of an answer; after it, --min-body-rate applies",
          [](Config & c) -> auto& { return c.connections.gate.write_timeout; }),
      duration(
          "--drain-time", "time that running requests have to finish after SIGTERM",
          [](Config & c) -> auto& { return c.drain_time; }),
      {"--log-format", "format of the log: auto (text on a terminal, json otherwise), text or json",
       [](Config& c, const auto& text) { c.log_format = parse_choice(kFormats, text); },
       [](const Config& c) { return choice_name(kFormats, c.log_format); }},
      {"--log-level", "lowest level of log messages that are written: debug, info, warning, error or off",
       [](Config& c, const auto& text) { c.log_level = parse_choice(kLevels, text); },
       [](const Config& c) { return choice_name(kLevels, c.log_level); }},
  };
  return table;
}

/// Returns 70 % of the memory that this process may use, in whole MiB.
std::uint64_t default_memory_budget() {
  constexpr std::uint64_t kMebibyte = 1 << 20;
  return std::max<std::uint64_t>(1, api::usable_memory() / 10 * 7 / kMebibyte) * kMebibyte;
}

/// Sets the limits of the queue. Waiting small requests may take half of the memory, and an expected time that leaves
/// most of --request-timeout, because no request waits for a worker longer than that.
void complete_queue(Config& config) {
  api::QueueLimits& queue = config.limits.queue;
  if (queue.max_large == 0) queue.max_large = static_cast<std::size_t>(std::max(16, 4 * config.limits.workers));
  queue.max_small_bytes = std::max<std::uint64_t>(1, config.memory_budget / MemoryBudget::kWorkPerBodyByte / 2);
  queue.max_small_wait = config.limits.request_timeout / 5;
}

/// Sets the defaults that depend on other settings, and checks settings against each other.
/// Errors: std::invalid_argument.
void complete(Config& config, Command command) {
  if (config.max_running == 0) config.max_running = config.limits.workers;
  complete_queue(config);
  config.jobs.rules.max_running_per_owner = static_cast<std::int64_t>(config.key_rules.max_running);
  if (command == Command::kHealth) return;
  const bool has_keys = !ApiKeys(config.api_key_file, config.api_key).is_open();
  if (!has_keys && !config.bind.is_loopback() && !config.allow_anonymous) {
    throw std::invalid_argument("--bind " + config.bind.text() +
                                " is reachable from other machines: set --api-key-file or REMESHD_API_KEY, or "
                                "--allow-anonymous if anyone there may use this server");
  }
  if (command == Command::kCheckConfig) jobs::check_folders(config.jobs);  // the start of the daemon creates them
}

}  // namespace

Invocation read_command_line(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  Invocation invocation;
  Config& config = invocation.config;
  config.limits.workers = api::usable_cores();
  config.memory_budget = default_memory_budget();
  config.jobs.store = "sqlite";
  if (const char* key = std::getenv("REMESHD_API_KEY")) config.api_key = key;

  CLI::App app("remeshd: re-triangulates surface meshes, over HTTP", "remeshd");
  app.set_version_flag("--version", std::string("remeshd ") + remesh::version());
  app.footer("Each setting can also be given by its environment variable; a flag takes precedence.");
  std::vector<std::string> values(settings().size());
  std::vector<CLI::Option*> options;
  for (std::size_t i = 0; i < settings().size(); ++i) {
    const Setting& setting = settings()[i];
    CLI::Option* option = setting.is_switch ? app.add_flag(setting.flag, values[i], setting.help)
                                            : app.add_option(setting.flag, values[i], setting.help);
    options.push_back(option->envname(setting.variable()));
    if (!setting.is_switch && setting.help.find("default") == std::string::npos) {
      option->default_str(setting.get(config));
    }
  }
  bool prints = false;
  bool checks = false;
  app.add_flag("--print-config", prints, "print the settings in use and exit");
  app.add_flag("--check-config", checks, "check the settings and exit");
  CLI::App* health = app.add_subcommand("health", "ask a running remeshd whether it is healthy: exit code 0 or 1");
  health->fallthrough();

  try {
    app.parse(argc, argv);
    invocation.command = health->parsed() ? Command::kHealth
                         : prints         ? Command::kPrintConfig
                         : checks         ? Command::kCheckConfig
                                          : Command::kServe;
    for (std::size_t i = 0; i < settings().size(); ++i) {
      if (options[i]->count() == 0) continue;
      const Setting& setting = settings()[i];
      try {
        setting.set(config, values[i]);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(setting.flag + " (" + setting.variable() + "): " + error.what());
      }
    }
    complete(config, invocation.command);
  } catch (const CLI::ParseError& error) {
    invocation.command = Command::kExit;
    invocation.exit_code = app.exit(error, out, err) == 0 ? 0 : 2;
  } catch (const std::invalid_argument& error) {
    err << "remeshd: " << error.what() << "\n";
    invocation.command = Command::kExit;
    invocation.exit_code = 2;
  }
  return invocation;
}

std::string role_name(jobs::Role role) { return choice_name(kRoles, role); }

std::vector<std::string> unknown_variables() {
  std::vector<std::string> unknown;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string name(api::cut(*entry, '=').first);
    // Kubernetes sets variables of these names in all containers beside a service called remeshd.
    const bool is_of_service = name.starts_with("REMESHD_SERVICE_") || name.starts_with("REMESHD_PORT");
    if (!name.starts_with("REMESHD_") || is_of_service || name == "REMESHD_API_KEY") continue;
    const bool is_known = std::any_of(settings().begin(), settings().end(),
                                      [&](const Setting& setting) { return setting.variable() == name; });
    if (!is_known) unknown.push_back(name);
  }
  return unknown;
}

std::string print_config(const Config& config) {
  std::string text;
  for (const Setting& setting : settings()) text += setting.flag.substr(2) + "=" + setting.get(config) + "\n";
  return text;
}

}  // namespace remesh::server
