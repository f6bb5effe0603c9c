/// Tests what every job store promises when its database, its load or its clock is not as it should be.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/job_upkeep.h"
#include "server/jobs/sql_store.h"
#include "server/work/request_registry.h"
#include "tests/jobs/store_fixture.h"
#include "tests/support/time_limit.h"

namespace remesh::server::jobs {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

class store_pressure : public StoreTest {};

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
    SqlStore other(make_sqlite_driver(backup), patient_rules());
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
    SqlStore store(make_postgres_driver(url + options), patient_rules());
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
  SqlStore store(make_postgres_driver(url), patient_rules());
  EXPECT_THROW(store.probe(), StoreUnusable);
  run("DROP DATABASE " + name);
}

// ---- a store that does not answer

TEST_F(store_pressure, a_call_waits_for_a_lock_until_its_deadline_and_not_longer) {
  at_some_pace([&](int slowdown) {
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(1000);
    const std::string id = submit(*open());  // which has time enough to make the tables
    const auto store = open(rules);
    store->probe();
    const auto other = locked_by_another();
    const Clock::time_point start = Clock::now();
    EXPECT_THROW(submit(*store), StoreError);
    EXPECT_THROW(store->claim("worker", kAnyMemory), StoreError);
    EXPECT_FALSE(store->is_well());
    EXPECT_EQ(state(*store, id), JobState::kQueued) << "reading goes on";
    // They take 3 s. It would wait for 20 s each time without deadlines.
    test::expect_sooner_than(slowdown * std::chrono::seconds(20), Clock::now() - start);
    other->roll_back();
    EXPECT_EQ(work(*store), id);
  });
}

TEST_F(store_pressure, the_calls_of_one_request_share_a_deadline) {
  submit(*open());
  const auto store = open(StoreRules{});
  const auto other = locked_by_another();
  const Clock::time_point start = Clock::now();
  {
    const SharedStoreDeadline deadline(start + milliseconds(200));
    for (int i = 0; i < 40; ++i) EXPECT_THROW(submit(*store), StoreError);
  }
  // 40 calls with 5 s each would take 200 s.
  test::expect_sooner_than(std::chrono::minutes(2), Clock::now() - start);
  other->roll_back();
}

TEST_F(store_pressure, a_stopping_daemon_ends_its_calls) {
  const auto store = open();
  submit(*store);
  const auto other = locked_by_another();
  const Clock::time_point start = Clock::now();
  store->end_calls_at(start);
  EXPECT_THROW(submit(*store), StoreError);
  test::expect_sooner_than(std::chrono::minutes(1), Clock::now() - start, "it would wait for minutes");
  other->roll_back();
}

// ---- stores that are large

TEST_F(store_pressure, tables_of_the_version_before_get_their_columns_however_long_that_takes) {
  at_some_pace([&](int slowdown) {
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
                                     "$$ BEGIN PERFORM pg_sleep(" +
                                         std::to_string(slowdown) + "); END $$",
                                     "CREATE EVENT TRIGGER slow_" + schema_ +
                                         " ON ddl_command_start WHEN TAG IN ('CREATE INDEX') EXECUTE FUNCTION slow()"});
    }
    for (const std::string& change : changes) run(change);
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(500);
    const auto store = open(rules);
    try {
      store->probe();
    } catch (const StoreError&) {
      // The call that has made the columns may have no time left for what it was called for.
    }
    if (!is_sqlite()) run("DROP EVENT TRIGGER slow_" + schema_);
    if (run("SELECT version FROM remeshd_schema").at(0)[0] != "2") throw StoreError("the columns were not made");
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
  });
}

TEST_F(store_pressure, a_blob_that_takes_longer_to_delete_than_a_call_may_take_is_deleted) {
  at_some_pace([&](int slowdown) {
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(3000);
    rules.result_ttl = milliseconds(0);
    const std::string large(35 * DatabaseDriver::kPiece, 'x');
    const std::string id = submit(*open(), large);
    const auto store = open(rules);
    constexpr int kRows = 2500;
    burden("blob", "DELETE", slowdown * 1.1, kRows);
    EXPECT_EQ(work(*store, large), id) << "the input is deleted";
    EXPECT_EQ(count("remeshd_blob WHERE kind = 'input'"), "0");
    std::this_thread::sleep_for(milliseconds(5));
    EXPECT_EQ(store->upkeep().expired, 1);
    EXPECT_EQ(count("remeshd_blob"), "0");
    EXPECT_EQ(store->stored_bytes(), 0u);
  });
}

