/// Tests what every job store promises when its data, its database or its clock is not as it should be. The environment
/// says which store is tested, as for store_test.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/job_upkeep.h"
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
  std::unique_ptr<DatabaseDriver> driver(milliseconds timeout = StoreRules().timeout) const {
    if (is_sqlite()) return make_sqlite_driver(file());
    return make_postgres_driver(url_ + "?options=-csearch_path%3D" + schema_, timeout);
  }
  std::unique_ptr<JobStore> open(const StoreRules& rules = {}) const {
    return std::make_unique<SqlStore>(driver(rules.timeout), rules);
  }
  /// Holds a lock on a connection of its own, so that no job can be written until its transaction ends.
  std::unique_ptr<Database> locked_by_another() {
    locker_ = driver();
    std::unique_ptr<Database> other = locker_->connect();
    other->begin();
    other->run(is_sqlite() ? "UPDATE remeshd_schema SET touched_ms = 0" : "LOCK TABLE remeshd_job IN EXCLUSIVE MODE");
    return other;
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
  /// Lets each statement that changes rows of a table in this way take so many seconds more, and refuses those that
  /// change more rows. It has no effect for SQLite, which has no such triggers, and ends no statement by itself.
  void burden(const std::string& table, const std::string& change, double seconds, int max_rows = 1'000'000'000) const {
    if (is_sqlite()) return;
    run("CREATE FUNCTION burden_" + table + "() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN PERFORM pg_sleep(" +
        std::to_string(seconds) + "); IF (SELECT count(*) FROM touched) > " + std::to_string(max_rows) +
        " THEN RAISE EXCEPTION 'too many rows at once'; END IF; RETURN NULL; END $$");
    run("CREATE TRIGGER burden AFTER " + change + " ON remeshd_" + table + " REFERENCING OLD TABLE AS touched " +
        "FOR EACH STATEMENT EXECUTE FUNCTION burden_" + table + "()");
  }
  /// Makes a job's row refuse changes, as rows do that break a rule of the table.
  void refuse_changes_of(const std::string& id) const {
    if (is_sqlite()) {
      run("CREATE TRIGGER refuse BEFORE UPDATE ON remeshd_job WHEN old.id = '" + id +
          "' BEGIN SELECT RAISE(ABORT, 'no'); END");
      return;
    }
    run("CREATE FUNCTION refuse() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN "
        "RAISE EXCEPTION 'no' USING ERRCODE = 'check_violation'; END $$");
    run("CREATE TRIGGER refuse BEFORE UPDATE ON remeshd_job FOR EACH ROW WHEN (old.id = '" + id +
        "') EXECUTE FUNCTION refuse()");
  }
  std::string count(const std::string& rows) const { return run("SELECT count(*) FROM " + rows).at(0)[0].value(); }

  static JobState state(JobStore& store, const std::string& id) { return store.find(id).value().state; }

  const std::filesystem::path folder_;
  const std::string schema_ = "test_" + new_request_id();
  std::string url_;
  std::unique_ptr<DatabaseDriver> locker_;
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

TEST_F(store_pressure, damaged_times_and_sizes_do_not_count_for_other_jobs) {
  StoreRules rules;
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

TEST_F(store_pressure, a_problem_that_is_none_is_replaced) {
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

TEST_F(store_pressure, a_blob_in_a_file_is_no_failure_of_a_store_without_a_folder) {
  const auto store = open();
  const std::string id = submit(*store);
  run("UPDATE remeshd_blob SET file = 'a file'");
  EXPECT_THROW(store->read_blob(id, BlobKind::kInput), NoFolder);
  EXPECT_THROW(store->blob_size(id, BlobKind::kInput), NoFolder);
  EXPECT_TRUE(store->is_well());
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

TEST_F(store_pressure, a_damaged_row_that_cannot_be_mended_keeps_no_other_from_being_mended) {
  StoreRules rules;
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

TEST_F(store_pressure, a_result_that_cannot_expire_keeps_no_other_from_expiring) {
  StoreRules rules;
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

TEST_F(store_pressure, rows_without_an_id_are_removed) {
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
  const auto other = locked_by_another();
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
  const auto other = locked_by_another();
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
  const auto other = locked_by_another();
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
  const BlobTable blobs(*connector, nullptr, StoreRules().timeout);
  UncertainWrites writes;
  const std::optional<Claim> claim = store->claim("worker", kAnyMemory);
  ASSERT_TRUE(claim);
  const std::string worker = *run("SELECT worker FROM remeshd_job").at(0)[0];
  writes.note_claim(worker);
  EXPECT_TRUE(writes.has_new());
  writes.undo(*database, blobs);
  EXPECT_FALSE(writes.has_new());
  const JobRecord record = store->find(id).value();
  EXPECT_EQ(record.state, JobState::kQueued);
  EXPECT_EQ(record.attempts, 0);
  EXPECT_FALSE(store->renew(*claim, {"read", 0}));
  // The next claim of the same daemon has another name.
  const Claim next = store->claim("worker", kAnyMemory).value();
  writes.note_claim(worker);
  writes.undo(*database, blobs);
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
  writes.undo(*database, BlobTable(*connector, nullptr, StoreRules().timeout));
  EXPECT_EQ(store->find(id), std::nullopt);
  EXPECT_EQ(store->read_blob(id, BlobKind::kInput), std::nullopt);
  EXPECT_EQ(work(*store), other);
}

/// A database whose answers get lost: it does what it is told, and then says that it did not answer.
class LossyDatabase final : public Database {
 public:
  LossyDatabase(std::unique_ptr<Database> inner, std::string& lost, const StoreDeadline& deadline)
      : Database(deadline), inner_(std::move(inner)), lost_(lost) {}
  Database& inner() const { return *inner_; }

  Rows run(const char* sql, const Values& values, Result result) override {
    Rows rows = inner_->run(sql, values, result);
    lose_if(std::string_view(sql).substr(0, 60));
    return rows;
  }
  void begin() override { inner_->begin(); }
  void commit() override {
    inner_->commit();
    lose_if("COMMIT");
  }
  void roll_back() noexcept override { inner_->roll_back(); }
  void announce() override { inner_->announce(); }

 private:
  void lose_if(std::string_view statement) {
    if (lost_.empty() || statement.find(lost_) == std::string_view::npos) return;
    lost_.clear();
    throw StoreError("the answer got lost");
  }

  const std::unique_ptr<Database> inner_;
  std::string& lost_;
};

class LossyDriver final : public DatabaseDriver {
 public:
  explicit LossyDriver(std::unique_ptr<DatabaseDriver> inner, std::string& lost)
      : inner_(std::move(inner)), lost_(lost) {}

  std::unique_ptr<Database> connect_by(const StoreDeadline& deadline) override {
    return std::make_unique<LossyDatabase>(inner_->connect(), lost_, deadline);
  }
  std::string_view skip_locked() const override { return inner_->skip_locked(); }
  std::vector<std::string> schema_statements(std::int64_t version) const override {
    return inner_->schema_statements(version);
  }
  bool has_table(Database& database, std::string_view name) const override {
    return inner_->has_table(inner(database), name);
  }
  void lock_schema(Database& database) const override { inner_->lock_schema(inner(database)); }
  void prepare(Database& database) override { inner_->prepare(inner(database)); }
  void insert_piece(Database& database, std::string_view job, std::string_view kind, std::int64_t part,
                    std::string_view bytes, std::uint64_t size) override {
    inner_->insert_piece(inner(database), job, kind, part, bytes, size);
  }
  std::int64_t rows_of_blob(std::int64_t last) const override { return inner_->rows_of_blob(last); }
  void keep_clock(Database& database) override { inner_->keep_clock(inner(database)); }
  void tidy(Database& database) override { inner_->tidy(inner(database)); }
  void wait_for_work(const Event& wake, Clock::time_point until, const StoreDeadline& deadline) override {
    inner_->wait_for_work(wake, until, deadline);
  }
  std::size_t max_connections() const override { return inner_->max_connections(); }

 private:
  static Database& inner(Database& database) { return dynamic_cast<LossyDatabase&>(database).inner(); }

  const std::unique_ptr<DatabaseDriver> inner_;
  std::string& lost_;
};

TEST_F(store_pressure, a_submission_whose_answer_gets_lost_leaves_no_job) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), StoreRules{});
  const std::string good = submit(store);
  lost = "COMMIT";
  EXPECT_THROW(submit(store), StoreError);
  EXPECT_EQ(count("remeshd_job"), "2") << "it was stored";
  EXPECT_EQ(work(store), good);
  EXPECT_TRUE(work(store).empty()) << "it is withdrawn before any other job is claimed";
  EXPECT_EQ(count("remeshd_job"), "1");
  EXPECT_EQ(count("remeshd_blob WHERE kind = 'input'"), "0");
  // The upkeep withdraws it as well, in a daemon that claims nothing.
  lost = "COMMIT";
  EXPECT_THROW(submit(store), StoreError);
  store.upkeep();
  EXPECT_EQ(count("remeshd_job"), "1");
}

TEST_F(store_pressure, a_submission_that_can_be_repeated_stays_although_its_answer_gets_lost) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), StoreRules{});
  submit(store);
  EXPECT_FALSE(work(store).empty());
  NewJob job;
  job.id = new_request_id();
  job.request = "{\"query\":[]}";
  job.body = "body";
  job.memory = 1;
  job.idempotency = Idempotency{"key", "digest"};
  lost = "COMMIT";
  EXPECT_THROW(store.submit(job), StoreError);
  store.upkeep();
  NewJob again = job;
  again.id = new_request_id();
  const Submission repeated = store.submit(again);
  EXPECT_EQ(repeated.kind, Submission::Kind::kRepeated);
  EXPECT_EQ(repeated.id, job.id);
  EXPECT_EQ(work(store), job.id);
}

