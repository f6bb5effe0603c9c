/// Where jobs are kept, and what is promised of them: a job that was submitted is neither lost nor done twice, whatever
/// process or host dies when.
///
/// A job is queued, claimed by a worker under a lease, and committed once. A lease that is not renewed runs out, and
/// the job is queued again; the token that each claim gets is higher than all before, and only the newest may commit.
/// All times are those of one clock, the store's: milliseconds since 1970 on it, wherever they are compared.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/connection.h"

namespace remesh::server::jobs {

enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled, kExpired };

/// The name in the contract: `queued`, ...
std::string_view state_name(JobState state);
std::optional<JobState> state_from_name(std::string_view name);
/// Whether the state never changes again, but for a result that expires.
constexpr bool is_final(JobState state) { return state != JobState::kQueued && state != JobState::kRunning; }

/// The store cannot be asked now, or cannot write: nothing has been changed, unless it was lost while committing.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What was kept of a job is gone or damaged, and nothing brings it back: an error of that job, not of the store.
class BlobLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What whoever asks the store holds jobs to; to be the same on all daemons that share one.
struct StoreRules {
  std::chrono::milliseconds lease{60'000};           ///< after its last renewal a job counts as abandoned
  int max_attempts = 3;                              ///< so many workers may die of one job
  std::chrono::milliseconds result_ttl{86'400'000};  ///< of results, and of jobs without one
  std::chrono::milliseconds history{86'400'000};     ///< how long an expired job is remembered
  std::chrono::milliseconds queue_timeout{86'400'000};
  std::chrono::milliseconds idempotency_ttl{86'400'000};
};

/// A key that a client repeats with its request, and the digest of that request.
struct Idempotency {
  std::string key;
  std::string digest;
};

struct NewJob {
  std::string id;       ///< 128 random bits as 32 hexadecimal digits
  std::string owner;    ///< of whose key; empty where there are no keys
  std::string request;  ///< what stands beside the body, as JSON
  std::string_view body;
  std::uint64_t memory = 0;  ///< bytes that the work is estimated to take
  std::optional<Idempotency> idempotency;
};

struct Submission {
  enum class Kind { kNew, kRepeated, kKeyReused } kind = Kind::kNew;
  std::string id;  ///< of the job that this is; of kKeyReused the one that the key was for
};

/// The right to work on a job until the lease ends.
struct Claim {
  std::string id;
  std::int64_t token = 0;
  int attempts = 0;  ///< this one included
  std::uint64_t memory = 0;
  std::string request;
};

/// How a job ended.
struct JobOutcome {
  JobState state = JobState::kSucceeded;
  std::string mesh;    ///< of a success
  std::string report;  ///< of a success
  int problem_status = 0;
  std::string problem;            ///< of a failure: problem+json
  std::string problem_code = {};  ///< the code in it, for whoever counts
};

struct JobRecord {
  std::string id;
  std::string owner;
  JobState state = JobState::kQueued;
  std::string stage;
  double fraction = 0;
  int attempts = 0;
  std::int64_t version = 0;  ///< rises with every change
  std::int64_t created_ms = 0;
  std::optional<std::int64_t> started_ms, finished_ms, expires_ms;
  int problem_status = 0;
  std::string problem;  ///< of a job without a result: problem+json, its request_id the job's id
};

struct Progress {
  std::string stage;
  double fraction = 0;
};

enum class BlobKind { kInput, kMesh, kReport };

/// What upkeep changed.
struct Upkeep {
  int retried = 0;    ///< whose worker died
  int crashed = 0;    ///< the same once too often
  int timed_out = 0;  ///< waited too long
  int expired = 0;    ///< results
  int forgotten = 0;  ///< jobs that are no longer known
};

struct QueueStatistics {
  std::int64_t queued = 0;
  std::int64_t running = 0;
  double oldest_queued_s = 0;
};

/// All members may be called from any thread. Errors: StoreError, of all of them.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Once this returns, the job survives the death of every process and of the host.
  virtual Submission submit(const NewJob& job) = 0;
  /// The next job that takes no more than `max_memory`; jobs of all owners in turn, each owner's in order.
  virtual std::optional<Claim> claim(std::string_view worker, std::uint64_t max_memory) = 0;
  /// Output: nothing where its time is over. Errors: BlobLost, too.
  virtual std::optional<std::string> read_blob(const std::string& id, BlobKind kind) = 0;
  /// Its bytes. Output, errors: as `read_blob`.
  virtual std::optional<std::uint64_t> blob_size(const std::string& id, BlobKind kind) = 0;
  /// Renews the lease and tells progress. Output: false - the job is no longer this claim's.
  virtual bool renew(const Claim& claim, const Progress& progress) = 0;
  /// Whether the job is still this claim's.
  virtual bool holds(const Claim& claim) = 0;
  /// Ends the job. Output: false - the job is no longer this claim's, and nothing was changed. Told twice, it is done
  /// once.
  virtual bool commit(const Claim& claim, const JobOutcome& outcome) = 0;
  enum class Attempt { kCounts, kDoesNotCount };
  /// Gives the job back to the queue. Output: as `renew`.
  virtual bool give_back(const Claim& claim, Attempt attempt) = 0;

  virtual std::optional<JobRecord> find(const std::string& id) = 0;
  /// The newest first.
  virtual std::vector<JobRecord> list(const std::string& owner, int limit) = 0;
  /// Output: true where that ended it; false where it had ended.
  virtual bool cancel(const std::string& id) = 0;
  /// Ends the time of what is kept of a job that has ended. Output: true where that was a result, which is now expired.
  virtual bool discard(const std::string& id) = 0;

  /// What time brings: leases run out, waiting ends, results expire. Any daemon may do it, and any number.
  virtual Upkeep upkeep() = 0;
  virtual QueueStatistics statistics() = 0;
  /// Writes a little, to see whether that can be done.
  virtual void probe() = 0;
  /// False until something was written, and from an error on until something was written again.
  virtual bool is_well() const = 0;

  /// Waits until `wake`, until there may be something to claim, or until that time.
  virtual void wait_for_work(const Event& wake, Clock::time_point until) = 0;
};

}  // namespace remesh::server::jobs