TEST_F(store_pressure, a_blob_that_takes_longer_to_read_than_a_call_may_take_is_read) {
  if (is_sqlite()) GTEST_SKIP() << "SQLite cannot be made to read slowly";
  at_some_pace([&](int slowdown) {
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(1500);
    const std::string body(16 * DatabaseDriver::kPiece + 1, 'x');
    const std::string id = submit(*open(), body);
    const auto store = open(rules);
    // Each row whose data is looked at takes a millisecond, which makes more than 2 s for all of them.
    run("ALTER TABLE remeshd_blob RENAME TO blob_data");
    run(std::string("CREATE FUNCTION slow(data bytea) RETURNS bytea LANGUAGE plpgsql STABLE AS ") +
        "$$ BEGIN PERFORM pg_sleep(" + std::to_string(slowdown * 0.001) + "); RETURN data; END $$");
    run("CREATE VIEW remeshd_blob AS SELECT job, kind, part, slow(data) AS data, file, size FROM blob_data");
    EXPECT_EQ(store->blob_size(id, BlobKind::kInput), body.size());
    EXPECT_EQ(store->read_blob(id, BlobKind::kInput)->size(), body.size());
    run("UPDATE blob_data SET size = NULL");
    EXPECT_EQ(store->blob_size(id, BlobKind::kInput), body.size()) << "as an old daemon has stored it";
    EXPECT_EQ(store->read_blob(id, BlobKind::kInput)->size(), body.size());
    run("DROP VIEW remeshd_blob");
    run("ALTER TABLE blob_data RENAME TO remeshd_blob");
  });
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
  at_some_pace([&](int slowdown) {
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(1500);
    rules.result_ttl = milliseconds(0);
    rules.history = milliseconds(0);
    submit(*open());
    const auto store = open(rules);
    constexpr int kJobs = 12;
    for (int i = 1; i < kJobs; ++i) submit(*store);
    for (int i = 0; i < kJobs; ++i) EXPECT_FALSE(work(*store).empty());
    std::this_thread::sleep_for(milliseconds(5));
    burden("blob", "DELETE", slowdown * 0.2);
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
  });
}

TEST_F(store_pressure, times_of_many_jobs_are_shifted_a_few_at_a_time) {
  at_some_pace([&](int slowdown) {
    StoreRules rules = patient_rules();
    rules.timeout = slowdown * milliseconds(1500);
    submit(*open());
    const auto store = open(rules);
    constexpr int kJobs = 9000;
    run("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < " + std::to_string(kJobs) +
        ") INSERT INTO remeshd_job (id, owner, state, turn, memory, request, created_ms) SELECT 'job ' || i, '', "
        "'succeeded', i, 1, '{}', remeshd_now() FROM n");
    const std::string now = run("SELECT remeshd_now()").at(0)[0].value();
    run("UPDATE remeshd_job SET created_ms = created_ms - 315360000000");
    run(is_sqlite() ? "UPDATE remeshd_clock SET base_ms = base_ms - 315360000000"
                    : "UPDATE remeshd_clock SET store_ms = store_ms - 315360000000");
    constexpr int kRows = 3000;
    burden("job", "UPDATE", slowdown * 0.4, kRows);
    store->upkeep();
    constexpr const char* kMinute = " - 60000";
    EXPECT_EQ(count("remeshd_job WHERE created_ms < " + now + kMinute), "0");
  });
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
  bool keeps_fractions() const override { return true; }
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
  SqlStore store(std::make_unique<FullDriver>(), patient_rules());
  for (int i = 0; i < 5; ++i) EXPECT_THROW(store.probe(), std::bad_alloc);
}

// ---- time

TEST_F(store_pressure, waiting_counts_from_when_a_job_was_queued_last) {
  StoreRules rules = patient_rules();
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
  StoreRules rules = patient_rules();
  rules.lease = hours(1);
  const auto store = open(rules);
  submit(*store);
  const Claim claim = store->claim("worker", kAnyMemory).value();
  run("UPDATE remeshd_job SET lease_ms = 0");
  EXPECT_EQ(store->upkeep().retried, 0);
  EXPECT_TRUE(store->holds(claim));

  // Nor does one that lies years ahead keep the job of a dead worker.
  StoreRules short_rules = patient_rules();
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
  StoreRules rules = patient_rules();
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
  StoreRules rules = patient_rules();
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
  StoreRules rules = patient_rules();
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
