#include "server/jobs/sql_store.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "server/jobs/job_json.h"
#include "server/jobs/job_upkeep.h"
#include "server/jobs/row_values.h"
#include "server/jobs/schema.h"

namespace remesh::server::jobs {
namespace {

/// If leases are short, long pauses must not count, see LeaseJudge.
std::chrono::milliseconds max_pause(const StoreRules& rules) {
  return std::max<std::chrono::milliseconds>(rules.lease / 4, std::chrono::seconds(2));
}

std::int64_t signed_bytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMost = 9'000'000'000'000'000'000;  // see kOutOfRange
  return static_cast<std::int64_t>(std::min(bytes, kMost));
}

/// Fills in the missing values of a damaged row, so that its job can be shown as a failed one.
void mend(JobRecord& record) {
  if (record.state != JobState::kFailed && record.state != JobState::kCancelled) return;
  constexpr int kFirstError = 400;
  constexpr int kLastError = 599;
  if (record.problem_status < kFirstError || record.problem_status > kLastError) record.problem_status = 500;
  if (is_problem(record.problem)) return;
  record.problem = problem_text(record.problem_status, "internal", "the job's row in the store is damaged");
  const std::size_t place = record.problem.find("{job}");
  if (place != std::string::npos) record.problem.replace(place, std::string_view("{job}").size(), record.id);
}

/// Each job's row stores the size of its blobs, because adding up the blobs takes time in proportion to their size.
/// Data stored by daemons of an older version does not count.
const std::string kStoredBytes =
    std::string(
        "SELECT CAST(coalesce(sum(stored), 0) AS bigint) FROM remeshd_job "
        "WHERE stored <= 1000000000000000 AND ") +  // a damaged number must not distort the sum for all other jobs
    kJobWithBlobs;
/// The max turn of a job.
constexpr std::int64_t kMaxTurn = 8'000'000'000'000'000;
/// The max number of attempts for a job.
constexpr std::int64_t kMaxAttempts = 1'000'000;

/// A connection that goes back to its pool at the end of its scope, however that ends.
class Borrowed {
 public:
  Borrowed(ConnectionPool& pool, std::unique_ptr<Database> database) : pool_(pool), database_(std::move(database)) {}
  ~Borrowed() { pool_.give(std::move(database_)); }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;

  Database& get() { return *database_; }
  void close() { database_.reset(); }

 private:
  ConnectionPool& pool_;
  std::unique_ptr<Database> database_;
};

constexpr const char* kRecord =
    "SELECT id, owner, state, stage, fraction, attempts, version, created_ms, started_ms, finished_ms, expires_ms, "
    "problem_status, problem FROM remeshd_job ";

JobRecord record_of(const Row& row) {
  JobRecord record;
  record.id = row[0].value();
  record.owner = row[1].value();
  record.state = state_from_name(row[2].value()).value_or(JobState::kFailed);
  record.stage = row[3].value();
  record.fraction = std::strtod(row[4].value().c_str(), nullptr);
  record.attempts = static_cast<int>(std::clamp<std::int64_t>(maybe_integer(row[5]).value_or(0), 0, kMaxAttempts));
  record.version = maybe_integer(row[6]).value_or(0);
  record.created_ms = maybe_integer(row[7]).value_or(0);
  record.started_ms = maybe_integer(row[8]);
  record.finished_ms = maybe_integer(row[9]);
  record.expires_ms = maybe_integer(row[10]);
  record.problem_status = static_cast<int>(std::clamp<std::int64_t>(maybe_integer(row[11]).value_or(0), 0, 999));
  record.problem = row[12].value();
  mend(record);
  return record;
}

}  // namespace

SqlStore::SqlStore(std::unique_ptr<DatabaseDriver> driver, const StoreRules& rules, std::unique_ptr<BlobFolder> folder,
                   StoreObserver observer)
    : driver_(std::move(driver)),
      rules_(rules),
      blobs_(*driver_, std::move(folder), rules.timeout),
      observer_(std::move(observer)),
      connections_(*driver_),
      judge_(max_pause(rules)) {}

// ---- operations

StoreDeadline SqlStore::deadline() const {
  return StoreDeadline(SharedStoreDeadline::current(Clock::now() + rules_.timeout), end_);
}