TEST_F(store_pressure, a_submission_that_failed_before_it_was_certain_withdraws_nothing) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), StoreRules{});
  const std::string good = submit(store);
  lost = "INSERT INTO remeshd_job";
  EXPECT_THROW(submit(store), StoreError);
  EXPECT_EQ(count("remeshd_job"), "1") << "it was rolled back";
  EXPECT_EQ(count("remeshd_blob"), "1");
  store.upkeep();
  EXPECT_EQ(work(store), good);
}

TEST_F(store_pressure, a_claim_whose_answer_gets_lost_is_no_attempt) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), StoreRules{});
  const std::string id = submit(store);
  for (int i = 0; i < 5; ++i) {
    lost = "UPDATE remeshd_job SET state = 'running'";
    EXPECT_THROW(store.claim("worker", kAnyMemory), StoreError);
    EXPECT_EQ(state(store, id), JobState::kRunning);
  }
  const Claim claim = store.claim("worker", kAnyMemory).value();
  EXPECT_EQ(claim.id, id);
  EXPECT_EQ(claim.attempts, 1);
  EXPECT_TRUE(store.commit(claim, success()));
}

// ---- stores that are large

TEST_F(store_pressure, tables_of_the_version_before_get_their_columns_however_long_that_takes) {
  const std::string body(3 * DatabaseDriver::kPiece, 'x');
  const std::string before = submit(*open(), body, "owner");
  std::vector<std::string> changes{"DROP INDEX remeshd_job_damaged",
                                   "DROP INDEX remeshd_job_stored",
                                   "DROP INDEX remeshd_job_waiting",
                                   "ALTER TABLE remeshd_job DROP COLUMN lease_length_ms",
                                   "ALTER TABLE remeshd_job DROP COLUMN queued_ms",
                                   "ALTER TABLE remeshd_job DROP COLUMN stored",
                                   "ALTER TABLE remeshd_blob DROP COLUMN size",
                                   "CREATE INDEX remeshd_job_waiting ON remeshd_job (created_ms)",
                                   "UPDATE remeshd_schema SET version = 1"};
  if (!is_sqlite()) {
    changes.insert(changes.end(), {"DROP TABLE remeshd_clock",
                                   "CREATE FUNCTION slow() RETURNS event_trigger LANGUAGE plpgsql AS "
                                   "$$ BEGIN PERFORM pg_sleep(1); END $$",
                                   "CREATE EVENT TRIGGER slow_" + schema_ +
                                       " ON ddl_command_start WHEN TAG IN ('CREATE INDEX') EXECUTE FUNCTION slow()"});
  }
  for (const std::string& change : changes) run(change);
  StoreRules rules;
  rules.timeout = milliseconds(500);
  const auto store = open(rules);
  try {
    store->probe();
  } catch (const StoreError&) {
    // The call that has made the columns may have no time left for what it was called for.
  }
  if (!is_sqlite()) run("DROP EVENT TRIGGER slow_" + schema_);
  EXPECT_EQ(*run("SELECT version FROM remeshd_schema").at(0)[0], "2");
  EXPECT_EQ(count(is_sqlite() ? "sqlite_master WHERE type = 'index' AND tbl_name = 'remeshd_blob'"
                              : "pg_indexes WHERE schemaname = current_schema() AND tablename = 'remeshd_blob'"),
            "1")
      << "an index of the blobs takes as long as they are large";
  const auto patient = open();
  EXPECT_EQ(patient->read_blob(before, BlobKind::kInput), body);
  EXPECT_EQ(patient->stored_bytes(), 0u) << "nobody has counted it";
  const std::string after = submit(*patient, body);
  EXPECT_EQ(patient->stored_bytes(), body.size());
  EXPECT_EQ(work(*patient), before);
  EXPECT_EQ(work(*patient), after);
}

