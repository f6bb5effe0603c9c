/// Tests what every job store promises when rows and blobs are not as a store would write them.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/job_upkeep.h"
#include "server/jobs/sql_store.h"
#include "tests/jobs/store_fixture.h"

namespace remesh::server::jobs {
namespace {

using std::chrono::milliseconds;

const std::string kMax = "9223372036854775807";

class store_damage : public StoreTest {};

TEST_F(store_damage, a_damaged_row_is_the_end_of_its_job_alone) {
  const auto store = open();
  std::vector<std::string> damages{"memory = -1",          "memory = " + kMax,      "token = " + kMax,
                                   "token = -1",           "attempts = 2147483647", "attempts = -5",
                                   "commits = 2147483647", "version = " + kMax,     "turn = " + kMax,
                                   "turn = -" + kMax,      "state = 'dreaming'",    "state = ''"};
  if (is_sqlite()) {
    for (const char* column : {"memory", "token", "attempts", "commits", "version", "turn"}) {
      damages.push_back(std::string(column) + " = 'text'");
      damages.push_back(std::string(column) + " = 1.5");
      damages.push_back(std::string(column) + " = x'00ff'");
    }
  }
  for (const std::string& damage : damages) {
    const std::string damaged = submit(*store);
    const std::string good = submit(*store);
    run("UPDATE remeshd_job SET " + damage + " WHERE id = '" + damaged + "'");
    EXPECT_EQ(work(*store), good) << damage;
    EXPECT_EQ(store->upkeep().damaged, 1) << damage;
    const JobRecord record = store->find(damaged).value();
    EXPECT_EQ(record.state, JobState::kFailed) << damage;
    EXPECT_EQ(record.problem_status, 500) << damage;
    EXPECT_NE(record.problem.find(damaged), std::string::npos) << damage;
    EXPECT_EQ(state(*store, submit(*store)), JobState::kQueued) << damage;
    EXPECT_FALSE(work(*store).empty()) << damage;
  }
}

TEST_F(store_damage, a_job_that_runs_and_is_damaged_fails_and_others_go_on) {
  const auto store = open();
  submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  run("UPDATE remeshd_job SET token = 9223372036854775807, turn = 9223372036854775807");
  const std::string good = submit(*store);
  EXPECT_EQ(store->upkeep().damaged, 1);
  EXPECT_FALSE(store->commit(claim, success()));
  EXPECT_EQ(state(*store, claim.id), JobState::kFailed);
  EXPECT_EQ(work(*store), good);
}

TEST_F(store_damage, a_turn_of_an_owner_that_cannot_be_counted_up_does_not_keep_jobs_out) {
  const auto store = open();
  submit(*store, "", "owner");
  run("UPDATE remeshd_owner SET last_turn = 9223372036854775807");
  submit(*store, "", "owner");
  submit(*store, "", "another");
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(work(*store).empty());
}

TEST_F(store_damage, turns_that_are_no_integers_do_not_keep_jobs_out) {
  if (!is_sqlite()) GTEST_SKIP() << "PostgreSQL stores integers alone in such a column";
  const auto store = open();
  for (const char* turn : {"1.5", "'text'", "'1.5'", "x'00ff'", "1e300"}) {
    const std::string waiting = submit(*store, "", "owner"), good = submit(*store, "", "owner");
    run("UPDATE remeshd_owner SET last_turn = " + std::string(turn));
    submit(*store, "", "owner");
    run("UPDATE remeshd_job SET turn = " + std::string(turn) + ", created_ms = " + turn + " WHERE id = '" + waiting +
        "'");
    submit(*store, "", "another");
    EXPECT_GE(store->statistics().oldest_queued_s, 0) << turn;
    store->upkeep();
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(work(*store).empty()) << turn;
  }
}

TEST_F(store_damage, a_clock_that_is_no_number_is_begun_anew) {
  if (!is_sqlite()) GTEST_SKIP() << "PostgreSQL has its own clock";
  for (const char* value : {"'text'", "x'00ff'", "1.5"}) {
    auto store = open();
    submit(*store);
    run("UPDATE remeshd_clock SET base_ms = " + std::string(value));
    run("UPDATE remeshd_schema SET touched_ms = " + std::string(value));
    store->upkeep();
    EXPECT_FALSE(work(*store).empty()) << value;
    const std::int64_t before = store->find(submit(*store))->created_ms;
    run("UPDATE remeshd_clock SET base_ms = " + std::string(value));
    store = open();
    store->upkeep();
    const std::string job = submit(*store);
    EXPECT_NEAR(static_cast<double>(store->find(job)->created_ms - before), 0, 60'000) << value;
    while (!work(*store).empty()) continue;
    EXPECT_EQ(state(*store, job), JobState::kSucceeded) << value;
  }
}

TEST_F(store_damage, counters_that_cannot_be_counted_up_keep_no_job_from_being_ended) {
  StoreRules rules = patient_rules();
  rules.result_ttl = std::chrono::milliseconds(0);
  const auto store = open(rules);
  const auto damage = [&](const std::string& id) {
    run("UPDATE remeshd_job SET token = " + kMax + ", version = " + kMax + ", commits = 2147483647 WHERE id = '" + id +
        "'");
  };
  const std::string queued = submit(*store);
  damage(queued);
  EXPECT_TRUE(store->cancel(queued));
  EXPECT_EQ(state(*store, queued), JobState::kCancelled);
  const std::string done = submit(*store);
  EXPECT_EQ(work(*store), done);
  damage(done);
  EXPECT_TRUE(store->discard(done));
  EXPECT_EQ(state(*store, done), JobState::kExpired);
  const std::string expiring = submit(*store);
  EXPECT_EQ(work(*store), expiring);
  damage(expiring);
  for (int i = 0; i < 100 && state(*store, expiring) != JobState::kExpired; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    store->upkeep();
  }
  EXPECT_EQ(state(*store, expiring), JobState::kExpired);
}

TEST_F(store_damage, damaged_times_and_sizes_do_not_count_for_other_jobs) {
  StoreRules rules = patient_rules();
  rules.max_stored = 1000;
  auto store = open(rules);
  const std::string first = submit(*store), second = submit(*store), good = submit(*store);
  const std::int64_t before = store->find(good)->created_ms;
  run("UPDATE remeshd_job SET stored = 9223372036854775807, created_ms = 9223372036854775807, "
      "finished_ms = 9223372036854775807 WHERE id = '" +
      first + "'");
  run("UPDATE remeshd_job SET stored = 9223372036854775807, created_ms = -9223372036854775807 WHERE id = '" + second +
      "'");
  EXPECT_EQ(store->stored_bytes(), 4u);
  EXPECT_LT(store->statistics().oldest_queued_s, 3600);
  submit(*store);
  // The clock comes right, and takes all times with it that are none of these.
  run(is_sqlite() ? "UPDATE remeshd_clock SET base_ms = base_ms - 315360000000"
                  : "UPDATE remeshd_clock SET store_ms = store_ms - 315360000000");
  run("UPDATE remeshd_job SET created_ms = created_ms - 315360000000 WHERE id = '" + good + "'");
  store = open(rules);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(store->upkeep().error, "");
  constexpr double kMinute = 60'000;
  EXPECT_NEAR(static_cast<double>(store->find(good)->created_ms), static_cast<double>(before), kMinute);
}

TEST_F(store_damage, a_problem_that_is_none_is_replaced) {
  const auto store = open();
  const std::string id = submit(*store);
  for (const char* problem : {"no JSON", "[]", "null", "5", "{\"code\":5}", "{\"code\""}) {
    run("UPDATE remeshd_job SET state = 'failed', problem_status = 422, problem = '" + std::string(problem) +
        "' WHERE id = '" + id + "'");
    const JobRecord record = store->find(id).value();
    EXPECT_NE(record.problem.find("\"code\":\"internal\""), std::string::npos) << problem;
    EXPECT_EQ(record.problem_status, 422) << problem;
  }
}

TEST_F(store_damage, a_blob_in_a_file_is_no_failure_of_a_store_without_a_folder) {
  const auto store = open();
  const std::string id = submit(*store);
  run("UPDATE remeshd_blob SET file = 'a file'");
  EXPECT_THROW(store->read_blob(id, BlobKind::kInput), NoFolder);
  EXPECT_THROW(store->blob_size(id, BlobKind::kInput), NoFolder);
  EXPECT_TRUE(store->is_well());
}

TEST_F(store_damage, a_job_whose_record_is_damaged_can_still_be_shown) {
  const auto store = open();
  const std::string id = submit(*store, "", "owner");
  const std::string good = submit(*store, "", "owner");
  run("UPDATE remeshd_job SET state = 'failed', problem_status = 0, problem = '' WHERE id = '" + id + "'");
  if (is_sqlite()) run("UPDATE remeshd_job SET created_ms = 'never', started_ms = 'x' WHERE id = '" + id + "'");
  const JobRecord record = store->find(id).value();
  EXPECT_EQ(record.problem_status, 500);
  EXPECT_NE(record.problem.find(id), std::string::npos);
  EXPECT_EQ(store->list("owner", 10).size(), 2u);
  EXPECT_EQ(state(*store, good), JobState::kQueued);
}

TEST_F(store_damage, a_piece_that_is_missing_in_a_blob_is_noticed) {
  const auto store = open();
  const std::string body(3 * DatabaseDriver::kPiece, 'x');
  for (const char* part : {"part = 0", "part = 131", "part = 262", "part > 131"}) {
    const std::string id = submit(*store, body);
    EXPECT_EQ(store->read_blob(id, BlobKind::kInput)->size(), body.size());
    run("DELETE FROM remeshd_blob WHERE job = '" + id + "' AND " + part);
    EXPECT_THROW(store->read_blob(id, BlobKind::kInput), BlobLost) << part;
    EXPECT_TRUE(store->is_well());
  }
}

TEST_F(store_damage, what_the_store_cannot_take_is_an_error_of_the_data) {
  const auto store = open();
  submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  JobOutcome outcome{JobState::kFailed, "", "", 422, "{}"};
  if (is_sqlite()) {
    run("CREATE TRIGGER refuse BEFORE UPDATE ON remeshd_job WHEN new.problem = '{}' BEGIN SELECT RAISE(ABORT, 'no'); "
        "END");
  } else {
    outcome.problem = "not UTF-8: \xff";
  }
  EXPECT_THROW(store->commit(claim, outcome), DataError);
  EXPECT_TRUE(store->is_well());
  outcome.problem = "{\"code\":\"internal\"}";
  EXPECT_TRUE(store->commit(claim, outcome));
}

TEST_F(store_damage, a_damaged_row_that_cannot_be_mended_keeps_no_other_from_being_mended) {
  StoreRules rules = patient_rules();
  rules.lease = milliseconds(20);
  const auto store = open(rules);
  const std::string stuck = submit(*store), mended = submit(*store), runs = submit(*store);
  run("UPDATE remeshd_job SET token = -1, state = 'running' WHERE id = '" + stuck + "'");
  if (is_sqlite()) run("UPDATE remeshd_job SET token = 'text' WHERE id = '" + stuck + "'");
  run("UPDATE remeshd_job SET state = 'dreaming' WHERE id = '" + mended + "'");
  refuse_changes_of(stuck);
  EXPECT_EQ(store->claim("worker", kAnyMemory).value().id, runs);
  const Upkeep done = store->upkeep();
  EXPECT_EQ(done.damaged, 1);
  EXPECT_FALSE(done.error.empty());
  EXPECT_EQ(state(*store, mended), JobState::kFailed);
  int retried = done.retried;
  for (int i = 0; i < 200 && retried == 0; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    retried += store->upkeep().retried;
  }
  EXPECT_EQ(retried, 1) << "leases are judged all the same";
}

TEST_F(store_damage, a_result_that_cannot_expire_keeps_no_other_from_expiring) {
  StoreRules rules = patient_rules();
  rules.result_ttl = milliseconds(0);
  const auto store = open(rules);
  submit(*store);
  submit(*store);
  const std::string stuck = work(*store), other = work(*store);
  std::this_thread::sleep_for(milliseconds(5));
  refuse_changes_of(stuck);
  EXPECT_EQ(store->upkeep().expired, 1);
  EXPECT_EQ(state(*store, other), JobState::kExpired);
  EXPECT_EQ(store->read_blob(stuck, BlobKind::kMesh), "mesh");
}

TEST_F(store_damage, rows_without_an_id_are_removed) {
  if (!is_sqlite()) GTEST_SKIP() << "PostgreSQL allows none";
  const auto store = open();
  const std::string damaged = submit(*store, "", "owner"), good = submit(*store, "", "owner");
  for (const char* name : {"running", "queued", "dreaming", "succeeded"}) {
    run(std::string("INSERT INTO remeshd_job (id, owner, state, turn, memory, request, created_ms) VALUES "
                    "(NULL, 'owner', '") +
        name + "', 1, 1, '{}', 1)");
  }
  run("UPDATE remeshd_job SET state = 'dreaming' WHERE id = '" + damaged + "'");
  EXPECT_EQ(running_jobs(*driver()->connect(), milliseconds(1)).size(), 0u);
  EXPECT_EQ(store->list("owner", 10).size(), 2u);
  EXPECT_EQ(store->upkeep().damaged, 5);
  EXPECT_EQ(count("remeshd_job"), "2");
  EXPECT_EQ(work(*store), good);
}

}  // namespace
}  // namespace remesh::server::jobs