/// Opening a store needs a little room, too.
std::unique_ptr<Database> SqlStore::take_connection(const StoreDeadline& until) {
  for (;;) {
    try {
      return connections_.take(until);
    } catch (const StoreFull&) {
      if (!driver_->release_reserve()) throw;
    }
  }
}

template <typename Operation>
auto SqlStore::attempt(Operation& operation, Reserve reserve) {
  const StoreDeadline until = deadline();
  bool may_reconnect = true, may_cut = true;
  for (;;) {
    Borrowed borrowed(connections_, take_connection(until));
    try {
      auto result = operation(borrowed.get());
      driver_->after(borrowed.get());
      return result;
    } catch (const ConnectionBroken& error) {
      if (dynamic_cast<const SchemaMissing*>(&error) != nullptr) connections_.forget_schema();
      borrowed.close();
      connections_.close_idle();
      if (!std::exchange(may_reconnect, false) || until.is_over()) throw;
    } catch (const LimitReached&) {
      throw;
    } catch (const StoreFull&) {
      const bool has_room = (std::exchange(may_cut, false) && driver_->cut_log(borrowed.get())) ||
                            (reserve == Reserve::kMayBeUsed && driver_->release_reserve());
      if (!has_room) throw;
    }
  }
}

template <typename Operation>
auto SqlStore::with_database(std::string_view op, Access access, Operation operation, Reserve reserve) {
  const Clock::time_point start = Clock::now();
  try {
    auto result = attempt(operation, reserve);
    note(op, access, start, nullptr);
    return result;
  } catch (const LimitReached&) {
    note(op, Access::kRead, start, nullptr);  // the store is well: some limit on stored data is reached
    throw;
  } catch (const RoomRefused& error) {
    note(op, Access::kRead, start, &error);  // nothing was tried, so this proves nothing about other operations
    throw;
  } catch (const StoreError& error) {
    note(op, access, start, &error);
    throw;
  }
}

void SqlStore::note(std::string_view op, Access access, Clock::time_point start, const StoreError* error) {
  const Clock::time_point end = Clock::now();
  const bool reaches_jobs = access == Access::kQueue || access == Access::kWrite;
  if (error != nullptr) {
    // A full store answers, and can still be read and emptied.
    const bool is_full = dynamic_cast<const StoreFull*>(error) != nullptr;
    if (!is_full) is_well_ = false;
    if (is_full && access == Access::kProbe) is_well_ = true;
    if (access != Access::kRead) judge_.record_failed();
  } else {
    if (access == Access::kProbe || access == Access::kWrite) is_well_ = true;
    if (reaches_jobs) judge_.record_reached(start, end);
  }
  if (observer_) observer_(op, std::chrono::duration<double>(end - start).count(), error);
}

void SqlStore::check_is_current(const Database& database) const {
  if (!driver_->is_current(database)) throw StoreError("the database was replaced by another one just now");
}

// ---- blobs

std::optional<BlobTable::Blob> SqlStore::find_blob(const std::string& id, BlobKind kind) {
  return with_database("read", Access::kRead, [&](Database& database) { return blobs_.find(database, id, kind); });
}

/// This runs outside `with_database`, because an error of a file proves nothing about the health of the store.
template <typename Question>
auto SqlStore::ask_folder(const std::string& id, BlobKind kind, Question question) {
  using Answer = std::optional<decltype(question(blobs_.folder()))>;
  try {
    return Answer(question(blobs_.folder()));
  } catch (const BlobLost&) {
    if (find_blob(id, kind)) throw;
    return Answer();  // the blob expired meanwhile
  }
}

std::optional<std::string> SqlStore::read_blob(const std::string& id, BlobKind kind) {
  std::optional<BlobTable::Blob> blob = find_blob(id, kind);
  if (!blob) return std::nullopt;
  if (!blob->file) return std::move(blob->bytes);
  return ask_folder(id, kind, [&](const BlobFolder& folder) { return folder.read(*blob->file); });
}

std::optional<std::uint64_t> SqlStore::blob_size(const std::string& id, BlobKind kind) {
  const std::optional<BlobTable::Size> size =
      with_database("size", Access::kRead, [&](Database& database) { return blobs_.size(database, id, kind); });
  if (!size) return std::nullopt;
  if (!size->file) return size->bytes;
  return ask_folder(id, kind, [&](const BlobFolder& folder) { return folder.size(*size->file); });
}

// ---- submission

