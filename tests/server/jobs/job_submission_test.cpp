/// Tests how the body of a new job is checked: in the pool, before its client is told that the job is accepted.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "server/jobs/sql_store.h"
#include "tests/server/stub_daemon.h"

namespace remesh::server::jobs {
namespace {

const std::string kMesh = R"({"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]})";

/// The daemon with a folder for jobs of its own. It does not work on them.
class submission : public StubDaemon {
 protected:
  ~submission() override {
    stub_.released = true;
    daemon_.reset();
    std::filesystem::remove_all(folder_);
  }
  void start_with_jobs() {
    std::filesystem::create_directories(folder_);
    config_.jobs.store = "sqlite";
    config_.jobs.state_dir = folder_.string();
    config_.jobs.role = Role::kServe;
    start();
  }
  /// Starts the daemon, and keeps every thread of its pool busy until the stub is released.
  void start_busy() {
    start_with_jobs();
    // A small request may start beyond the one place once the other has run for a second, but no third one.
    for (std::unique_ptr<RawClient>& client : busy_) client = start_blocking("", "deaf");
  }
  SqlStore store() { return SqlStore(make_sqlite_driver(folder_ / "jobs.sqlite"), StoreRules{}); }
  std::int64_t stored_jobs() { return store().statistics().queued; }
  Answer submit(const std::string& mesh) { return post(port_, "/v1/jobs", mesh); }
  /// Submits a job, and returns once its check waits for a thread of the pool.
  std::unique_ptr<RawClient> submit_and_wait(const std::string& fields = "") {
    auto client = std::make_unique<RawClient>(port_);
    client->send(post_text("/v1/jobs", kMesh, fields));
    EXPECT_TRUE(eventually([&] { return has_queued(1); }));
    return client;
  }
  bool has_queued(int tasks) {
    const std::string line = "\nremeshd_requests_queued " + std::to_string(tasks) + "\n";
    return get(port_, "/metrics").body.find(line) != std::string::npos;
  }

  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("remeshd-jobs-" + new_request_id());
  std::array<std::unique_ptr<RawClient>, 2> busy_;
};

TEST_F(submission, a_fault_in_json_is_refused_with_its_line_and_makes_no_job) {
  start_with_jobs();
  const Answer cut = submit("{\"vertices\": [[0,0,0],\n[1,0,0],\n[0,1,");
  EXPECT_EQ(cut.status, 400);
  const auto problem = nlohmann::json::parse(cut.body);
  EXPECT_EQ(problem["code"], "malformed_json");
  EXPECT_EQ(problem["line"], 3);
  const Answer option = submit("{\"mesh\": " + kMesh + ", \"options\": {\"refin\": 1}}");
  EXPECT_EQ(option.status, 400);
  EXPECT_EQ(code_of(option), "unknown_option");
  EXPECT_EQ(stored_jobs(), 0);
}

TEST_F(submission, what_was_checked_is_stored_as_it_was_sent) {
  config_.limits.max_body = 4 << 20;
  config_.limits.queue.max_small_bytes = 4 << 20;
  start_with_jobs();
  for (const std::string& body : {kMesh, kMesh + std::string(2 << 20, ' ')}) {  // the second one is in a file
    const Answer accepted = submit(body);
    ASSERT_EQ(accepted.status, 202);
    const std::string id = nlohmann::json::parse(accepted.body)["id"];
    EXPECT_EQ(store().read_blob(id, BlobKind::kInput), body);
  }
}

TEST_F(submission, a_check_waits_for_the_pool_while_other_formats_need_none) {
  start_busy();
  const auto waiting = submit_and_wait();
  EXPECT_FALSE(waiting->has_input());
  EXPECT_EQ(submit("v 0 0 0").status, 202) << "it is not read before it is worked on";
  EXPECT_EQ(stored_jobs(), 1);
  stub_.released = true;
  EXPECT_EQ(waiting->answer().status, 202);
  EXPECT_EQ(stored_jobs(), 2);
}

TEST_F(submission, a_check_takes_the_place_of_a_small_request_however_large_its_mesh_is) {
  config_.limits.max_body = 4 << 20;
  config_.limits.queue = {.max_large = 0, .max_small_bytes = 1 << 20};
  start_busy();
  RawClient large(port_);
  large.send(post_text("/v1/jobs", kMesh + std::string(2 << 20, ' ')));
  EXPECT_TRUE(eventually([&] { return has_queued(1); })) << "there is no place for a large one";
  const Answer refused = submit(kMesh);
  EXPECT_EQ(refused.status, 503) << "the large one counts as 1 MiB, which is all";
  EXPECT_EQ(code_of(refused), "overloaded");
  EXPECT_NE(refused.header("Retry-After"), "");
  stub_.released = true;
  EXPECT_EQ(large.answer().status, 202);
}

TEST_F(submission, a_check_that_finds_no_thread_in_time_is_refused_and_makes_no_job) {
  config_.limits.request_timeout = milliseconds(4000);  // long enough to keep both threads busy first
  start_busy();
  const Answer late = submit(kMesh);
  EXPECT_EQ(late.status, 503);
  EXPECT_EQ(code_of(late), "overloaded");
  EXPECT_EQ(stored_jobs(), 0);
}

TEST_F(submission, who_leaves_or_cancels_while_a_check_waits_gets_no_job) {
  start_busy();
  submit_and_wait()->close();
  EXPECT_TRUE(eventually([&] { return has_queued(0); }));
  const auto cancelled = submit_and_wait(kIdField);
  EXPECT_EQ(ask(port_, "DELETE /v1/requests/" + kId + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status, 204);
  EXPECT_EQ(code_of(cancelled->answer()), "cancelled");
  stub_.released = true;
  EXPECT_EQ(stored_jobs(), 0);
}

TEST_F(submission, a_check_that_waits_is_refused_when_the_daemon_stops) {
  start_busy();
  const auto waiting = submit_and_wait();
  daemon_->stop();
  EXPECT_EQ(code_of(waiting->answer()), "draining");
  EXPECT_EQ(stored_jobs(), 0);
}

}  // namespace
}  // namespace remesh::server::jobs
