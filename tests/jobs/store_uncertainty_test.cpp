/// Tests what every job store does about changes of which nobody knows whether they were made.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/jobs/sql_store.h"
#include "server/work/request_registry.h"
#include "tests/jobs/store_fixture.h"

namespace remesh::server::jobs {
namespace {

class store_uncertainty : public StoreTest {};

TEST_F(store_uncertainty, a_claim_of_which_nobody_knows_is_undone_without_an_attempt) {
  const auto store = open();
  const std::string id = submit(*store);
  // The store hands the job out, but its answer gets lost: the statement changes the row and then waits.
  const auto connector = driver();
  const auto database = connector->connect();
  const BlobTable blobs(*connector, nullptr, patient_rules().timeout);
  UncertainWrites writes;
  const std::optional<Claim> claim = store->claim("worker", kAnyMemory);
  ASSERT_TRUE(claim);
  const std::string worker = *run("SELECT worker FROM remeshd_job").at(0)[0];
  writes.record_claim(worker);
  EXPECT_TRUE(writes.has_new());
  writes.undo(*database, blobs);
  EXPECT_FALSE(writes.has_new());
  const JobRecord record = store->find(id).value();
  EXPECT_EQ(record.state, JobState::kQueued);
  EXPECT_EQ(record.attempts, 0);
  EXPECT_FALSE(store->renew(*claim, {"read", 0}));
  // The next claim of the same daemon has another name.
  const Claim next = store->claim("worker", kAnyMemory).value();
  writes.record_claim(worker);
  writes.undo(*database, blobs);
  EXPECT_TRUE(store->holds(next));
}

TEST_F(store_uncertainty, a_job_of_which_nobody_knows_is_withdrawn) {
  const auto store = open();
  const std::string id = submit(*store), other = submit(*store);
  const auto connector = driver();
  const auto database = connector->connect();
  UncertainWrites writes;
  writes.record_submission(id);
  writes.record_submission(new_request_id());
  writes.undo(*database, BlobTable(*connector, nullptr, patient_rules().timeout));
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
  bool keeps_fractions() const override { return inner_->keeps_fractions(); }
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

TEST_F(store_uncertainty, a_submission_whose_answer_gets_lost_leaves_no_job) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), patient_rules());
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

TEST_F(store_uncertainty, a_submission_that_can_be_repeated_stays_although_its_answer_gets_lost) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), patient_rules());
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

TEST_F(store_uncertainty, a_submission_that_failed_before_it_was_certain_withdraws_nothing) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), patient_rules());
  const std::string good = submit(store);
  lost = "INSERT INTO remeshd_job";
  EXPECT_THROW(submit(store), StoreError);
  EXPECT_EQ(count("remeshd_job"), "1") << "it was rolled back";
  EXPECT_EQ(count("remeshd_blob"), "1");
  store.upkeep();
  EXPECT_EQ(work(store), good);
}

TEST_F(store_uncertainty, a_claim_whose_answer_gets_lost_is_no_attempt) {
  std::string lost;
  SqlStore store(std::make_unique<LossyDriver>(driver(), lost), patient_rules());
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

}  // namespace
}  // namespace remesh::server::jobs