std::optional<Submission> SqlStore::find_repeated(Database& database, const NewJob& job) {
  if (!job.idempotency) return std::nullopt;
  const auto& [key, digest] = *job.idempotency;
  // The first of several equal submissions inserts the row. The other submissions wait for that transaction and then
  // find the row. An expired row counts as absent.
  const Rows inserted = database.run(
      "INSERT INTO remeshd_idempotency (owner, key, digest, job, expires_ms) "
      "VALUES ($1, $2, $3, $4, remeshd_now() + $5) ON CONFLICT (owner, key) DO UPDATE "
      "SET digest = excluded.digest, job = excluded.job, expires_ms = excluded.expires_ms "
      "WHERE remeshd_idempotency.expires_ms <= remeshd_now() RETURNING job",
      {std::string_view(job.owner), std::string_view(key), std::string_view(digest), std::string_view(job.id),
       std::int64_t{rules_.idempotency_ttl.count()}});
  if (!inserted.empty()) return std::nullopt;
  const Rows known = database.run("SELECT digest, job FROM remeshd_idempotency WHERE owner = $1 AND key = $2",
                                  {std::string_view(job.owner), std::string_view(key)});
  if (known.empty()) throw StoreError("an Idempotency-Key expired just now");
  const auto kind = known[0][0] == digest ? Submission::Kind::kRepeated : Submission::Kind::kKeyReused;
  return Submission{kind, known[0][1].value()};
}

/// Returns the position of an owner's next job in the order of all jobs. The position is one after the owner's last
/// job, but not before the job that is running now. An owner without jobs for some time therefore gets no credit for
/// that time.
/// Source: start-time fair queueing (Goyal, Vin, Cheng, Start-time Fair Queueing, 1996), with all jobs of one size.
std::int64_t SqlStore::next_turn(Database& database, const std::string& owner) {
  // All later turns would follow a damaged turn, so turns that no daemon can have given do not count. SQLite may store
  // a fraction in a column of integers.
  const Rows now = database.run(
      "SELECT CAST(coalesce((SELECT max(turn) FROM remeshd_job WHERE state = 'running' AND turn BETWEEN 0 AND $1),"
      " (SELECT min(turn) FROM remeshd_job WHERE state = 'queued' AND turn BETWEEN 0 AND $1),"
      " (SELECT max(last_turn) FROM remeshd_owner WHERE last_turn BETWEEN 0 AND $1), 0) AS bigint)",
      {kMaxTurn});
  const Rows turn = database.run(
      "INSERT INTO remeshd_owner (owner, last_turn) VALUES ($1, $2) ON CONFLICT (owner) DO UPDATE "
      "SET last_turn = CASE WHEN remeshd_owner.last_turn BETWEEN excluded.last_turn AND $3 "
      "THEN CAST(remeshd_owner.last_turn AS bigint) + 1 ELSE excluded.last_turn END RETURNING last_turn",
      {std::string_view(owner), integer(now.at(0)[0]), kMaxTurn});
  return integer(turn.at(0)[0]);
}

void SqlStore::check_limits(Database& database, const NewJob& job) const {
  const auto check = [&](std::uint64_t limit, const std::string& sql, const Values& values, const char* whose) {
    if (limit == 0) return;
    const auto stored = static_cast<std::uint64_t>(integer(database.run(sql.c_str(), values).at(0)[0]));
    if (job.body.size() > limit || stored > limit - job.body.size())
      throw LimitReached("the jobs of " + std::string(whose) + " have reached the limit on their stored bytes");
  };
  check(rules_.max_stored, kStoredBytes, {}, "this store");
  check(rules_.max_stored_per_owner, kStoredBytes + " AND owner = $1", {std::string_view(job.owner)}, "this API key");
}

Submission SqlStore::insert(Database& database, const NewJob& job, bool& is_uncertain) {
  Transaction transaction(database);
  if (const std::optional<Submission> repeated = find_repeated(database, job)) return *repeated;
  check_limits(database, job);
  driver_->check_room(database, job.body.size(), RoomFor::kNewJob);
  blobs_.write(database, job.id, BlobKind::kInput, job.body);
  const std::int64_t turn = next_turn(database, job.owner);
  const Rows rows = database.run(
      "INSERT INTO remeshd_job (id, owner, state, turn, memory, request, stored, created_ms, queued_ms) "
      "VALUES ($1, $2, 'queued', $3, $4, $5, $6, remeshd_now(), remeshd_now()) RETURNING created_ms",
      {std::string_view(job.id), std::string_view(job.owner), turn, signed_bytes(job.memory),
       std::string_view(job.request), signed_bytes(job.body.size())});
  database.announce();
  is_uncertain = true;
  transaction.commit();
  check_is_current(database);
  return Submission{Submission::Kind::kNew, job.id, integer(rows.at(0)[0])};
}