TEST_F(store_pressure, a_blob_that_takes_longer_to_delete_than_a_call_may_take_is_deleted) {
  StoreRules rules;
  rules.timeout = milliseconds(3000);
  rules.result_ttl = milliseconds(0);
  const auto store = open(rules);
  const std::string large(35 * DatabaseDriver::kPiece, 'x');
  const std::string id = submit(*store, large);
  constexpr int kRows = 2500;
  burden("blob", "DELETE", 1.1, kRows);
  EXPECT_EQ(work(*store, large), id) << "the input is deleted";
  EXPECT_EQ(count("remeshd_blob WHERE kind = 'input'"), "0");
  std::this_thread::sleep_for(milliseconds(5));
  EXPECT_EQ(store->upkeep().expired, 1);
  EXPECT_EQ(count("remeshd_blob"), "0");
  EXPECT_EQ(store->stored_bytes(), 0u);
}

TEST_F(store_pressure, a_blob_that_takes_longer_to_read_than_a_call_may_take_is_read) {
  if (is_sqlite()) GTEST_SKIP() << "SQLite cannot be made to read slowly";
  StoreRules rules;
  rules.timeout = milliseconds(1500);
  const auto store = open(rules);
  const std::string body(16 * DatabaseDriver::kPiece + 1, 'x');
  const std::string id = submit(*store, body);
  // Each row whose data is looked at takes a millisecond, which makes more than 2 s for all of them.
  run("ALTER TABLE remeshd_blob RENAME TO blob_data");
  run("CREATE FUNCTION slow(data bytea) RETURNS bytea LANGUAGE plpgsql STABLE AS "
      "$$ BEGIN PERFORM pg_sleep(0.001); RETURN data; END $$");
  run("CREATE VIEW remeshd_blob AS SELECT job, kind, part, slow(data) AS data, file, size FROM blob_data");
  EXPECT_EQ(store->blob_size(id, BlobKind::kInput), body.size());
  EXPECT_EQ(store->read_blob(id, BlobKind::kInput)->size(), body.size());
  run("UPDATE blob_data SET size = NULL");
  EXPECT_EQ(store->blob_size(id, BlobKind::kInput), body.size()) << "as an old daemon has stored it";
  EXPECT_EQ(store->read_blob(id, BlobKind::kInput)->size(), body.size());
  run("DROP VIEW remeshd_blob");
  run("ALTER TABLE blob_data RENAME TO remeshd_blob");
}

