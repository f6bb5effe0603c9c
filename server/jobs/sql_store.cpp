#include "server/jobs/sql_store.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "api/service.h"
#include "server/jobs/schema.h"

namespace remesh::server::jobs {
namespace {

/// The largest number of rows that one statement of upkeep changes. It is small so that no statement blocks others
/// for long.
constexpr std::int64_t kBatch = 100;
/// Files older than this belong to no running transaction. No transaction takes nearly as long, even if the clocks of
/// file servers differ.
constexpr std::chrono::hours kStrayAge{24};
/// How long an operation waits for a free connection.
constexpr std::chrono::seconds kPatience{15};

const char* kind_name(BlobKind kind) {
  switch (kind) {
    case BlobKind::kInput: return "input";
    case BlobKind::kMesh: return "mesh";
    case BlobKind::kReport: return "report";
  }
  return "";
}

std::int64_t integer(const std::optional<std::string>& value) { return std::stoll(value.value()); }
std::optional<std::int64_t> maybe_integer(const std::optional<std::string>& value) {
  return value ? std::optional<std::int64_t>(std::stoll(*value)) : std::nullopt;
}
std::int64_t signed_bytes(std::uint64_t bytes) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(bytes, std::numeric_limits<std::int64_t>::max()));
}

/// Makes a problem with `{job}` as its request_id. The statements that end jobs, many at once, replace `{job}` by the
/// id of each job.
std::string problem_text(int status, const char* code, const char* detail) {
  api::Problem problem;
  problem.status = status;
  problem.code = code;
  problem.detail = detail;
  return api::to_response(problem, "{job}").body;
}

constexpr const char* kRecord =
    "SELECT id, owner, state, stage, fraction, attempts, version, created_ms, started_ms, finished_ms, expires_ms, "
    "problem_status, problem FROM remeshd_job ";

JobRecord record_of(const Row& row) {
  JobRecord record;
  record.id = row[0].value();
  record.owner = row[1].value();
  record.state = state_from_name(row[2].value()).value();
  record.stage = row[3].value();
  record.fraction = std::stod(row[4].value());
  record.attempts = static_cast<int>(integer(row[5]));
  record.version = integer(row[6]);
  record.created_ms = integer(row[7]);
  record.started_ms = maybe_integer(row[8]);
  record.finished_ms = maybe_integer(row[9]);
  record.expires_ms = maybe_integer(row[10]);
  record.problem_status = static_cast<int>(integer(row[11]));
  record.problem = row[12].value();
  return record;
}

}  // namespace

SqlStore::SqlStore(std::unique_ptr<DatabaseDriver> driver, const StoreRules& rules, std::unique_ptr<BlobFolder> folder,
                   StoreObserver observer)
    : driver_(std::move(driver)), rules_(rules), folder_(std::move(folder)), observer_(std::move(observer)) {}

// ---- connections

std::unique_ptr<Database> SqlStore::take_connection() {
  std::unique_lock lock(mutex_);
  const auto is_free = [this] { return !idle_.empty() || open_ < driver_->max_connections(); };
  if (!returned_.wait_for(lock, kPatience, is_free)) throw StoreError("all connections to the store are in use");
  if (!idle_.empty()) {
    std::unique_ptr<Database> database = std::move(idle_.back());
    idle_.pop_back();
    return database;
  }
  ++open_;
  const bool has_schema = has_schema_;
  lock.unlock();
  try {
    std::unique_ptr<Database> database = driver_->connect();
    if (!has_schema) make_schema(*database);
    return database;
  } catch (...) {
    return_connection(nullptr);
    throw;
  }
}

void SqlStore::make_schema(Database& database) {
  bring_schema_up_to_date(database, *driver_);
  driver_->prepare(database);
  const std::lock_guard lock(mutex_);
  has_schema_ = true;
}

/// Input: a null pointer for a connection that is no longer usable.
void SqlStore::return_connection(std::unique_ptr<Database> database) {
  {
    const std::lock_guard lock(mutex_);
    if (database) {
      idle_.push_back(std::move(database));
    } else {
      --open_;
    }
  }
  returned_.notify_one();
}

