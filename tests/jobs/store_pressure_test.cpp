/// Tests what every job store promises when its data, its database or its clock is not as it should be. The environment
/// says which store is tested, as for store_test.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/jobs/sql_store.h"
#include "server/work/request_registry.h"

namespace remesh::server::jobs {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
constexpr std::uint64_t kAnyMemory = 1ull << 60;

class store_pressure : public ::testing::Test {
 protected:
  store_pressure() : folder_(std::filesystem::temp_directory_path() / ("remeshd-store-" + new_request_id())) {
    std::filesystem::create_directories(folder_);
    const char* named = std::getenv("REMESHD_TEST_STORE");
    url_ = named == nullptr ? "sqlite" : named;
    if (!is_sqlite()) make_postgres_driver(url_)->connect()->run(("CREATE SCHEMA " + schema_).c_str());
  }
  ~store_pressure() override {
    if (!is_sqlite()) make_postgres_driver(url_)->connect()->run(("DROP SCHEMA " + schema_ + " CASCADE").c_str());
    std::filesystem::remove_all(folder_);
  }

  bool is_sqlite() const { return url_ == "sqlite"; }
  std::string file() const { return (folder_ / "jobs.sqlite").string(); }
  std::unique_ptr<DatabaseDriver> driver() const {
    if (is_sqlite()) return make_sqlite_driver(file());
    return make_postgres_driver(url_ + "?options=-csearch_path%3D" + schema_);
  }
  std::unique_ptr<JobStore> open(const StoreRules& rules = {}) const {
    return std::make_unique<SqlStore>(driver(), rules);
  }
  /// Runs a statement behind the store's back.
  Rows run(const std::string& sql) const { return driver()->connect()->run(sql.c_str()); }

  static std::string submit(JobStore& store, std::string_view body = "body", const std::string& owner = "") {
    NewJob job;
    job.id = new_request_id();
    job.owner = owner;
    job.request = "{\"query\":[]}";
    job.body = body;
    job.memory = 1;
    return store.submit(job).id;
  }
  static JobOutcome success(const std::string& mesh = "mesh") { return {JobState::kSucceeded, mesh, "{}", 0, ""}; }
  /// Claims the next job and commits a result.
  static std::string work(JobStore& store, const std::string& mesh = "mesh") {
    const std::optional<Claim> claim = store.claim("worker", kAnyMemory);
    if (!claim) return "";
    EXPECT_TRUE(store.commit(*claim, success(mesh)));
    return claim->id;
  }
  static JobState state(JobStore& store, const std::string& id) { return store.find(id).value().state; }

