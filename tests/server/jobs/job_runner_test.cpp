/// Tests what becomes of jobs, for every way in which their work can end. A stub takes the place of the geometry. The
/// store is SQLite.
#include "server/jobs/job_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <new>
#include <system_error>

#include "server/jobs/job_request.h"
#include "server/jobs/sql_store.h"
#include "server/observe/log.h"
#include "tests/server/raw_client.h"

namespace remesh::server::jobs {
namespace {

using std::chrono::milliseconds;

class runner : public ::testing::Test {
 protected:
  runner() : folder_(std::filesystem::temp_directory_path() / ("remeshd-runner-" + new_request_id())) {
    log::set_up(log::Format::kText, log::Level::kOff);
    std::filesystem::create_directories(folder_);
    store_ = std::make_unique<SqlStore>(make_sqlite_driver(folder_ / "jobs.sqlite"), StoreRules{});
    settings_.worker = "test";
  }
  ~runner() override {
    released_ = true;
    if (runner_) runner_->stop();
    pool_.reset();
    runner_.reset();
    store_.reset();
    std::filesystem::remove_all(folder_);
  }

  void start(int places = 1) {
    settings_.max_held = static_cast<std::size_t>(places);
    pool_ = std::make_unique<WorkerPool>(places, api::QueueLimits{.max_large = 16}, 1);
    runner_ = std::make_unique<JobRunner>(
        *store_, *pool_, registry_, *budget_, metrics_,
        [this](const api::Request& request, const api::Limits&, RunControl& control) { return work(request, control); },
        settings_);
    runner_->start();
  }

  api::StoredRemesh work(const api::Request& request, RunControl& control) {
    const int call = ++calls_;
    if (request.body == "throw") throw std::runtime_error("a secret of the server");
    if (request.body == "no memory") throw std::bad_alloc();
    if (request.body == "no threads") throw std::system_error(EAGAIN, std::generic_category());
    if (request.body == "bad") throw Error(Code::kEmptyMesh, Stage::kRead, "there is no face").at_line(3);
    if (request.body == "overlaps") {
      // It ends once the next one has begun, or else after a while.
      const Clock::time_point begin = Clock::now();
      std::this_thread::sleep_for(milliseconds(100));
      while (calls_ == call && Clock::now() < begin + milliseconds(2000)) std::this_thread::sleep_for(milliseconds(2));
    }
    while (request.body == "block" && !released_) {
      std::this_thread::sleep_for(milliseconds(2));
      control.check();
    }
    return {"mesh of " + std::string(request.body), "{}", {}};
  }

  std::string submit(const std::string& body, std::uint64_t memory = 1) {
    NewJob job;
    job.id = new_request_id();
    job.request = pack_request({});
    job.body = body;
    job.memory = memory;
    store_->submit(job);
    if (runner_) runner_->wake();
    return job.id;
  }
  /// Starts the runner, submits a job with this body, and returns the job once it has ended.
  JobRecord outcome_of(const std::string& body) {
    start();
    return ended(submit(body));
  }
  JobRecord ended(const std::string& id) {
    EXPECT_TRUE(eventually([&] { return is_final(store_->find(id)->state); }));
    return *store_->find(id);
  }
  bool reaches(const std::string& id, JobState state) {
    return eventually([&] { return store_->find(id)->state == state; });
  }

  const std::filesystem::path folder_;
  std::unique_ptr<SqlStore> store_;
  RunnerSettings settings_;
  RequestRegistry registry_;
  MemoryBudget memory_{1 << 20, /*patience=*/milliseconds(200)};
  MemoryBudget patient_{1 << 20, /*patience=*/std::chrono::hours(1)};
  MemoryBudget* budget_ = &memory_;
  Metrics metrics_;
  std::atomic<int> calls_{0};
  std::atomic<bool> released_{false};
  std::unique_ptr<WorkerPool> pool_;
  std::unique_ptr<JobRunner> runner_;
};

TEST_F(runner, a_job_that_waits_is_done_and_its_result_kept) {
  const std::string id = submit("a part");
  start();
  EXPECT_EQ(ended(id).state, JobState::kSucceeded);
  EXPECT_EQ(store_->read_blob(id, BlobKind::kMesh), "mesh of a part");
  EXPECT_EQ(store_->read_blob(id, BlobKind::kInput), std::nullopt);
}

TEST_F(runner, an_error_of_the_input_is_not_tried_again) {
  const JobRecord job = outcome_of("bad");
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.attempts, 1);
  EXPECT_EQ(job.problem_status, 422);
  EXPECT_NE(job.problem.find("\"code\":\"empty_mesh\""), std::string::npos);
  EXPECT_NE(job.problem.find("\"line\":3"), std::string::npos);
}

TEST_F(runner, a_defect_is_told_as_opaque_and_not_tried_again) {
  const JobRecord job = outcome_of("throw");
  EXPECT_EQ(job.problem_status, 500);
  EXPECT_EQ(job.problem.find("secret"), std::string::npos);
  EXPECT_EQ(job.attempts, 1);
}

TEST_F(runner, want_of_memory_is_tried_again_but_not_for_ever) {
  const JobRecord job = outcome_of("no memory");
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.attempts, 3);
  EXPECT_EQ(job.problem_status, 500) << "nothing that passes by itself";
  EXPECT_NE(job.problem.find("\"code\":\"out_of_memory\""), std::string::npos);
  EXPECT_NE(job.problem.find("attempt 3 was the last"), std::string::npos);
}