template <typename Operation>
auto SqlStore::attempt(Operation& operation) {
  for (bool may_repeat = true;; may_repeat = false) {
    std::unique_ptr<Database> database = take_connection();
    try {
      auto result = operation(*database);
      return_connection(std::move(database));
      return result;
    } catch (const ConnectionBroken&) {
      database.reset();
      return_connection(nullptr);
      if (!may_repeat) throw;
      // The server was most likely restarted, so the idle connections are dead too.
      std::vector<std::unique_ptr<Database>> dead;
      const std::lock_guard lock(mutex_);
      open_ -= idle_.size();
      dead.swap(idle_);
    } catch (...) {
      database.reset();
      return_connection(nullptr);
      throw;
    }
  }
}

template <typename Operation>
auto SqlStore::with_database(std::string_view op, Access access, Operation operation) {
  const Clock::time_point start = Clock::now();
  try {
    auto result = attempt(operation);
    note(op, access, start, /*failed=*/false);
    return result;
  } catch (const StoreError&) {
    note(op, access, start, /*failed=*/true);
    throw;
  }
}

void SqlStore::note(std::string_view op, Access access, Clock::time_point start, bool failed) {
  if (failed) is_well_ = false;
  if (!failed && access == Access::kWrite) is_well_ = true;
  if (observer_) observer_(op, std::chrono::duration<double>(Clock::now() - start).count(), failed);
}

// ---- blobs

void SqlStore::write_blob(Database& database, const std::string& id, BlobKind kind, std::string_view bytes) {
  const std::string_view name = kind_name(kind);
  if (folder_) {
    const std::string file = folder_->write(id, name, bytes);
    database.run("INSERT INTO remeshd_blob (job, kind, part, file) VALUES ($1, $2, 0, $3)",
                 {std::string_view(id), name, std::string_view(file)});
    return;
  }
  std::int64_t part = 0;
  do {
    const std::string_view piece = bytes.substr(0, DatabaseDriver::kPiece);
    driver_->insert_piece(database, id, name, part, piece);
    part += DatabaseDriver::kPartsOfPiece;
    bytes.remove_prefix(piece.size());
  } while (!bytes.empty());
}

std::optional<SqlStore::Blob> SqlStore::find_blob(const std::string& id, BlobKind kind) {
  return with_database("read", Access::kRead, [&](Database& database) -> std::optional<Blob> {
    const std::string_view name = kind_name(kind);
    const Rows blob = database.run("SELECT max(part), max(file) FROM remeshd_blob WHERE job = $1 AND kind = $2",
                                   {std::string_view(id), name});
    if (!blob.at(0)[0]) return std::nullopt;
    if (blob[0][1]) return Blob{"", blob[0][1]};
    std::string bytes;
    for (std::int64_t part = 0; part <= integer(blob[0][0]); part += DatabaseDriver::kPartsOfPiece) {
      const Rows piece = database.run(
          "SELECT data FROM remeshd_blob WHERE job = $1 AND kind = $2 AND part >= $3 AND part < $4 ORDER BY part",
          {std::string_view(id), name, part, part + DatabaseDriver::kPartsOfPiece}, Database::Result::kBytes);
      if (piece.empty()) return std::nullopt;  // it expired meanwhile
      for (const Row& row : piece) bytes += row[0].value();
    }
    return Blob{std::move(bytes), std::nullopt};
  });
}

/// This runs outside `with_database`: an error of a file says nothing about the health of the store.
template <typename Question>
auto SqlStore::ask_folder(const std::string& id, BlobKind kind, Question question) {
  using Answer = std::optional<decltype(question(*folder_))>;
  if (!folder_) throw StoreError("the store keeps blobs in a folder: --blob-dir is missing");
  try {
    return Answer(question(*folder_));
  } catch (const BlobLost&) {
    if (find_blob(id, kind)) throw;
    return Answer();  // it expired meanwhile
  }
}