Submission SqlStore::submit(const NewJob& job) {
  bool is_uncertain = false;
  try {
    return with_database("submit", Access::kWrite,
                         [&](Database& database) { return insert(database, job, is_uncertain); });
  } catch (const StoreError&) {
    if (is_uncertain && !job.idempotency) uncertain_.record_submission(job.id);
    throw;
  }
}

// ---- claims

std::string SqlStore::waiting_jobs(const char* memory) const {
  std::string sql = std::string(" FROM remeshd_job WHERE state = 'queued' AND memory <= ") + memory + " AND " +
                    sound_job(driver_->keeps_fractions());
  if (rules_.max_running_per_owner > 0) {
    // Jobs without an owner are those of a daemon without keys.
    sql +=
        " AND (owner = '' OR owner NOT IN (SELECT owner FROM remeshd_job WHERE state = 'running' GROUP BY owner "
        "HAVING count(*) >= " +
        std::to_string(rules_.max_running_per_owner) + "))";
  }
  return sql + " ORDER BY turn, created_ms, id LIMIT 1";
}

std::optional<Claim> SqlStore::claim_next(Database& database, std::string_view worker, std::uint64_t max_memory) {
  if (uncertain_.has_new()) blobs_.remove_files(uncertain_.undo(database, blobs_));
  // No two attempts have the same name, so that it can be determined later whether this attempt has claimed a job.
  const std::string attempt = std::string(worker) + "." + std::to_string(++claims_);
  const std::string sql =
      "UPDATE remeshd_job SET state = 'running', token = token + 1, attempts = attempts + 1, version = version + 1, "
      "worker = $1, stage = 'read', fraction = 0, started_ms = remeshd_now(), lease_ms = remeshd_now() + $2, "
      "lease_length_ms = $2 WHERE id = (SELECT id" +
      waiting_jobs("$3") + std::string(driver_->skip_locked()) +
      ") RETURNING id, token, attempts, memory, request, version";
  Rows rows;
  try {
    rows = database.run(sql.c_str(),
                        {std::string_view(attempt), std::int64_t{rules_.lease.count()}, signed_bytes(max_memory)});
  } catch (const StoreError&) {
    uncertain_.record_claim(attempt);
    throw;
  }
  if (rows.empty()) return std::nullopt;
  const Row& row = rows[0];
  judge_.see({row[0].value(), integer(row[1]), integer(row[5]), rules_.lease});
  return Claim{row[0].value(), integer(row[1]), static_cast<int>(integer(row[2])),
               static_cast<std::uint64_t>(integer(row[3])), row[4].value()};
}

std::optional<Claim> SqlStore::claim(std::string_view worker, std::uint64_t max_memory) {
  return with_database("claim", Access::kQueue,
                       [&](Database& database) { return claim_next(database, worker, max_memory); });
}

std::optional<WaitingJob> SqlStore::next_in_turn(std::uint64_t max_memory) {
  const std::string sql = "SELECT id, memory" + waiting_jobs("$1");
  return with_database("look", Access::kRead, [&](Database& database) -> std::optional<WaitingJob> {
    const Rows rows = database.run(sql.c_str(), {signed_bytes(max_memory)});
    if (rows.empty()) return std::nullopt;
    return WaitingJob{rows[0][0].value(), static_cast<std::uint64_t>(integer(rows[0][1]))};
  });
}

bool SqlStore::renew(const Claim& claim, const Progress& progress) {
  return with_database("renew", Access::kWrite, [&](Database& database) {
    return database.finds(
        "UPDATE remeshd_job SET stage = $1, fraction = $2, lease_ms = remeshd_now() + $3, "
        "lease_length_ms = $3, version = version + 1 WHERE id = $4 AND token = $5 AND state = 'running' "
        "RETURNING id",
        {std::string_view(progress.stage), progress.fraction, std::int64_t{rules_.lease.count()},
         std::string_view(claim.id), claim.token});
  });
}