TEST_F(runner, want_of_descriptors_or_threads_is_tried_again_too) {
  const JobRecord job = outcome_of("no threads");
  EXPECT_EQ(job.attempts, 3);
  EXPECT_EQ(job.problem_status, 500);
  EXPECT_NE(job.problem.find("\"code\":\"overloaded\""), std::string::npos);
}

TEST_F(runner, a_job_has_its_time_and_no_more) {
  settings_.job_timeout = milliseconds(100);
  settings_.rules.lease = milliseconds(800);
  const JobRecord job = outcome_of("block");
  EXPECT_EQ(job.problem_status, 504);
  EXPECT_NE(job.problem.find("\"code\":\"timeout\""), std::string::npos);
}

TEST_F(runner, a_job_cancelled_elsewhere_is_dropped_at_the_next_look) {
  settings_.rules.lease = milliseconds(800);
  start();
  const std::string id = submit("block");
  ASSERT_TRUE(reaches(id, JobState::kRunning));
  EXPECT_TRUE(store_->cancel(id));
  EXPECT_TRUE(eventually([&] { return runner_->is_idle(); }));
  EXPECT_EQ(store_->find(id)->state, JobState::kCancelled);
  EXPECT_EQ(ended(submit("next")).state, JobState::kSucceeded);
}

TEST_F(runner, no_more_is_held_than_there_are_places) {
  start(2);
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(submit("block"));
  ASSERT_TRUE(eventually([&] { return calls_ == 2; }));
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(store_->statistics().running, 2);
  released_ = true;
  for (const std::string& id : ids) EXPECT_EQ(ended(id).state, JobState::kSucceeded);
}