TEST_F(store_pressure, a_size_that_its_pieces_contradict_is_noticed) {
  const auto store = open();
  const std::string body(2 * DatabaseDriver::kPiece + 7, 'x');
  const std::string id = submit(*store, body);
  EXPECT_EQ(store->blob_size(id, BlobKind::kInput), body.size());
  for (const char* size : {"9223372036854775807", "-1", "5", "10000000"}) {
    run(std::string("UPDATE remeshd_blob SET size = ") + size + " WHERE part = 0");
    EXPECT_THROW(store->blob_size(id, BlobKind::kInput), BlobLost) << size;
    EXPECT_THROW(store->read_blob(id, BlobKind::kInput), BlobLost) << size;
  }
}

TEST_F(store_pressure, results_that_take_longer_to_delete_than_a_call_may_take_are_deleted) {
  StoreRules rules;
  rules.timeout = milliseconds(1500);
  rules.result_ttl = milliseconds(0);
  rules.history = milliseconds(0);
  const auto store = open(rules);
  constexpr int kJobs = 12;
  for (int i = 0; i < kJobs; ++i) submit(*store);
  for (int i = 0; i < kJobs; ++i) EXPECT_FALSE(work(*store).empty());
  std::this_thread::sleep_for(milliseconds(5));
  burden("blob", "DELETE", 0.2);
  int expired = 0, forgotten = 0;
  for (int i = 0; i < 2 * kJobs && forgotten < kJobs; ++i) {
    const Upkeep done = store->upkeep();
    EXPECT_GT(done.expired + done.forgotten, 0);
    expired += done.expired;
    forgotten += done.forgotten;
  }
  EXPECT_EQ(expired, kJobs);
  EXPECT_EQ(forgotten, kJobs);
  EXPECT_EQ(count("remeshd_blob"), "0");
}