std::optional<std::string> SqlStore::read_blob(const std::string& id, BlobKind kind) {
  std::optional<Blob> blob = find_blob(id, kind);
  if (!blob) return std::nullopt;
  if (!blob->file) return std::move(blob->bytes);
  return ask_folder(id, kind, [&](const BlobFolder& folder) { return folder.read(*blob->file); });
}

std::optional<std::uint64_t> SqlStore::blob_size(const std::string& id, BlobKind kind) {
  const Row blob = with_database("size", Access::kRead, [&](Database& database) {
    return database
        .run(
            "SELECT max(part), max(file), coalesce(sum(length(data)), 0) FROM remeshd_blob WHERE job = $1 AND kind = "
            "$2",
            {std::string_view(id), std::string_view(kind_name(kind))})
        .at(0);
  });
  if (!blob[0]) return std::nullopt;
  if (!blob[1]) return static_cast<std::uint64_t>(integer(blob[2]));
  return ask_folder(id, kind, [&](const BlobFolder& folder) { return folder.size(*blob[1]); });
}

std::vector<std::string> SqlStore::delete_blobs(Database& database, const std::string& id, const char* which) {
  const std::string sql = "DELETE FROM remeshd_blob WHERE job = $1 AND " + std::string(which) + " RETURNING file";
  std::vector<std::string> files;
  for (const Row& row : database.run(sql.c_str(), {std::string_view(id)})) {
    if (row[0]) files.push_back(*row[0]);
  }
  return files;
}

void SqlStore::remove_files(const std::vector<std::string>& files) {
  if (!folder_) return;
  for (const std::string& file : files) folder_->remove(file);
}

// ---- submission

