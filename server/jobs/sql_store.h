/// The job store on top of an SQL database.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/jobs/blob_folder.h"
#include "server/jobs/blob_table.h"
#include "server/jobs/connection_pool.h"
#include "server/jobs/database.h"
#include "server/jobs/job_store.h"
#include "server/jobs/lease_judge.h"
#include "server/jobs/uncertain_writes.h"

namespace remesh::server::jobs {

/// A function that is called after each operation with its name, the seconds it took, and its error or null.
using StoreObserver = std::function<void(std::string_view op, double seconds, const StoreError* error)>;

class SqlStore : public JobStore {
 public:
  /// Makes a store that is not connected yet. The first operation that reaches the database creates the schema or
  /// migrates it.
  /// Input: `folder` - the folder for inputs and results; null to store them in the database.
  SqlStore(std::unique_ptr<DatabaseDriver> driver, const StoreRules& rules,
           std::unique_ptr<BlobFolder> folder = nullptr, StoreObserver observer = nullptr);

  Submission submit(const NewJob& job) override;
  std::optional<Claim> claim(std::string_view worker, std::uint64_t max_memory) override;
  std::optional<WaitingJob> next_in_turn(std::uint64_t max_memory) override;
  std::optional<std::string> read_blob(const std::string& id, BlobKind kind) override;
  std::optional<std::uint64_t> blob_size(const std::string& id, BlobKind kind) override;
  bool renew(const Claim& claim, const Progress& progress) override;
  bool holds(const Claim& claim) override;
  bool commit(const Claim& claim, const JobOutcome& outcome) override;
  bool give_back(const Claim& claim, Attempt attempt, std::optional<std::uint64_t> memory) override;
  std::optional<JobRecord> find(const std::string& id) override;
  std::vector<JobRecord> list(const std::string& owner, int limit) override;
  bool cancel(const std::string& id) override;
  bool discard(const std::string& id) override;
  Upkeep upkeep() override;
  QueueStatistics statistics() override;
  std::uint64_t stored_bytes() override;
  void probe() override;
  bool is_well() const override { return is_well_; }
  void end_calls_at(Clock::time_point time) override { end_.set(time); }
  void wait_for_work(const Event& wake, Clock::time_point until) override;

 private:
  /// The facts that an operation proves if it succeeds.
  enum class Access {
    kRead,   ///< nothing
    kProbe,  ///< that the store can be written
    kQueue,  ///< that the table of jobs can be written, even if nothing was written there
    kWrite,  ///< both
  };

  /// The room that is reserved for deletions may be used only by operations that make room.
  enum class Reserve { kMayBeUsed, kStays };

  /// Runs `operation` on a connection. If that connection broke before any commit, runs the operation once more on a
  /// new one. If the store has no room, makes some room and runs the operation again.
  template <typename Operation>
  auto with_database(std::string_view op, Access access, Operation operation, Reserve reserve = Reserve::kStays);
  template <typename Operation>
  auto attempt(Operation& operation, Reserve reserve);
  std::unique_ptr<Database> take_connection(const StoreDeadline& until);
  void note(std::string_view op, Access access, Clock::time_point start, const StoreError* error);
  StoreDeadline deadline() const;
  /// Checks that the database is still the one at the store's address. Data that was committed to another one is lost.
  /// Errors: StoreError.
  void check_is_current(const Database& database) const;

  /// Output: as `read_blob`.
  std::optional<BlobTable::Blob> find_blob(const std::string& id, BlobKind kind);
  /// Asks the folder about the file of a blob.
  /// Output: nothing if the blob has expired.
  /// Errors: BlobLost, StoreError.
  template <typename Question>
  auto ask_folder(const std::string& id, BlobKind kind, Question question);
  std::optional<Submission> find_repeated(Database& database, const NewJob& job);
  std::int64_t next_turn(Database& database, const std::string& owner);
  /// Errors: LimitReached - the job would be more than may be stored.
  void check_limits(Database& database, const NewJob& job) const;
  Submission insert(Database& database, const NewJob& job, bool& is_uncertain);
  /// The end of a statement that finds the next job to claim, beginning with the table. Two daemons that claim at the
  /// same moment from PostgreSQL may each claim the last job that one owner may run.
  /// Input: `memory` - the parameter that has the max memory of the job.
  std::string waiting_jobs(const char* memory) const;
  std::optional<Claim> claim_next(Database& database, std::string_view worker, std::uint64_t max_memory);

  const std::unique_ptr<DatabaseDriver> driver_;
  const StoreRules rules_;
  const BlobTable blobs_;
  const StoreObserver observer_;
  StoreEnd end_;
  ConnectionPool connections_;
  UncertainWrites uncertain_;
  LeaseJudge judge_;

  std::atomic<bool> is_well_{false};
  std::atomic<int> swept_{0};            ///< number of folder parts searched for stray files so far
  std::atomic<std::int64_t> claims_{0};  ///< number of attempts to claim
};

}  // namespace remesh::server::jobs