TEST_F(store_pressure, times_of_many_jobs_are_shifted_a_few_at_a_time) {
  StoreRules rules;
  rules.timeout = milliseconds(1500);
  const auto store = open(rules);
  submit(*store);
  constexpr int kJobs = 9000;
  run("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " + std::to_string(kJobs) +
      ") INSERT INTO remeshd_job (id, owner, state, turn, memory, request, created_ms) SELECT 'job ' || i, '', "
      "'succeeded', i, 1, '{}', remeshd_now() FROM n");
  const std::string now = run("SELECT remeshd_now()").at(0)[0].value();
  run("UPDATE remeshd_job SET created_ms = created_ms - 315360000000");
  run(is_sqlite() ? "UPDATE remeshd_clock SET base_ms = base_ms - 315360000000"
                  : "UPDATE remeshd_clock SET store_ms = store_ms - 315360000000");
  constexpr int kRows = 3000;
  burden("job", "UPDATE", 0.4, kRows);
  store->upkeep();
  constexpr const char* kMinute = " - 60000";
  EXPECT_EQ(count("remeshd_job WHERE created_ms < " + now + kMinute), "0");
}

/// A database in which every write finds no room, and whose driver runs out of memory while it looks for some.
class FullDatabase final : public Database {
 public:
  explicit FullDatabase(const StoreDeadline& deadline) : Database(deadline) {}
  Rows run(const char* sql, const Values&, Result) override {
    if (std::string_view(sql).starts_with("SELECT version")) return {{"2"}};
    throw StoreFull("no room");
  }
  void begin() override {}
  void commit() override {}
  void roll_back() noexcept override {}
  void announce() override {}
};

class FullDriver final : public DatabaseDriver {
 public:
  std::unique_ptr<Database> connect_by(const StoreDeadline& deadline) override {
    return std::make_unique<FullDatabase>(deadline);
  }
  std::string_view skip_locked() const override { return ""; }
  std::vector<std::string> schema_statements(std::int64_t) const override { return {}; }
  bool has_table(Database&, std::string_view) const override { return true; }
  void lock_schema(Database&) const override {}
  void prepare(Database&) override {}
  void insert_piece(Database&, std::string_view, std::string_view, std::int64_t, std::string_view,
                    std::uint64_t) override {}
  std::int64_t rows_of_blob(std::int64_t) const override { return 1; }
  bool cut_log(Database&) const override { throw std::bad_alloc(); }
  void keep_clock(Database&) override {}
  void tidy(Database&) override {}
  void wait_for_work(const Event&, Clock::time_point, const StoreDeadline&) override {}
  std::size_t max_connections() const override { return 2; }
};

TEST(store_pool, a_call_that_runs_out_of_memory_gives_its_connection_back) {
  StoreRules rules;
  rules.timeout = milliseconds(200);
  SqlStore store(std::make_unique<FullDriver>(), rules);
  for (int i = 0; i < 5; ++i) EXPECT_THROW(store.probe(), std::bad_alloc);
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

  // Nor does one that lies years ahead keep the job of a dead worker.
  StoreRules short_rules;
  short_rules.lease = milliseconds(50);
  for (const char* ahead : {"lease_ms = lease_ms + 315360000000, lease_length_ms = 50",
                            "lease_ms = 9223372036854775807, lease_length_ms = 9223372036854775807",
                            "lease_ms = NULL, lease_length_ms = NULL", "lease_ms = 0, lease_length_ms = -1"}) {
    const auto judge = open(short_rules);
    run(std::string("UPDATE remeshd_job SET state = 'running', attempts = 1, ") + ahead);
    int retried = 0;
    for (int i = 0; i < 500 && retried == 0; ++i) {
      retried = judge->upkeep().retried;
      std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_EQ(retried, 1) << ahead;
  }
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
  const std::string third = submit(*store, body, "three");
  EXPECT_FALSE(work(*store, std::string(100, 'x')).empty());
  EXPECT_EQ(store->stored_bytes(), 400u + 100u + 2u) << "results count in place of the input";
  EXPECT_EQ(work(*store), third);
  EXPECT_TRUE(store->discard(third));
  EXPECT_EQ(store->stored_bytes(), 100u + 2u);
  // A daemon of an older version removes blobs without counting them.
  run("UPDATE remeshd_job SET state = 'expired' WHERE state = 'succeeded'");
  EXPECT_EQ(store->stored_bytes(), 0u);
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
