#include "server/config.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <vector>

#include "api/machine_limits.h"

namespace remesh::server {
namespace {

struct Outcome {
  Invocation invocation;
  std::string out, err;
};

Outcome read(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "remeshd");
  std::ostringstream out, err;
  Outcome outcome;
  outcome.invocation = read_command_line(static_cast<int>(arguments.size()), arguments.data(), out, err);
  outcome.out = out.str();
  outcome.err = err.str();
  return outcome;
}

class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  ~ScopedVariable() { ::unsetenv(name_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  const char* name_;
};

TEST(config, the_defaults_are_those_of_the_contract) {
  const Invocation invocation = read({}).invocation;
  EXPECT_EQ(invocation.command, Command::kServe);
  const std::string text = print_config(invocation.config);
  for (const char* line :
       {"bind=127.0.0.1:8080\n", "ops-bind=none\n", "max-body=256MiB\n", "max-vertices=10M\n", "max-faces=20M\n",
        "max-output-faces=50M\n", "max-connections=512\n", "max-head=32KiB\n", "max-fields=100\n", "head-timeout=10s\n",
        "min-body-rate=1KiB\n", "write-timeout=60s\n", "request-timeout=300s\n", "drain-time=25s\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  EXPECT_EQ(invocation.config.limits.workers, api::usable_cores());
  EXPECT_EQ(invocation.config.max_running, invocation.config.limits.workers);
}

TEST(config, the_queue_follows_the_workers) {
  EXPECT_EQ(read({"--workers", "2"}).invocation.config.limits.queue.max_large, 16u);
  EXPECT_EQ(read({"--workers", "10"}).invocation.config.limits.queue.max_large, 40u);
  EXPECT_EQ(read({"--workers", "10", "--queue-size", "3"}).invocation.config.limits.queue.max_large, 3u);
}

TEST(config, a_flag_goes_before_the_environment_and_that_before_the_default) {
  const ScopedVariable variable("REMESHD_MAX_BODY", "7MiB");
  EXPECT_EQ(read({}).invocation.config.limits.max_body, 7ull << 20);
  EXPECT_EQ(read({"--max-body", "9MiB"}).invocation.config.limits.max_body, 9ull << 20);
  EXPECT_EQ(read({"--max-body=9MiB"}).invocation.config.limits.max_body, 9ull << 20);
}

TEST(config, a_bad_value_is_fatal_and_named) {
  for (const std::vector<const char*>& arguments : std::vector<std::vector<const char*>>{{"--max-body", "3x"},
                                                                                         {"--workers", "0"},
                                                                                         {"--workers", "99999"},
                                                                                         {"--request-timeout", "0s"},
                                                                                         {"--bind", "nowhere"},
                                                                                         {"--log-level", "loud"},
                                                                                         {"--max-head", "10"}}) {
    const Outcome outcome = read(arguments);
    EXPECT_EQ(outcome.invocation.command, Command::kExit) << arguments[0];
    EXPECT_EQ(outcome.invocation.exit_code, 2) << arguments[0];
    EXPECT_NE(outcome.err.find(arguments[0]), std::string::npos) << outcome.err;
  }
  const ScopedVariable variable("REMESHD_WORKERS", "many");
  const Outcome outcome = read({});
  EXPECT_EQ(outcome.invocation.exit_code, 2);
  EXPECT_NE(outcome.err.find("REMESHD_WORKERS"), std::string::npos) << outcome.err;
}

TEST(config, an_unknown_flag_is_fatal) {
  EXPECT_EQ(read({"--max-boddy", "1"}).invocation.exit_code, 2);
  EXPECT_EQ(read({"extra"}).invocation.exit_code, 2);
}

TEST(config, listening_beyond_loopback_needs_consent) {
  EXPECT_EQ(read({"--bind", "0.0.0.0:8080"}).invocation.exit_code, 2);
  EXPECT_EQ(read({"--bind", "[::]:8080"}).invocation.exit_code, 2);
  EXPECT_EQ(read({"--bind", "0.0.0.0:8080", "--allow-anonymous"}).invocation.command, Command::kServe);
  EXPECT_EQ(read({"--ops-bind", "0.0.0.0:9090"}).invocation.command, Command::kServe);
  EXPECT_EQ(read({"health", "--bind", "0.0.0.0:8080"}).invocation.command, Command::kHealth);
  const ScopedVariable variable("REMESHD_ALLOW_ANONYMOUS", "true");
  EXPECT_EQ(read({"--bind", "0.0.0.0:8080"}).invocation.command, Command::kServe);
}

TEST(config, variables_that_no_setting_has_are_found) {
  const auto is_unknown = [](const std::string& name) {
    const std::vector<std::string> names = unknown_variables();
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const ScopedVariable misspelt("REMESHD_MAX_BODDY", "1MiB"), known("REMESHD_MAX_BODY", "1MiB"),
      key("REMESHD_API_KEY", "0123456789abcdef"), service("REMESHD_SERVICE_HOST", "10.0.0.1"),
      port("REMESHD_PORT_8080_TCP", "tcp://10.0.0.1:8080");
  EXPECT_TRUE(is_unknown("REMESHD_MAX_BODDY"));
  for (const char* name : {"REMESHD_MAX_BODY", "REMESHD_API_KEY", "REMESHD_SERVICE_HOST", "REMESHD_PORT_8080_TCP"})
    EXPECT_FALSE(is_unknown(name)) << name;
}

TEST(config, help_names_every_setting_and_version_prints) {
  const Outcome help = read({"--help"});
  EXPECT_EQ(help.invocation.command, Command::kExit);
  EXPECT_EQ(help.invocation.exit_code, 0);
  std::istringstream lines(print_config(Config{}));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_NE(help.out.find("--" + line.substr(0, line.find('='))), std::string::npos) << line;
  }
  EXPECT_NE(help.out.find("REMESHD_MAX_BODY"), std::string::npos);
  EXPECT_NE(read({"--version"}).out.find("remeshd 0."), std::string::npos);
}

TEST(config, the_commands_are_told_apart) {
  EXPECT_EQ(read({"--print-config"}).invocation.command, Command::kPrintConfig);
  EXPECT_EQ(read({"--check-config"}).invocation.command, Command::kCheckConfig);
  EXPECT_EQ(read({"health"}).invocation.command, Command::kHealth);
}

TEST(cpu_limit, a_quota_is_rounded_up_to_whole_cores) {
  EXPECT_EQ(api::cores_of_quota("150000 100000\n"), 2);
  EXPECT_EQ(api::cores_of_quota("200000 100000\n"), 2);
  EXPECT_EQ(api::cores_of_quota("5000 100000\n"), 1);
  EXPECT_EQ(api::cores_of_quota("max 100000\n"), 0);
  EXPECT_EQ(api::cores_of_quota("-1\n 100000\n"), 0);
  EXPECT_EQ(api::cores_of_quota(""), 0);
  EXPECT_GE(api::usable_cores(), 1);
}

}  // namespace
}  // namespace remesh::server
