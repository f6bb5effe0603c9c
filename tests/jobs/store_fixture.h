/// A store with a database of its own, and ways to change this database behind the store's back. The environment says
/// which store is tested, as for store_test.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <concepts>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "server/jobs/sql_store.h"
#include "server/work/request_registry.h"

namespace remesh::server::jobs {

inline constexpr std::uint64_t kAnyMemory = 1ull << 60;

/// Rules with so much time for a call that it does not run out on a busy machine, where a call that takes milliseconds
/// may take seconds. Every test begins with them; one in which time has to run out takes `at_some_pace`.
inline StoreRules patient_rules() {
  StoreRules rules;
  rules.timeout = std::chrono::minutes(2);
  return rules;
}

class StoreTest : public ::testing::Test {
 protected:
  StoreTest() : folder_(std::filesystem::temp_directory_path() / ("remeshd-store-" + new_request_id())) {
    const char* named = std::getenv("REMESHD_TEST_STORE");
    url_ = named == nullptr ? "sqlite" : named;
    make_room();
  }
  ~StoreTest() override { clear(); }

  bool is_sqlite() const { return url_ == "sqlite"; }
  std::string file() const { return (folder_ / "jobs.sqlite").string(); }
  std::unique_ptr<DatabaseDriver> driver(std::chrono::milliseconds timeout = patient_rules().timeout) const {
    if (is_sqlite()) return make_sqlite_driver(file());
    return make_postgres_driver(url_ + "?options=-csearch_path%3D" + schema_, timeout);
  }
  std::unique_ptr<JobStore> open(const StoreRules& rules = patient_rules()) const {
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

  static std::string submit(JobStore& store, std::string_view body = "body", const std::string& owner = "",
                            std::uint64_t memory = 1) {
    NewJob job;
    job.id = new_request_id();
    job.owner = owner;
    job.request = "{\"query\":[]}";
    job.body = body;
    job.memory = memory;
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

  /// Does a test whose calls have little time. If a call runs out of it, which may be the fault of a busy machine, the
  /// test is done again on an empty store, with all its times four and then sixteen times as long.
  /// Input: `attempt` multiplies its limits, and what it makes the store wait for, by its argument.
  template <std::invocable<int> Attempt>
  void at_some_pace(Attempt&& attempt) {
    for (const int slowdown : {1, 4}) {
      try {
        return attempt(slowdown);
      } catch (const StoreError&) {
        clear();
        make_room();
      }
    }
    attempt(16);
  }

 private:
  void on_server(const std::string& sql) const {
    if (!is_sqlite()) make_postgres_driver(url_, patient_rules().timeout)->connect()->run(sql.c_str());
  }
  void make_room() const {
    std::filesystem::create_directories(folder_);
    on_server("CREATE SCHEMA " + schema_);
  }
  void clear() const {
    on_server("DROP SCHEMA " + schema_ + " CASCADE");
    std::filesystem::remove_all(folder_);
  }

 protected:
  const std::filesystem::path folder_;
  const std::string schema_ = "test_" + new_request_id();
  std::string url_;
  std::unique_ptr<DatabaseDriver> locker_;
};

}  // namespace remesh::server::jobs