TEST_F(runner, a_job_is_left_alone_while_its_memory_is_taken) {
  start(2);
  const std::string first = submit("block", 700'000);
  ASSERT_TRUE(reaches(first, JobState::kRunning));
  const std::string large = submit("large", 700'000);
  const std::string small = submit("small", 1000);
  EXPECT_EQ(ended(small).state, JobState::kSucceeded);
  EXPECT_EQ(store_->find(large)->state, JobState::kQueued);
  released_ = true;
  EXPECT_EQ(ended(large).state, JobState::kSucceeded);
  EXPECT_TRUE(eventually([&] { return memory_.reserved() == 0; }));
}

TEST_F(runner, a_job_that_needs_all_memory_has_its_turn_although_small_requests_never_end) {
  start(2);
  std::atomic<bool> is_over{false};
  std::atomic<int> passed{0};
  std::thread requests([&] {
    // Each of them ends only after the next one has begun, or has found that it cannot begin.
    std::shared_ptr<MemoryShare> last;
    while (!is_over) {
      auto next = memory_.open_share(1);
      if (next->try_hold(1000)) ++passed;
      last = std::move(next);
      std::this_thread::sleep_for(milliseconds(2));
    }
  });
  ASSERT_TRUE(eventually([&] { return passed > 0; }));
  const std::string large = submit("large", memory_.limit());
  const JobRecord job = ended(large);
  EXPECT_EQ(job.state, JobState::kSucceeded);
  EXPECT_EQ(job.attempts, 1);
  const int before = passed;
  EXPECT_TRUE(eventually([&] { return passed > before; })) << "then the others have theirs again";
  is_over = true;
  requests.join();
  EXPECT_EQ(memory_.waiting(), 0u);
}

TEST_F(runner, a_job_that_needs_all_memory_has_its_turn_although_small_jobs_come_all_the_time) {
  start(2);
  std::atomic<bool> is_over{false};
  std::thread jobs([&] {
    while (!is_over) {
      if (store_->statistics().queued < 3) submit("small", 1000);
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  const std::string large = submit("large", memory_.limit());
  EXPECT_EQ(ended(large).state, JobState::kSucceeded);
  is_over = true;
  jobs.join();
}

TEST_F(runner, a_job_that_needs_all_memory_has_its_turn_although_jobs_that_overlap_come_all_the_time) {
  start(2);
  std::atomic<bool> is_over{false};
  std::thread jobs([&] {
    while (!is_over) {
      if (store_->statistics().queued < 4) submit("overlaps", 1000);
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  EXPECT_TRUE(eventually([&] { return calls_ >= 1; }));
  const std::string large = submit("large", memory_.limit());
  EXPECT_EQ(ended(large).state, JobState::kSucceeded);
  is_over = true;
  jobs.join();
}

TEST_F(runner, while_a_job_is_passed_over_the_store_is_rarely_asked_for_others) {
  std::atomic<int> claims{0};
  store_ = std::make_unique<SqlStore>(
      make_sqlite_driver(folder_ / "jobs.sqlite"), StoreRules{}, nullptr,
      [&](std::string_view op, double, const StoreError*) { claims += op == "claim" ? 1 : 0; });
  budget_ = &patient_;
  const auto request = patient_.open_share(1);
  ASSERT_TRUE(request->try_hold(1000));
  submit("large", patient_.limit());
  start(2);
  ASSERT_TRUE(eventually([&] { return patient_.waiting() == 1 && claims > 0; }));
  const Clock::time_point begin = Clock::now();
  const int before = claims;
  std::this_thread::sleep_for(milliseconds(2500));
  EXPECT_LE(claims - before, 2 + (Clock::now() - begin) / std::chrono::seconds(1));
  EXPECT_EQ(ended(submit("small", 1000)).state, JobState::kSucceeded) << "a new job is found";
  runner_->stop();  // it counts in `claims`, which ends here
}

TEST_F(runner, a_waiting_job_that_is_cancelled_or_a_stop_sets_no_memory_aside) {
  start(2);
  const auto request = memory_.open_share(1);
  ASSERT_TRUE(request->try_hold(1000));
  const std::string large = submit("large", memory_.limit());
  ASSERT_TRUE(eventually([&] { return memory_.waiting() == 1; }));
  EXPECT_TRUE(store_->cancel(large));
  EXPECT_TRUE(eventually([&] { return memory_.waiting() == 0; }));
  submit("large", memory_.limit());
  ASSERT_TRUE(eventually([&] { return memory_.waiting() == 1; }));
  runner_->stop();
  EXPECT_EQ(memory_.waiting(), 0u);
}

TEST_F(runner, a_drain_finishes_what_was_begun_and_begins_nothing) {
  start();
  const std::string first = submit("block");
  ASSERT_TRUE(reaches(first, JobState::kRunning));
  const std::string second = submit("waits");
  runner_->begin_drain();
  released_ = true;
  EXPECT_EQ(ended(first).state, JobState::kSucceeded);
  EXPECT_TRUE(eventually([&] { return runner_->is_idle(); }));
  EXPECT_EQ(store_->find(second)->state, JobState::kQueued);
}

TEST_F(runner, a_stop_gives_back_what_runs_and_what_waits_in_the_pool) {
  start();
  const std::string first = submit("block");
  ASSERT_TRUE(reaches(first, JobState::kRunning));
  runner_->stop();
  EXPECT_EQ(store_->find(first)->state, JobState::kQueued);
  EXPECT_EQ(store_->find(first)->attempts, 0);
}

TEST_F(runner, an_input_that_is_missing_fails_its_job) {
  const std::string id = submit("gone");
  make_sqlite_driver(folder_ / "jobs.sqlite")->connect()->run("DELETE FROM remeshd_blob");
  start();
  EXPECT_EQ(ended(id).problem_status, 500);
}

TEST_F(runner, an_input_in_a_file_without_a_folder_is_left_to_others_but_not_for_ever) {
  settings_.rules.lease = milliseconds(200);
  const std::string id = submit("gone"), good = submit("good");
  make_sqlite_driver(folder_ / "jobs.sqlite")
      ->connect()
      ->run(("UPDATE remeshd_blob SET file = 'a file' WHERE job = '" + id + "'").c_str());
  const Clock::time_point begin = Clock::now();
  start();
  const JobRecord job = ended(id);
  EXPECT_EQ(job.problem_status, 500);
  EXPECT_EQ(job.attempts, 1) << "those before do not count";
  EXPECT_GE(Clock::now() - begin, 5 * settings_.rules.lease) << "another daemon may have the folder";
  EXPECT_EQ(ended(good).state, JobState::kSucceeded);
}

TEST_F(runner, a_run_that_is_stopped_for_memory_goes_back_with_a_better_estimate) {
  start(2);
  const std::string id = submit("block", 1000);
  ASSERT_TRUE(eventually([&] { return registry_.computing().size() == 1; }));
  const std::shared_ptr<RunningRequest> running = registry_.computing().front();
  running->growth = 400'000;
  running->evict(/*was_alone=*/false);
  ASSERT_TRUE(eventually([&] { return calls_ == 2; }));
  released_ = true;
  const JobRecord job = ended(id);
  EXPECT_EQ(job.state, JobState::kSucceeded);
  EXPECT_EQ(job.attempts, 1) << "the first run does not count";
  const auto memory = make_sqlite_driver(folder_ / "jobs.sqlite")->connect()->run("SELECT memory FROM remeshd_job");
  EXPECT_EQ(memory.at(0)[0], "500000") << "what it was seen to take, and a quarter more";
}

TEST_F(runner, a_run_that_is_stopped_for_memory_with_all_of_it_is_not_tried_for_ever) {
  start();
  const std::string id = submit("block", memory_.limit());
  for (int attempt = 1; attempt <= 3; ++attempt) {
    ASSERT_TRUE(eventually([&] { return calls_ == attempt && registry_.computing().size() == 1; }));
    registry_.computing().front()->evict(/*was_alone=*/false);
  }
  const JobRecord job = ended(id);
  EXPECT_EQ(job.problem_status, 500);
  EXPECT_NE(job.problem.find("\"code\":\"out_of_memory\""), std::string::npos);
  EXPECT_EQ(job.attempts, 3);
}

TEST_F(runner, a_run_that_takes_too_much_memory_alone_fails) {
  start();
  const std::string id = submit("block");
  ASSERT_TRUE(eventually([&] { return registry_.computing().size() == 1; }));
  registry_.computing().front()->evict(/*was_alone=*/true);
  const JobRecord job = ended(id);
  EXPECT_EQ(job.problem_status, 413);
  EXPECT_EQ(job.attempts, 1);
}

TEST_F(runner, an_outcome_that_the_store_cannot_take_fails_its_job_and_no_other) {
  const std::string bad = submit("bad"), good = submit("good");
  make_sqlite_driver(folder_ / "jobs.sqlite")
      ->connect()
      ->run(
          "CREATE TRIGGER refuse BEFORE UPDATE ON remeshd_job WHEN new.problem LIKE '%empty_mesh%' "
          "BEGIN SELECT RAISE(ABORT, 'no'); END");
  start();
  EXPECT_EQ(ended(good).state, JobState::kSucceeded);
  const JobRecord job = ended(bad);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.problem_status, 500);
}

TEST_F(runner, an_outage_is_no_attempt_and_takes_no_job_from_its_worker) {
  StoreRules rules;
  // The worker renews every second or so. A judge that counted an outage would look before that. To one that does not,
  // two more seconds pass until a worker that a busy machine holds up is taken for dead.
  rules.lease = milliseconds(3000);
  rules.timeout = milliseconds(200);
  settings_.rules.lease = milliseconds(4000);
  settings_.rules.timeout = rules.timeout;
  store_ = std::make_unique<SqlStore>(make_sqlite_driver(folder_ / "jobs.sqlite"), rules);
  // Another daemon judges all the time whether this one lives.
  SqlStore judge(make_sqlite_driver(folder_ / "jobs.sqlite"), rules);
  int taken = 0, failures = 0;
  const auto judge_for = [&](milliseconds time) {
    for (const Clock::time_point end = Clock::now() + time; Clock::now() < end;) {
      try {
        taken += judge.upkeep().retried;
      } catch (const StoreError&) {
        ++failures;
      }
      std::this_thread::sleep_for(milliseconds(20));
    }
  };
  start();
  const std::string id = submit("block");
  ASSERT_TRUE(reaches(id, JobState::kRunning));
  judge_for(milliseconds(100));
  for (int outage = 0; outage < 2; ++outage) {
    // While another process holds the lock, nothing can be renewed or committed.
    const auto driver = make_sqlite_driver(folder_ / "jobs.sqlite");
    const auto other = driver->connect();
    other->begin();
    other->run("UPDATE remeshd_schema SET touched_ms = 0");
    judge_for(milliseconds(3600));
    EXPECT_EQ(store_->find(id)->state, JobState::kRunning);
    other->roll_back();
    judge_for(milliseconds(300));
  }
  EXPECT_GT(failures, 0) << "the judge was cut off, too";
  EXPECT_EQ(taken, 0);
  released_ = true;
  const JobRecord job = ended(id);
  EXPECT_EQ(job.state, JobState::kSucceeded);
  EXPECT_EQ(job.attempts, 1);
  EXPECT_EQ(calls_, 1);
}

}  // namespace
}  // namespace remesh::server::jobs
