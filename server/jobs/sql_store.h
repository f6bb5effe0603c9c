/// The job store on top of an SQL database.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/jobs/blob_folder.h"
#include "server/jobs/database.h"
#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// A function that is called after each operation with its name, the seconds it took, and whether it failed.
using StoreObserver = std::function<void(std::string_view op, double seconds, bool failed)>;

class SqlStore : public JobStore {
 public:
  /// Does not connect yet. The first operation that reaches the database creates the schema or migrates it.
  /// Input: `folder` - the folder for inputs and results; null to store them in the database.
  SqlStore(std::unique_ptr<DatabaseDriver> driver, const StoreRules& rules,
           std::unique_ptr<BlobFolder> folder = nullptr, StoreObserver observer = nullptr);

  Submission submit(const NewJob& job) override;
  std::optional<Claim> claim(std::string_view worker, std::uint64_t max_memory) override;
  std::optional<std::string> read_blob(const std::string& id, BlobKind kind) override;
  std::optional<std::uint64_t> blob_size(const std::string& id, BlobKind kind) override;
  bool renew(const Claim& claim, const Progress& progress) override;
  bool holds(const Claim& claim) override;
  bool commit(const Claim& claim, const JobOutcome& outcome) override;
  bool give_back(const Claim& claim, Attempt attempt) override;
  std::optional<JobRecord> find(const std::string& id) override;
  std::vector<JobRecord> list(const std::string& owner, int limit) override;
  bool cancel(const std::string& id) override;
  bool discard(const std::string& id) override;
  Upkeep upkeep() override;
  QueueStatistics statistics() override;
  void probe() override;
  bool is_well() const override { return is_well_; }
  void wait_for_work(const Event& wake, Clock::time_point until) override;

 private:
  enum class Access { kRead, kWrite };

  /// Runs `operation` on a connection. If that connection broke before anything was committed, it runs it once more
  /// on a new one.
  template <typename Operation>
  auto with_database(std::string_view op, Access access, Operation operation);
  template <typename Operation>
  auto attempt(Operation& operation);
  void note(std::string_view op, Access access, Clock::time_point start, bool failed);

  void make_schema(Database& database);
  std::unique_ptr<Database> take_connection();
  void return_connection(std::unique_ptr<Database> database);

  /// The bytes of a blob, or the name of the file that holds them.
  struct Blob {
    std::string bytes;
    std::optional<std::string> file;
  };
  /// Output: as `read_blob`.
  std::optional<Blob> find_blob(const std::string& id, BlobKind kind);
  /// Asks the folder about the file of a blob.
  /// Output: nothing if the blob has expired.
  /// Errors: BlobLost, StoreError.
  template <typename Question>
  auto ask_folder(const std::string& id, BlobKind kind, Question question);
  std::optional<Submission> find_repeated(Database& database, const NewJob& job);
  std::int64_t next_turn(Database& database, const std::string& owner);
  void write_blob(Database& database, const std::string& id, BlobKind kind, std::string_view bytes);
  /// Output: the files to remove once the transaction is committed.
  std::vector<std::string> delete_blobs(Database& database, const std::string& id, const char* which);
  void remove_files(const std::vector<std::string>& files);
  void end_abandoned(Database& database, Upkeep& done);
  void end_waiting(Database& database, Upkeep& done);
  void expire_results(Database& database, Upkeep& done, std::vector<std::string>& files);
  void find_stray_files(Database& database, std::vector<std::string>& files);
  void forget_jobs(Database& database, Upkeep& done, std::vector<std::string>& files);

  const std::unique_ptr<DatabaseDriver> driver_;
  const StoreRules rules_;
  const std::unique_ptr<BlobFolder> folder_;
  const StoreObserver observer_;

  std::atomic<bool> is_well_{false};
  std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Database>> idle_;
  std::size_t open_ = 0;
  bool has_schema_ = false;
  std::atomic<int> swept_{0};  ///< number of folder parts searched for stray files so far
};

}  // namespace remesh::server::jobs
