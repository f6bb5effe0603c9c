/// The interface of the job store, and its promise: a submitted job is never lost and never done twice, no matter
/// which process or host dies at which moment.
///
/// A job is queued, claimed by a worker under a lease, and committed once. A lease that is not renewed expires, and
/// the job is queued again. Each claim gets a token that is higher than all tokens before, and only the claim with
/// the newest token may commit. All times are read from one clock, the store's, in milliseconds since 1970.
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

/// The name of a state in the API: `queued`, ...
std::string_view state_name(JobState state);
std::optional<JobState> state_from_name(std::string_view name);
/// True if the state never changes again. The one exception is that a succeeded job expires later.
constexpr bool is_final(JobState state) { return state != JobState::kQueued && state != JobState::kRunning; }

/// The store cannot be reached or cannot write at the moment. Nothing has been changed, unless the connection was lost
/// during a commit.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The store has no room for the data to be written. Reading and deleting still work.
class StoreFull : public StoreError {
 public:
  using StoreError::StoreError;
};

/// The store has room for smaller operations, but not for this one.
class RoomRefused : public StoreFull {
 public:
  using StoreFull::StoreFull;
};

/// More data would be stored than the operator allows.
class LimitReached : public RoomRefused {
 public:
  using RoomRefused::RoomRefused;
};

/// The daemon must not use this store now or later, until an operator has changed something.
class StoreUnusable : public StoreError {
 public:
  using StoreError::StoreError;
};

/// The store works, but it cannot take these values, or its rows hold values that no daemon can have written. This is
/// an error of one job, not of the store.
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A stored input or result is gone or damaged and cannot be recovered. This is an error of one job, not of the
/// store.
class BlobLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A row names a file for a blob, but this daemon has no folder for them. If that is not damage, another daemon has
/// the folder.
class NoFolder : public BlobLost {
 public:
  using BlobLost::BlobLost;
};