  const std::filesystem::path folder_;
  const std::string schema_ = "test_" + new_request_id();
  std::string url_;
};

// ---- damaged rows

TEST_F(store_pressure, a_damaged_row_is_the_end_of_its_job_alone) {
  const auto store = open();
  const std::string kMax = "9223372036854775807";
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

TEST_F(store_pressure, a_job_that_runs_and_is_damaged_fails_and_others_go_on) {
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

TEST_F(store_pressure, a_turn_of_an_owner_that_cannot_be_counted_up_does_not_keep_jobs_out) {
  const auto store = open();
  submit(*store, "", "owner");
  run("UPDATE remeshd_owner SET last_turn = 9223372036854775807");
  submit(*store, "", "owner");
  submit(*store, "", "another");
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(work(*store).empty());
}

TEST_F(store_pressure, a_job_whose_record_is_damaged_can_still_be_shown) {
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

TEST_F(store_pressure, a_piece_that_is_missing_in_a_blob_is_noticed) {
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

TEST_F(store_pressure, what_the_store_cannot_take_is_an_error_of_the_data) {
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

// ---- the database under the store

TEST_F(store_pressure, a_database_that_was_made_anew_gets_its_tables_and_knows_no_old_job) {
  const auto store = open();
  const std::string lost = submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  for (const char* table : {"job", "blob", "owner", "idempotency", "schema", "clock"})
    run(std::string("DROP TABLE remeshd_") + table);
  if (!is_sqlite()) run("DROP FUNCTION remeshd_now");
  EXPECT_EQ(store->find(lost), std::nullopt);
  EXPECT_FALSE(store->renew(claim, {"read", 0.5}));
  EXPECT_FALSE(store->commit(claim, success()));
  const std::string id = submit(*store);
  EXPECT_EQ(work(*store), id);
}

TEST_F(store_pressure, a_file_that_was_deleted_or_replaced_is_noticed) {
  if (!is_sqlite()) GTEST_SKIP() << "PostgreSQL has no such file";
  const auto store = open();
  const std::string lost = submit(*store);
  std::filesystem::remove(file());
  const std::string second = submit(*store);
  EXPECT_EQ(store->find(lost), std::nullopt);
  EXPECT_EQ(open()->find(second).value().id, second) << "it is in the file that others see";
  // Another file takes its place, as after a restore from a backup.
  const std::string backup = (folder_ / "backup.sqlite").string();
  std::string restored;
  {
    SqlStore other(make_sqlite_driver(backup), StoreRules{});
    restored = submit(other);
  }
  std::filesystem::rename(backup, file());
  EXPECT_EQ(store->find(second), std::nullopt);
  EXPECT_EQ(work(*store), restored);
  const std::string third = submit(*store);
  EXPECT_EQ(open()->find(third).value().id, third);
}

TEST_F(store_pressure, a_role_with_other_defaults_works_and_one_without_rights_to_create_too) {
  if (is_sqlite()) GTEST_SKIP() << "SQLite has no roles";
  submit(*open());
  const std::string role = "role_" + schema_;
  for (const std::string& sql : {"CREATE ROLE " + role + " LOGIN", "GRANT USAGE ON SCHEMA " + schema_ + " TO " + role,
                                 "GRANT ALL ON ALL TABLES IN SCHEMA " + schema_ + " TO " + role,
                                 "ALTER ROLE " + role + " SET default_transaction_isolation = 'repeatable read'"}) {
    run(sql);
  }
  std::string url = url_;
  url.replace(url.find("remeshd@"), std::string("remeshd").size(), role);
  const std::string options = "?options=-csearch_path%3D" + schema_;
  EXPECT_EQ(make_postgres_driver(url + options)->connect()->run("SHOW transaction_isolation").at(0)[0],
            "read committed");
  {
    SqlStore store(make_postgres_driver(url + options), StoreRules{});
    const std::string id = submit(store);
    EXPECT_FALSE(work(store).empty());
    store.upkeep();
  }
  run("DROP OWNED BY " + role);
  run("DROP ROLE " + role);
}

TEST_F(store_pressure, a_database_that_cannot_hold_all_text_is_refused) {
  if (is_sqlite()) GTEST_SKIP() << "SQLite stores UTF-8";
  const std::string name = "latin_" + schema_;
  run("CREATE DATABASE " + name + " ENCODING LATIN1 LOCALE 'C' TEMPLATE template0");
  std::string url = url_;
  url.replace(url.rfind('/') + 1, std::string::npos, name);
  SqlStore store(make_postgres_driver(url), StoreRules{});
  EXPECT_THROW(store.probe(), StoreUnusable);
  run("DROP DATABASE " + name);
}

// ---- a store that does not answer

TEST_F(store_pressure, a_call_waits_for_a_lock_until_its_deadline_and_not_longer) {
  StoreRules rules;
  rules.timeout = milliseconds(1000);
  const auto store = open(rules);
  const std::string id = submit(*store);
  const auto connector = driver();
  const auto other = connector->connect();
  other->begin();
  other->run(is_sqlite() ? "UPDATE remeshd_schema SET touched_ms = 0" : "LOCK TABLE remeshd_job IN EXCLUSIVE MODE");
  const Clock::time_point start = Clock::now();
  EXPECT_THROW(submit(*store), StoreError);
  EXPECT_THROW(store->claim("worker", kAnyMemory), StoreError);
  EXPECT_FALSE(store->is_well());
  EXPECT_EQ(state(*store, id), JobState::kQueued) << "reading goes on";
  // It would wait for 20 s each time without deadlines. The rest is for other work on the machine.
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(10));
  other->roll_back();
  EXPECT_EQ(work(*store), id);
}

TEST_F(store_pressure, the_calls_of_one_request_share_a_deadline) {
  const auto store = open();
  submit(*store);
  const auto connector = driver();
  const auto other = connector->connect();
  other->begin();
  other->run(is_sqlite() ? "UPDATE remeshd_schema SET touched_ms = 0" : "LOCK TABLE remeshd_job IN EXCLUSIVE MODE");
  const Clock::time_point start = Clock::now();
  {
    const SharedStoreDeadline deadline(start + milliseconds(200));
    for (int i = 0; i < 40; ++i) EXPECT_THROW(submit(*store), StoreError);
  }
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5)) << "40 calls with 5 s each would take 200 s";
  other->roll_back();
}

TEST_F(store_pressure, a_stopping_daemon_ends_its_calls) {
  const auto store = open();
  submit(*store);
  const auto connector = driver();
  const auto other = connector->connect();
  other->begin();
  other->run(is_sqlite() ? "UPDATE remeshd_schema SET touched_ms = 0" : "LOCK TABLE remeshd_job IN EXCLUSIVE MODE");
  store->end_calls_at(Clock::now());
  EXPECT_THROW(submit(*store), StoreError);
  other->roll_back();
}

TEST_F(store_pressure, a_claim_of_which_nobody_knows_is_undone_without_an_attempt) {
  const auto store = open();
  const std::string id = submit(*store);
  // The store hands the job out, but its answer gets lost: the statement changes the row and then waits.
  const auto connector = driver();
  const auto database = connector->connect();
  UncertainWrites writes;
  const std::optional<Claim> claim = store->claim("worker", kAnyMemory);
  ASSERT_TRUE(claim);
  const std::string worker = *run("SELECT worker FROM remeshd_job").at(0)[0];
  writes.note_claim(worker);
  EXPECT_TRUE(writes.has_new());
  writes.undo(*database);
  EXPECT_FALSE(writes.has_new());
  const JobRecord record = store->find(id).value();
  EXPECT_EQ(record.state, JobState::kQueued);
  EXPECT_EQ(record.attempts, 0);
  EXPECT_FALSE(store->renew(*claim, {"read", 0}));
  // The next claim of the same daemon has another name.
  const Claim next = store->claim("worker", kAnyMemory).value();
  writes.note_claim(worker);
  writes.undo(*database);
  EXPECT_TRUE(store->holds(next));
}

TEST_F(store_pressure, a_job_of_which_nobody_knows_is_withdrawn) {
  const auto store = open();
  const std::string id = submit(*store), other = submit(*store);
  const auto connector = driver();
  const auto database = connector->connect();
  UncertainWrites writes;
  writes.note_submission(id);
  writes.note_submission(new_request_id());
  writes.undo(*database);
  EXPECT_EQ(store->find(id), std::nullopt);
  EXPECT_EQ(store->read_blob(id, BlobKind::kInput), std::nullopt);
  EXPECT_EQ(work(*store), other);
}

// ---- time

TEST_F(store_pressure, waiting_counts_from_when_a_job_was_queued_last) {
  StoreRules rules;
  rules.queue_timeout = hours(1);
  const auto store = open(rules);
  submit(*store);
  run("UPDATE remeshd_job SET created_ms = created_ms - 7200000, queued_ms = queued_ms - 7200000");
  const Claim claim = store->claim("worker", kAnyMemory).value();
  EXPECT_TRUE(store->give_back(claim, JobStore::Attempt::kCounts));
  EXPECT_EQ(store->upkeep().timed_out, 0) << "it has waited for no time since then";
  EXPECT_EQ(state(*store, claim.id), JobState::kQueued);
  run("UPDATE remeshd_job SET queued_ms = queued_ms - 7200000");
  EXPECT_EQ(store->upkeep().timed_out, 1);
}

TEST_F(store_pressure, a_lease_that_lies_far_ahead_or_behind_is_not_what_counts) {
  StoreRules rules;
  rules.lease = hours(1);
  const auto store = open(rules);
  submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  run("UPDATE remeshd_job SET lease_ms = 0");
  EXPECT_EQ(store->upkeep().retried, 0);
  EXPECT_TRUE(store->holds(claim));
}

TEST_F(store_pressure, a_server_whose_clock_is_set_by_a_day_expires_nothing) {
  if (is_sqlite()) GTEST_SKIP() << "SQLite's clock does not follow the wall clock";
  StoreRules rules;
  rules.result_ttl = hours(2);
  for (const char* jump : {"+ 86400000", "- 86400000", "+ 3600000 * 3", "- 3600000 * 3"}) {
    const auto store = open(rules);
    const std::string id = submit(*store);
    EXPECT_EQ(work(*store), id);
    const std::string waiting = submit(*store);
    // A clock that jumps ahead is one whose last reading lies back, and the other way round.
    run(std::string("UPDATE remeshd_clock SET wall_ms = wall_ms - (0 ") + jump + "), store_ms = store_ms - (0 " + jump +
        ")");
    run(std::string("UPDATE remeshd_job SET created_ms = created_ms - (0 ") + jump + "), queued_ms = queued_ms - (0 " +
        jump + "), finished_ms = finished_ms - (0 " + jump + "), expires_ms = expires_ms - (0 " + jump + ")");
    for (int i = 0; i < 3; ++i) {
      const Upkeep done = store->upkeep();
      EXPECT_EQ(done.expired + done.timed_out + done.retried, 0) << jump;
    }
    EXPECT_EQ(state(*store, id), JobState::kSucceeded) << jump;
    EXPECT_EQ(work(*store), waiting) << jump;
  }
}

TEST_F(store_pressure, a_clock_that_was_wrong_by_years_comes_right_and_takes_all_times_with_it) {
  StoreRules rules;
  rules.result_ttl = hours(2);
  constexpr const char* kYears[] = {"+ 315360000000", "- 315360000000"};
  for (const char* wrong : kYears) {
    auto store = open(rules);
    const std::string id = submit(*store);
    EXPECT_EQ(work(*store), id);
    const std::int64_t before = store->find(id)->created_ms;
    run(is_sqlite() ? std::string("UPDATE remeshd_clock SET base_ms = base_ms ") + wrong
                    : std::string("UPDATE remeshd_clock SET store_ms = store_ms ") + wrong);
    run(std::string("UPDATE remeshd_job SET created_ms = created_ms ") + wrong + ", finished_ms = finished_ms " +
        wrong + ", expires_ms = expires_ms " + wrong);
    store = open(rules);  // as after a restart
    for (int i = 0; i < 2; ++i) EXPECT_EQ(store->upkeep().expired, 0) << wrong;
    EXPECT_EQ(state(*store, id), JobState::kSucceeded) << wrong;
    constexpr std::int64_t kMinute = 60'000;
    EXPECT_NEAR(static_cast<double>(store->find(id)->created_ms), static_cast<double>(before), kMinute) << wrong;
    const std::string next = submit(*store);
    EXPECT_NEAR(static_cast<double>(store->find(next)->created_ms), static_cast<double>(before), kMinute) << wrong;
    EXPECT_EQ(work(*store), next);
  }
}

// ---- room

TEST_F(store_pressure, what_may_be_stored_is_limited_and_deleting_makes_room) {
  StoreRules rules;
  rules.max_stored = 1000;
  rules.max_stored_per_owner = 600;
  const auto store = open(rules);
  const std::string body(400, 'x');
  const std::string first = submit(*store, body, "one");
  EXPECT_EQ(store->stored_bytes(), 400u);
  EXPECT_THROW(submit(*store, body, "one"), StoreFull) << "its own limit";
  submit(*store, body, "two");
  EXPECT_THROW(submit(*store, body, "three"), StoreFull) << "the limit of all";
  EXPECT_TRUE(store->is_well()) << "what is stored can be read and deleted";
  EXPECT_TRUE(store->cancel(first));
  EXPECT_EQ(store->stored_bytes(), 400u);
  submit(*store, body, "three");
}

TEST_F(store_pressure, memory_that_a_run_was_seen_to_take_is_its_next_estimate) {
  const auto store = open();
  const std::string id = submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  EXPECT_TRUE(store->give_back(claim, JobStore::Attempt::kDoesNotCount, 5000));
  EXPECT_FALSE(store->claim("worker", 4999));
  const Claim again = store->claim("worker", 5000).value();
  EXPECT_EQ(again.memory, 5000u);
  EXPECT_EQ(again.attempts, 1);
}

}  // namespace
}  // namespace remesh::server::jobs