bool SqlStore::holds(const Claim& claim) {
  return with_database("look", Access::kRead, [&](Database& database) {
    return database.finds("SELECT id FROM remeshd_job WHERE id = $1 AND token = $2 AND state = 'running'",
                          {std::string_view(claim.id), claim.token});
  });
}

bool SqlStore::commit(const Claim& claim, const JobOutcome& outcome) {
  std::vector<std::string> files;
  const auto write = [&](Database& database) {
    const std::string_view state = state_name(outcome.state);
    const bool is_success = outcome.state == JobState::kSucceeded;
    const std::uint64_t stored = is_success ? outcome.mesh.size() + outcome.report.size() : 0;
    Transaction transaction(database);
    const Rows ended = database.run(
        "UPDATE remeshd_job SET state = $1, commits = commits + 1, version = version + 1, lease_ms = NULL, "
        "stage = 'done', fraction = 1, finished_ms = remeshd_now(), expires_ms = remeshd_now() + $2, "
        "problem_status = $3, problem = $4, stored = $7 WHERE id = $5 AND token = $6 AND state = 'running' "
        "RETURNING id",
        {state, std::int64_t{rules_.result_ttl.count()}, std::int64_t{outcome.problem_status},
         std::string_view(outcome.problem), std::string_view(claim.id), claim.token, signed_bytes(stored)});
    if (ended.empty()) {
      // The job may have been ended by this claim's own commit, whose answer was lost.
      return database.finds("SELECT id FROM remeshd_job WHERE id = $1 AND token = $2 AND state = $3",
                            {std::string_view(claim.id), claim.token, state});
    }
    if (is_success) {
      driver_->check_room(database, stored, RoomFor::kResult);
      blobs_.write(database, claim.id, BlobKind::kMesh, outcome.mesh);
      blobs_.write(database, claim.id, BlobKind::kReport, outcome.report);
    }
    files = blobs_.remove(database, claim.id, "kind = 'input'");
    transaction.commit();
    return true;
  };
  // The outcome of a failed job is small, and storing it frees the room of the job's input.
  const Reserve reserve = outcome.state == JobState::kSucceeded ? Reserve::kStays : Reserve::kMayBeUsed;
  const bool is_done = with_database("commit", Access::kWrite, write, reserve);
  blobs_.remove_files(files);
  return is_done;
}

bool SqlStore::give_back(const Claim& claim, Attempt attempt, std::optional<std::uint64_t> memory) {
  return with_database("give_back", Access::kWrite, [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(
        "UPDATE remeshd_job SET state = 'queued', token = token + 1, attempts = CASE WHEN attempts > $1 THEN attempts "
        "- $1 ELSE 0 END, version = version + 1, "
        "lease_ms = NULL, started_ms = NULL, worker = '', stage = 'queued', fraction = 0, queued_ms = remeshd_now(), "
        "memory = $4 "
        "WHERE id = $2 AND token = $3 AND state = 'running' RETURNING id",
        {std::int64_t{attempt == Attempt::kDoesNotCount ? 1 : 0}, std::string_view(claim.id), claim.token,
         signed_bytes(memory.value_or(claim.memory))});
    if (rows.empty()) return false;
    database.announce();
    transaction.commit();
    return true;
  });
}

// ---- queries

std::optional<JobRecord> SqlStore::find(const std::string& id) {
  static const std::string sql = std::string(kRecord) + "WHERE id = $1";
  return with_database("find", Access::kRead, [&](Database& database) -> std::optional<JobRecord> {
    const Rows rows = database.run(sql.c_str(), {std::string_view(id)});
    return rows.empty() ? std::nullopt : std::optional(record_of(rows[0]));
  });
}

std::vector<JobRecord> SqlStore::list(const std::string& owner, int limit) {
  static const std::string sql = std::string(kRecord) + "WHERE owner = $1 ORDER BY created_ms DESC, id LIMIT $2";
  return with_database("list", Access::kRead, [&](Database& database) {
    std::vector<JobRecord> records;
    for (const Row& row : database.run(sql.c_str(), {std::string_view(owner), std::int64_t{limit}})) {
      if (row[0]) records.push_back(record_of(row));  // upkeep removes rows without an id
    }
    return records;
  });
}