/// The rules that all users of a store apply to its jobs. They must be the same on all daemons that share a store.
struct StoreRules {
  std::chrono::milliseconds lease{60'000};  ///< a job counts as abandoned this long after its last renewal
  int max_attempts = 3;  ///< a job is given up after this many workers have died while they worked on it
  std::chrono::milliseconds result_ttl{86'400'000};  ///< how long results, and jobs without a result, are stored
  std::chrono::milliseconds history{86'400'000};     ///< how long the record of an expired job is kept
  std::chrono::milliseconds queue_timeout{86'400'000};
  std::chrono::milliseconds idempotency_ttl{86'400'000};
  /// How long a call waits for a store that does not answer.
  std::chrono::milliseconds timeout{5'000};
  std::uint64_t max_stored = 0;            ///< bytes of all inputs and results together; 0: no limit
  std::uint64_t max_stored_per_owner = 0;  ///< the same for the jobs of one API key
  std::int64_t max_running_per_owner = 0;  ///< jobs of one API key that run at the same time; 0: no limit
};

/// A key that a client sends again when it repeats a request, and the digest of that request.
struct Idempotency {
  std::string key;
  std::string digest;
};

struct NewJob {
  std::string id;       ///< 128 random bits as 32 hexadecimal digits
  std::string owner;    ///< identifies the API key; empty if the server has no keys
  std::string request;  ///< everything of the request but its body, as JSON
  std::string_view body;
  std::uint64_t memory = 0;  ///< estimated bytes of memory that the work takes
  std::optional<Idempotency> idempotency;
};

struct Submission {
  enum class Kind { kNew, kRepeated, kKeyReused } kind = Kind::kNew;
  std::string id;               ///< the new or repeated job; for kKeyReused, the job to which the key belongs
  std::int64_t created_ms = 0;  ///< for kNew
};

/// The right to work on a job until the lease ends.
struct Claim {
  std::string id;
  std::int64_t token = 0;
  int attempts = 0;  ///< including this one
  std::uint64_t memory = 0;
  std::string request;
};

/// The way in which a job ended.
struct JobOutcome {
  JobState state = JobState::kSucceeded;
  std::string mesh;    ///< the packed mesh of a job that succeeded
  std::string report;  ///< the report of a job that succeeded
  int problem_status = 0;
  std::string problem;            ///< problem+json of a job that failed
  std::string problem_code = {};  ///< the code in `problem`, for metrics
};

struct JobRecord {
  std::string id;
  std::string owner;
  JobState state = JobState::kQueued;
  std::string stage;
  double fraction = 0;
  int attempts = 0;
  std::int64_t version = 0;  ///< increases with every change
  std::int64_t created_ms = 0;
  std::optional<std::int64_t> started_ms, finished_ms, expires_ms;
  int problem_status = 0;
  std::string problem;  ///< problem+json of a job that ended without a result; its request_id is the job's id
};

struct Progress {
  std::string stage;
  double fraction = 0;
};

enum class BlobKind { kInput, kMesh, kReport };

/// The changes that one call of `upkeep` made.
struct Upkeep {
  int retried = 0;    ///< jobs queued again because their worker died
  int crashed = 0;    ///< jobs failed because too many workers died
  int timed_out = 0;  ///< jobs that waited too long
  int expired = 0;    ///< results that expired
  int forgotten = 0;  ///< jobs that were removed
  int damaged = 0;    ///< jobs failed because their rows were damaged
  std::string error;  ///< what prevented some of the changes although the store works; or empty
};

/// A job that waits, and the memory that it needs.
struct WaitingJob {
  std::string id;
  std::uint64_t memory = 0;
};

struct QueueStatistics {
  std::int64_t queued = 0;
  std::int64_t running = 0;
  double oldest_queued_s = 0;
};

/// All members may be called from any thread.
/// Errors: all members throw StoreError.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Submits a job. Once this returns, the job survives the death of every process and of the host. If it is unknown
  /// whether the job was stored, the job is withdrawn as soon as the store answers. A job with an idempotency key is
  /// not withdrawn, because the client can repeat the request with the key.
  /// Errors: also StoreFull.
  virtual Submission submit(const NewJob& job) = 0;
  /// Claims the next job that needs at most `max_memory` bytes. Owners take turns; the jobs of one owner come in
  /// order of submission.
  virtual std::optional<Claim> claim(std::string_view worker, std::uint64_t max_memory) = 0;
  /// The job whose turn is next among all that need at most `max_memory` bytes.
  virtual std::optional<WaitingJob> next_in_turn(std::uint64_t max_memory) = 0;
  /// Output: nothing if the blob has expired.
  /// Errors: also BlobLost.
  virtual std::optional<std::string> read_blob(const std::string& id, BlobKind kind) = 0;
  /// The size of a blob in bytes.
  /// Output: as `read_blob`.
  /// Errors: as `read_blob`.
  virtual std::optional<std::uint64_t> blob_size(const std::string& id, BlobKind kind) = 0;
  /// Renews the lease and stores the progress.
  /// Output: false - the claim no longer owns the job.
  virtual bool renew(const Claim& claim, const Progress& progress) = 0;
  /// True if the claim still owns the job.
  virtual bool holds(const Claim& claim) = 0;
  /// Ends the job. A repeated commit of the same claim has no further effect.
  /// Output: false - the claim no longer owns the job, and nothing was changed.
  virtual bool commit(const Claim& claim, const JobOutcome& outcome) = 0;
  enum class Attempt { kCounts, kDoesNotCount };
  /// Returns the job to the queue.
  /// Input:  `memory` - a better estimate of the memory that the work takes.
  /// Output: as `renew`.
  virtual bool give_back(const Claim& claim, Attempt attempt, std::optional<std::uint64_t> memory = std::nullopt) = 0;

  virtual std::optional<JobRecord> find(const std::string& id) = 0;
  /// Lists the jobs of one owner, the newest first.
  virtual std::vector<JobRecord> list(const std::string& owner, int limit) = 0;
  /// Cancels a job.
  /// Output: true if this ended the job; false if it had ended before.
  virtual bool cancel(const std::string& id) = 0;
  /// Removes the stored data of a job that has ended.
  /// Output: true if the job had a result, which has now expired.
  virtual bool discard(const std::string& id) = 0;

  /// Makes the changes that are due with time: leases expire, waiting ends, results expire. Any number of daemons may
  /// call this.
  virtual Upkeep upkeep() = 0;
  virtual QueueStatistics statistics() = 0;
  /// The bytes of all inputs and results.
  virtual std::uint64_t stored_bytes() = 0;
  /// Writes a small value, to find out whether the store accepts writes.
  virtual void probe() = 0;
  /// False until the first successful write. After an error it is false until the next successful write.
  virtual bool is_well() const = 0;

  /// Makes all present and future calls that wait for the store end at the given time, because the daemon stops.
  virtual void end_calls_at(Clock::time_point time) = 0;

  /// Waits until `wake` is set, until there may be a job to claim, or until the given time.
  virtual void wait_for_work(const Event& wake, Clock::time_point until) = 0;
};

}  // namespace remesh::server::jobs
