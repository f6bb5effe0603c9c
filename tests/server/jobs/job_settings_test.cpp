#include "server/jobs/job_settings.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/config.h"
#include "server/work/request_registry.h"

namespace remesh::server::jobs {
namespace {

class state_dir : public ::testing::Test {
 protected:
  state_dir() : folder_(std::filesystem::temp_directory_path() / ("remeshd-state-" + new_request_id())) {
    for (const char* name : {"STATE_DIRECTORY", "XDG_STATE_HOME"}) ::unsetenv(name);
    ::setenv("HOME", "/dev/null", 1);
  }
  ~state_dir() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_;
};

TEST_F(state_dir, the_first_folder_that_can_be_written_is_taken_and_closed_to_others) {
  ::setenv("HOME", folder_.c_str(), 1);
  EXPECT_EQ(find_state_dir("auto"), folder_ / ".local/state/remeshd");
  ::setenv("XDG_STATE_HOME", (folder_ / "xdg").c_str(), 1);
  EXPECT_EQ(find_state_dir("auto"), folder_ / "xdg/remeshd");
  ::setenv("STATE_DIRECTORY", (folder_ / "systemd").c_str(), 1);
  EXPECT_EQ(find_state_dir("auto"), folder_ / "systemd");
  ::setenv("STATE_DIRECTORY", "/dev/null/nothing", 1);
  EXPECT_EQ(find_state_dir("auto"), folder_ / "xdg/remeshd");
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "xdg/remeshd").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0700u);
}

TEST_F(state_dir, a_folder_that_was_named_must_be_had) {
  EXPECT_EQ(find_state_dir(folder_ / "deep" / "er"), folder_ / "deep" / "er");
  EXPECT_THROW(find_state_dir("/dev/null/nothing"), std::invalid_argument);
}

TEST_F(state_dir, a_check_of_the_settings_looks_at_the_folders_and_makes_none) {
  const auto check = [](std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), {"remeshd", "--check-config"});
    std::ostringstream out, err;
    return read_command_line(static_cast<int>(arguments.size()), arguments.data(), out, err).exit_code;
  };
  std::filesystem::create_directories(folder_);
  const std::string good = folder_ / "deep" / "er", bad = "/dev/null/nothing";
  EXPECT_EQ(check({"--state-dir", good.c_str(), "--blob-dir", good.c_str()}), 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "deep"));
  EXPECT_EQ(check({"--state-dir", bad.c_str()}), 2);
  EXPECT_EQ(check({"--state-dir", good.c_str(), "--blob-dir", bad.c_str()}), 2);
  EXPECT_EQ(check({"--store", "none", "--state-dir", bad.c_str()}), 0) << "nothing is kept";
  EXPECT_EQ(check({}), 0) << "without a folder of its own choice it starts, and keeps no jobs";
  std::ofstream(folder_ / "file");
  const std::string file = folder_ / "file";
  EXPECT_EQ(check({"--state-dir", file.c_str()}), 2);
}

TEST(store_url, is_shown_without_its_password) {
  EXPECT_EQ(without_password("postgres://me:secret@host:5432/db"), "postgres://me:***@host:5432/db");
  EXPECT_EQ(without_password("postgres://me@host:5432/db"), "postgres://me@host:5432/db");
  EXPECT_EQ(without_password("postgres://host:5432/db"), "postgres://host:5432/db");
  EXPECT_EQ(without_password("sqlite"), "sqlite");
  EXPECT_EQ(without_password("postgres://host/db?password=secret&sslpassword=other&a=b"),
            "postgres://host/db?password=***&sslpassword=***&a=b");
  EXPECT_EQ(without_password("host=h password=secret dbname=d"), "host=h password=*** dbname=d");
  EXPECT_EQ(without_password(R"(password = 'a \' secret' host=h)"), "password = *** host=h");
}

TEST(job_flags, are_read_and_wrong_ones_refused) {
  const auto read = [](std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "remeshd");
    std::ostringstream out, err;
    return read_command_line(static_cast<int>(arguments.size()), arguments.data(), out, err);
  };
  EXPECT_EQ(read({}).config.jobs.store, "sqlite");
  EXPECT_EQ(Config{}.jobs.store, "none") << "nothing is written where nobody has asked";
  const Config config = read({"--store", "postgres://a:b@c/d", "--role", "work", "--job-lease", "5s", "--job-attempts",
                              "7", "--result-ttl", "1h", "--blob-dir", "/x", "--job-timeout", "2min"})
                            .config;
  EXPECT_EQ(config.jobs.store, "postgres://a:b@c/d");
  EXPECT_EQ(config.jobs.role, Role::kWork);
  EXPECT_EQ(config.jobs.rules.lease, std::chrono::seconds(5));
  EXPECT_EQ(config.jobs.rules.max_attempts, 7);
  EXPECT_EQ(config.jobs.rules.result_ttl, std::chrono::hours(1));
  EXPECT_EQ(config.jobs.blob_dir, "/x");
  EXPECT_EQ(config.jobs.job_timeout, std::chrono::minutes(2));
  EXPECT_EQ(print_config(config).find("a:b@"), std::string::npos);
  for (const char* store : {"mysql", "postgres://[", "http://x/y"}) {
    EXPECT_EQ(read({"--store", store}).exit_code, 2) << store;
  }
  EXPECT_EQ(read({"--role", "boss"}).exit_code, 2);
}

}  // namespace
}  // namespace remesh::server::jobs