bool SqlStore::cancel(const std::string& id) {
  static const std::string problem = problem_text(409, "cancelled", "the job was cancelled");
  static const std::string sql =
      std::string("UPDATE remeshd_job SET state = 'cancelled', ") + kNextToken + ", " + kNextVersion +
      ", lease_ms = NULL, finished_ms = remeshd_now(), expires_ms = remeshd_now() + $1, problem_status = 409, "
      "stored = 0, problem = replace($2, '{job}', id) WHERE id = $3 AND state IN ('queued', 'running') RETURNING id";
  std::vector<std::string> files;
  const auto end_it = [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(
        sql.c_str(), {std::int64_t{rules_.result_ttl.count()}, std::string_view(problem), std::string_view(id)});
    if (rows.empty()) return false;
    files = blobs_.remove(database, id, "kind = 'input'");
    transaction.commit();
    return true;
  };
  const bool was_cancelled = with_database("cancel", Access::kWrite, end_it, Reserve::kMayBeUsed);
  blobs_.remove_files(files);
  return was_cancelled;
}

bool SqlStore::discard(const std::string& id) {
  static const std::string end_result = std::string("UPDATE remeshd_job SET state = 'expired', ") + kNextVersion +
                                        ", expires_ms = remeshd_now() + $1 "
                                        "WHERE id = $2 AND state = 'succeeded' RETURNING id";
  std::vector<std::string> files;
  const auto remove_it = [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(end_result.c_str(), {std::int64_t{rules_.history.count()}, std::string_view(id)});
    // This also applies to other final states: the input of a job is still stored if every worker died of it.
    if (database.finds(
            "UPDATE remeshd_job SET stored = 0 WHERE id = $1 AND state NOT IN ('queued', 'running') RETURNING id",
            {std::string_view(id)})) {
      files = blobs_.remove(database, id, "1 = 1");
    }
    transaction.commit();
    return !rows.empty();
  };
  const bool was_result = with_database("discard", Access::kWrite, remove_it, Reserve::kMayBeUsed);
  blobs_.remove_files(files);
  return was_result;
}

QueueStatistics SqlStore::statistics() {
  return with_database("statistics", Access::kRead, [&](Database& database) {
    const Rows rows = database.run(
        "SELECT count(*), CAST(coalesce(remeshd_now() - min(CASE WHEN created_ms BETWEEN 0 AND 9000000000000000 THEN "
        "created_ms END), 0) AS bigint),"
        " (SELECT count(*) FROM remeshd_job WHERE state = 'running') FROM remeshd_job WHERE state = 'queued'");
    QueueStatistics statistics;
    statistics.queued = integer(rows.at(0)[0]);
    statistics.oldest_queued_s = std::max(0.0, static_cast<double>(integer(rows[0][1])) / 1000);
    statistics.running = integer(rows[0][2]);
    return statistics;
  });
}

std::uint64_t SqlStore::stored_bytes() {
  return with_database("stored", Access::kRead, [](Database& database) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, integer(database.run(kStoredBytes.c_str()).at(0)[0])));
  });
}

// ---- upkeep

Upkeep SqlStore::upkeep() {
  std::vector<std::string> files;
  const auto look_after = [&](Database& database) {
    driver_->tidy(database);  // first, because on a full volume it makes room for the following steps
    driver_->keep_clock(database);
    database.extend_deadline(rules_.timeout);
    files = uncertain_.undo(database, blobs_);
    JobUpkeep upkeep(database, *driver_, rules_, blobs_);
    upkeep.run(judge_);
    files.insert(files.end(), upkeep.files().begin(), upkeep.files().end());
    const std::vector<std::string> stray = blobs_.find_stray_files(database, swept_++);
    files.insert(files.end(), stray.begin(), stray.end());
    return upkeep.done();
  };
  const Upkeep done = with_database("upkeep", Access::kQueue, look_after, Reserve::kMayBeUsed);
  blobs_.remove_files(files);
  return done;
}

void SqlStore::probe() {
  with_database("probe", Access::kProbe, [](Database& database) {
    database.run("UPDATE remeshd_schema SET touched_ms = remeshd_now()");
    return true;
  });
}

void SqlStore::wait_for_work(const Event& wake, Clock::time_point until) {
  const Clock::time_point start = Clock::now();
  try {
    driver_->wait_for_work(wake, until, deadline());
  } catch (const StoreError& error) {
    note("wait", Access::kRead, start, &error);
    throw;
  }
}

}  // namespace remesh::server::jobs