std::optional<Submission> SqlStore::find_repeated(Database& database, const NewJob& job) {
  if (!job.idempotency) return std::nullopt;
  const auto& [key, digest] = *job.idempotency;
  // The first of several equal submissions inserts the row; the others wait for that transaction and then find the
  // row. An expired row counts as absent.
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
/// job, but not before the job that is running now. An owner who was absent therefore gets no credit for that time.
/// Source: start-time fair queueing (Goyal, Vin, Cheng, Start-time Fair Queueing, 1996), with all jobs of one size.
std::int64_t SqlStore::next_turn(Database& database, const std::string& owner) {
  const Rows now = database.run(
      "SELECT coalesce((SELECT max(turn) FROM remeshd_job WHERE state = 'running'),"
      " (SELECT min(turn) FROM remeshd_job WHERE state = 'queued'), (SELECT max(last_turn) FROM remeshd_owner), 0)");
  const Rows turn = database.run(
      "INSERT INTO remeshd_owner (owner, last_turn) VALUES ($1, $2) ON CONFLICT (owner) DO UPDATE "
      "SET last_turn = CASE WHEN remeshd_owner.last_turn + 1 > excluded.last_turn THEN remeshd_owner.last_turn + 1 "
      "ELSE excluded.last_turn END RETURNING last_turn",
      {std::string_view(owner), integer(now.at(0)[0])});
  return integer(turn.at(0)[0]);
}

Submission SqlStore::submit(const NewJob& job) {
  return with_database("submit", Access::kWrite, [&](Database& database) {
    Transaction transaction(database);
    if (const std::optional<Submission> repeated = find_repeated(database, job)) return *repeated;
    write_blob(database, job.id, BlobKind::kInput, job.body);
    const std::int64_t turn = next_turn(database, job.owner);
    database.run(
        "INSERT INTO remeshd_job (id, owner, state, turn, memory, request, created_ms) "
        "VALUES ($1, $2, 'queued', $3, $4, $5, remeshd_now())",
        {std::string_view(job.id), std::string_view(job.owner), turn, signed_bytes(job.memory),
         std::string_view(job.request)});
    database.announce();
    transaction.commit();
    return Submission{Submission::Kind::kNew, job.id};
  });
}

// ---- claims

std::optional<Claim> SqlStore::claim(std::string_view worker, std::uint64_t max_memory) {
  const std::string sql =
      "UPDATE remeshd_job SET state = 'running', token = token + 1, attempts = attempts + 1, version = version + 1, "
      "worker = $1, stage = 'read', fraction = 0, started_ms = remeshd_now(), lease_ms = remeshd_now() + $2 "
      "WHERE id = (SELECT id FROM remeshd_job WHERE state = 'queued' AND memory <= $3 "
      "ORDER BY turn, created_ms, id LIMIT 1" +
      std::string(driver_->skip_locked()) + ") RETURNING id, token, attempts, memory, request";
  return with_database("claim", Access::kRead, [&](Database& database) -> std::optional<Claim> {
    const Rows rows = database.run(sql.c_str(), {worker, std::int64_t{rules_.lease.count()}, signed_bytes(max_memory)});
    if (rows.empty()) return std::nullopt;
    const Row& row = rows[0];
    return Claim{row[0].value(), integer(row[1]), static_cast<int>(integer(row[2])),
                 static_cast<std::uint64_t>(integer(row[3])), row[4].value()};
  });
}

bool SqlStore::renew(const Claim& claim, const Progress& progress) {
  return with_database("renew", Access::kWrite, [&](Database& database) {
    return !database
                .run(
                    "UPDATE remeshd_job SET stage = $1, fraction = $2, lease_ms = remeshd_now() + $3, "
                    "version = version + 1 WHERE id = $4 AND token = $5 AND state = 'running' RETURNING id",
                    {std::string_view(progress.stage), progress.fraction, std::int64_t{rules_.lease.count()},
                     std::string_view(claim.id), claim.token})
                .empty();
  });
}

bool SqlStore::holds(const Claim& claim) {
  return with_database("look", Access::kRead, [&](Database& database) {
    return !database
                .run("SELECT id FROM remeshd_job WHERE id = $1 AND token = $2 AND state = 'running'",
                     {std::string_view(claim.id), claim.token})
                .empty();
  });
}

bool SqlStore::commit(const Claim& claim, const JobOutcome& outcome) {
  std::vector<std::string> files;
  const bool is_done = with_database("commit", Access::kWrite, [&](Database& database) {
    const std::string_view state = state_name(outcome.state);
    Transaction transaction(database);
    const Rows ended = database.run(
        "UPDATE remeshd_job SET state = $1, commits = commits + 1, version = version + 1, lease_ms = NULL, "
        "stage = 'done', fraction = 1, finished_ms = remeshd_now(), expires_ms = remeshd_now() + $2, "
        "problem_status = $3, problem = $4 WHERE id = $5 AND token = $6 AND state = 'running' RETURNING id",
        {state, std::int64_t{rules_.result_ttl.count()}, std::int64_t{outcome.problem_status},
         std::string_view(outcome.problem), std::string_view(claim.id), claim.token});
    if (ended.empty()) {
      // It may have been this claim's own commit whose answer was lost on the way.
      return !database
                  .run("SELECT id FROM remeshd_job WHERE id = $1 AND token = $2 AND state = $3",
                       {std::string_view(claim.id), claim.token, state})
                  .empty();
    }
    if (outcome.state == JobState::kSucceeded) {
      write_blob(database, claim.id, BlobKind::kMesh, outcome.mesh);
      write_blob(database, claim.id, BlobKind::kReport, outcome.report);
    }
    files = delete_blobs(database, claim.id, "kind = 'input'");
    transaction.commit();
    return true;
  });
  remove_files(files);
  return is_done;
}

bool SqlStore::give_back(const Claim& claim, Attempt attempt) {
  return with_database("give_back", Access::kWrite, [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(
        "UPDATE remeshd_job SET state = 'queued', token = token + 1, attempts = attempts - $1, version = version + 1, "
        "lease_ms = NULL, started_ms = NULL, worker = '', stage = 'queued', fraction = 0 "
        "WHERE id = $2 AND token = $3 AND state = 'running' RETURNING id",
        {std::int64_t{attempt == Attempt::kDoesNotCount ? 1 : 0}, std::string_view(claim.id), claim.token});
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
    for (const Row& row : database.run(sql.c_str(), {std::string_view(owner), std::int64_t{limit}}))
      records.push_back(record_of(row));
    return records;
  });
}

bool SqlStore::cancel(const std::string& id) {
  static const std::string problem = problem_text(409, "cancelled", "the job was cancelled");
  std::vector<std::string> files;
  const bool was_cancelled = with_database("cancel", Access::kWrite, [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(
        "UPDATE remeshd_job SET state = 'cancelled', token = token + 1, version = version + 1, lease_ms = NULL, "
        "finished_ms = remeshd_now(), expires_ms = remeshd_now() + $1, problem_status = 409, "
        "problem = replace($2, '{job}', id) WHERE id = $3 AND state IN ('queued', 'running') RETURNING id",
        {std::int64_t{rules_.result_ttl.count()}, std::string_view(problem), std::string_view(id)});
    if (rows.empty()) return false;
    files = delete_blobs(database, id, "kind = 'input'");
    transaction.commit();
    return true;
  });
  remove_files(files);
  return was_cancelled;
}

bool SqlStore::discard(const std::string& id) {
  std::vector<std::string> files;
  const bool was_result = with_database("discard", Access::kWrite, [&](Database& database) {
    Transaction transaction(database);
    const Rows rows = database.run(
        "UPDATE remeshd_job SET state = 'expired', version = version + 1, expires_ms = remeshd_now() + $1 "
        "WHERE id = $2 AND state = 'succeeded' RETURNING id",
        {std::int64_t{rules_.history.count()}, std::string_view(id)});
    // This also concerns jobs in other final states: the input of a job is still stored if every worker died of it.
    files = delete_blobs(database, id,
                         "EXISTS (SELECT 1 FROM remeshd_job WHERE id = $1 AND state NOT IN ('queued', 'running'))");
    transaction.commit();
    return !rows.empty();
  });
  remove_files(files);
  return was_result;
}

QueueStatistics SqlStore::statistics() {
  return with_database("statistics", Access::kRead, [&](Database& database) {
    const Rows rows = database.run(
        "SELECT count(*), coalesce(remeshd_now() - min(created_ms), 0),"
        " (SELECT count(*) FROM remeshd_job WHERE state = 'running') FROM remeshd_job WHERE state = 'queued'");
    QueueStatistics statistics;
    statistics.queued = integer(rows.at(0)[0]);
    statistics.oldest_queued_s = std::max(0.0, static_cast<double>(integer(rows[0][1])) / 1000);
    statistics.running = integer(rows[0][2]);
    return statistics;
  });
}

// ---- upkeep

Upkeep SqlStore::upkeep() {
  std::vector<std::string> files;
  const Upkeep done = with_database("upkeep", Access::kRead, [&](Database& database) {
    Upkeep changed;
    end_abandoned(database, changed);
    end_waiting(database, changed);
    expire_results(database, changed, files);
    forget_jobs(database, changed, files);
    find_stray_files(database, files);
    driver_->tidy(database);
    return changed;
  });
  remove_files(files);
  return done;
}

void SqlStore::end_abandoned(Database& database, Upkeep& done) {
  static const std::string problem =
      problem_text(500, "worker_crashed", "every worker that tried this job crashed or was stopped");
  const std::string sql =
      "UPDATE remeshd_job SET state = CASE WHEN attempts >= $1 THEN 'failed' ELSE 'queued' END, "
      "commits = commits + CASE WHEN attempts >= $1 THEN 1 ELSE 0 END, "
      "finished_ms = CASE WHEN attempts >= $1 THEN remeshd_now() END, "
      "expires_ms = CASE WHEN attempts >= $1 THEN remeshd_now() + $2 END, "
      "problem_status = CASE WHEN attempts >= $1 THEN 500 ELSE 0 END, "
      "problem = CASE WHEN attempts >= $1 THEN replace($3, '{job}', id) ELSE '' END, "
      "token = token + 1, version = version + 1, lease_ms = NULL, started_ms = NULL, stage = 'queued', fraction = 0 "
      "WHERE id IN (SELECT id FROM remeshd_job WHERE state = 'running' AND lease_ms < remeshd_now() LIMIT $4" +
      std::string(driver_->skip_locked()) + ") RETURNING state";
  Transaction transaction(database);
  const Rows rows = database.run(
      sql.c_str(),
      {std::int64_t{rules_.max_attempts}, std::int64_t{rules_.result_ttl.count()}, std::string_view(problem), kBatch});
  for (const Row& row : rows) ++(row[0] == "failed" ? done.crashed : done.retried);
  if (done.retried > 0) database.announce();
  transaction.commit();
}

void SqlStore::end_waiting(Database& database, Upkeep& done) {
  static const std::string problem = problem_text(504, "timeout", "no worker became free for this job in time");
  const std::string sql =
      "UPDATE remeshd_job SET state = 'failed', commits = commits + 1, token = token + 1, version = version + 1, "
      "finished_ms = remeshd_now(), expires_ms = remeshd_now() + $1, problem_status = 504, "
      "problem = replace($2, '{job}', id) WHERE id IN (SELECT id FROM remeshd_job WHERE state = 'queued' AND "
      "created_ms < remeshd_now() - $3 LIMIT $4" +
      std::string(driver_->skip_locked()) + ") RETURNING id";
  done.timed_out +=
      static_cast<int>(database
                           .run(sql.c_str(), {std::int64_t{rules_.result_ttl.count()}, std::string_view(problem),
                                              std::int64_t{rules_.queue_timeout.count()}, kBatch})
                           .size());
}

void SqlStore::expire_results(Database& database, Upkeep& done, std::vector<std::string>& files) {
  const std::string sql =
      "UPDATE remeshd_job SET state = 'expired', version = version + 1, expires_ms = remeshd_now() + $1 WHERE id IN "
      "(SELECT id FROM remeshd_job WHERE state = 'succeeded' AND expires_ms < remeshd_now() LIMIT $2" +
      std::string(driver_->skip_locked()) + ") RETURNING id";
  Transaction transaction(database);
  const Rows rows = database.run(sql.c_str(), {std::int64_t{rules_.history.count()}, kBatch});
  for (const Row& row : rows) {
    const std::vector<std::string> more = delete_blobs(database, row[0].value(), "1 = 1");
    files.insert(files.end(), more.begin(), more.end());
  }
  transaction.commit();
  done.expired += static_cast<int>(rows.size());
}

void SqlStore::forget_jobs(Database& database, Upkeep& done, std::vector<std::string>& files) {
  const std::string sql =
      "DELETE FROM remeshd_job WHERE id IN (SELECT id FROM remeshd_job WHERE "
      "state IN ('failed', 'cancelled', 'expired') AND expires_ms < remeshd_now() LIMIT $1" +
      std::string(driver_->skip_locked()) + ") RETURNING id";
  Transaction transaction(database);
  const Rows rows = database.run(sql.c_str(), {kBatch});
  for (const Row& row : rows) {
    const std::string_view id = row[0].value();
    const std::vector<std::string> more = delete_blobs(database, row[0].value(), "1 = 1");
    files.insert(files.end(), more.begin(), more.end());
    database.run("DELETE FROM remeshd_idempotency WHERE job = $1", {id});
  }
  database.run("DELETE FROM remeshd_idempotency WHERE expires_ms < remeshd_now()");
  transaction.commit();
  done.forgotten += static_cast<int>(rows.size());
}

/// Finds files whose transaction was never committed. One part of the folder is searched at each call; all parts are
/// searched within the hour.
void SqlStore::find_stray_files(Database& database, std::vector<std::string>& files) {
  if (!folder_) return;
  for (const BlobFolder::Found& file : folder_->files_older_than(kStrayAge, swept_++ % BlobFolder::kParts)) {
    const Rows rows = database.run("SELECT part FROM remeshd_blob WHERE job = $1 AND file = $2",
                                   {std::string_view(file.job), std::string_view(file.name)});
    if (rows.empty()) files.push_back(file.name);
  }
}

void SqlStore::probe() {
  with_database("probe", Access::kWrite, [](Database& database) {
    database.run("UPDATE remeshd_schema SET touched_ms = remeshd_now()");
    return true;
  });
}

void SqlStore::wait_for_work(const Event& wake, Clock::time_point until) { driver_->wait_for_work(wake, until); }

}  // namespace remesh::server::jobs
