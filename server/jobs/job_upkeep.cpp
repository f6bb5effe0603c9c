#include "server/jobs/job_upkeep.h"

#include <array>
#include <optional>

#include "api/operations.h"
#include "server/jobs/row_values.h"
#include "server/jobs/schema.h"

namespace remesh::server::jobs {
namespace {

/// The max number of jobs that one round changes in each way.
constexpr std::int64_t kBatch = 100;
/// The max number of keys that one statement removes.
constexpr std::int64_t kKeys = 1000;

}  // namespace

std::string problem_text(int status, const char* code, const char* detail) {
  api::Problem problem;
  problem.status = status;
  problem.code = code;
  problem.detail = detail;
  return api::to_response(problem, "{job}").body;
}

std::vector<LeaseJudge::Sign> running_jobs(Database& database, std::chrono::milliseconds usual_lease) {
  std::vector<LeaseJudge::Sign> signs;
  for (const Row& row :
       database.run("SELECT id, token, version, lease_length_ms FROM remeshd_job WHERE state = 'running'")) {
    // A lease that no daemon can have given would keep the job of a dead worker for ever.
    std::int64_t lease = maybe_integer(row[3]).value_or(0);
    if (lease <= 0 || lease > std::chrono::milliseconds(std::chrono::hours(24)).count()) lease = usual_lease.count();
    const std::optional<std::int64_t> token = maybe_integer(row[1]), version = maybe_integer(row[2]);
    if (!row[0] || !token || !version) continue;  // a damaged row, see end_damaged
    signs.push_back({*row[0], *token, *version, std::chrono::milliseconds(lease)});
  }
  return signs;
}

void JobUpkeep::run(LeaseJudge& judge) {
  const Clock::time_point asked = Clock::now();
  const auto end_damaged_first = [&] {
    end_damaged();
    judge.record_reached(asked, Clock::now());  // this time counts for the leases that are judged next
  };
  const std::array<std::function<void()>, 6> steps{end_damaged_first,         [&] { end_abandoned(judge); },
                                                   [this] { end_waiting(); }, [this] { expire_results(); },
                                                   [this] { forget_jobs(); }, [this] { forget_keys(); }};
  for (const std::function<void()>& step : steps) attempt(step);
}

void JobUpkeep::attempt(const std::function<void()>& change) {
  try {
    change();
  } catch (const DataError& error) {
    done_.error = error.what();
  }
  database_.extend_deadline(rules_.timeout);  // only time in which the store does not answer counts
}

void JobUpkeep::for_each(const std::string& sql, const Values& values, void (JobUpkeep::*change)(const std::string&)) {
  // If time runs out, the rest is left to the next round, so that the clock and the leases are kept up to date
  // meanwhile.
  const Clock::time_point until = Clock::now() + rules_.timeout;
  for (const Row& row : database_.run(sql.c_str(), values)) {
    if (!row[0]) continue;  // see end_damaged
    attempt([&] { (this->*change)(*row[0]); });
    if (Clock::now() >= until) return;
  }
}

void JobUpkeep::end_damaged() {
  // SQLite allows rows without an id. No client can ask for such a job.
  attempt([this] {
    const Rows rows = database_.run("DELETE FROM remeshd_job WHERE id IS NULL RETURNING state");
    done_.damaged += static_cast<int>(rows.size());
  });
  for_each(std::string("SELECT id FROM remeshd_job WHERE ") + damaged_job(), {}, &JobUpkeep::mend);
}

void JobUpkeep::mend(const std::string& id) {
  static const std::string problem =
      problem_text(500, "internal", "the job's row in the store was damaged, so the job cannot run");
  // A job that has ended keeps its state and its problem. Its damaged numbers are mended, so that it can expire.
  static const std::string ends = "state NOT IN ('succeeded', 'failed', 'cancelled', 'expired')";
  static const std::string sql =
      "UPDATE remeshd_job SET memory = 0, token = 0, attempts = 1, turn = 0, version = 1, lease_ms = NULL, "
      "commits = 1, fraction = 1, stage = 'done', "
      "finished_ms = CASE WHEN " +
      ends +
      " THEN remeshd_now() ELSE finished_ms END, "
      "expires_ms = CASE WHEN " +
      ends +
      " THEN remeshd_now() + $1 ELSE expires_ms END, "
      "problem_status = CASE WHEN " +
      ends +
      " THEN 500 ELSE problem_status END, "
      "problem = CASE WHEN " +
      ends +
      " THEN replace($2, '{job}', id) ELSE problem END, "
      "state = CASE WHEN " +
      ends + " THEN 'failed' ELSE state END WHERE id = $3 AND " + damaged_job() + " RETURNING state";
  for (const Row& row : database_.run(
           sql.c_str(), {std::int64_t{rules_.result_ttl.count()}, std::string_view(problem), std::string_view(id)})) {
    if (row[0] == "failed") ++done_.damaged;
  }
}

void JobUpkeep::end_abandoned(LeaseJudge& judge) {
  std::int64_t changed = 0;
  for (const LeaseJudge::Sign& sign : judge.judge(running_jobs(database_, rules_.lease))) {
    if (++changed > kBatch) return;
    attempt([&] { requeue_or_fail(sign); });
  }
}

void JobUpkeep::requeue_or_fail(const LeaseJudge::Sign& sign) {
  static const std::string problem =
      problem_text(500, "worker_crashed", "every worker that tried this job crashed or was stopped");
  const std::string sql =
      std::string("UPDATE remeshd_job SET ") + kNextToken + ", " + kNextVersion +
      ", state = CASE WHEN attempts >= $1 THEN 'failed' ELSE 'queued' END, "
      "commits = commits + CASE WHEN attempts >= $1 THEN 1 ELSE 0 END, "
      "finished_ms = CASE WHEN attempts >= $1 THEN remeshd_now() END, "
      "expires_ms = CASE WHEN attempts >= $1 THEN remeshd_now() + $2 END, "
      "problem_status = CASE WHEN attempts >= $1 THEN 500 ELSE 0 END, "
      "problem = CASE WHEN attempts >= $1 THEN replace($3, '{job}', id) ELSE '' END, queued_ms = remeshd_now(), "
      "lease_ms = NULL, started_ms = NULL, stage = 'queued', fraction = 0 "
      "WHERE id IN (SELECT id FROM remeshd_job WHERE id = $4 AND token = $5 AND version = $6 AND state = 'running'" +
      std::string(driver_.skip_locked()) + ") RETURNING state";
  Transaction transaction(database_);
  const Rows rows =
      database_.run(sql.c_str(), {std::int64_t{rules_.max_attempts}, std::int64_t{rules_.result_ttl.count()},
                                  std::string_view(problem), std::string_view(sign.id), sign.token, sign.version});
  for (const Row& row : rows) ++(row[0] == "failed" ? done_.crashed : done_.retried);
  if (done_.retried > 0) database_.announce();
  transaction.commit();
}

void JobUpkeep::end_waiting() {
  for_each(
      "SELECT id FROM remeshd_job WHERE state = 'queued' AND coalesce(queued_ms, created_ms) < remeshd_now() - $1 "
      "LIMIT $2",
      {std::int64_t{rules_.queue_timeout.count()}, kBatch}, &JobUpkeep::end_waiting);
}

void JobUpkeep::end_waiting(const std::string& id) {
  static const std::string problem = problem_text(504, "timeout", "no worker became free for this job in time");
  const std::string sql =
      std::string("UPDATE remeshd_job SET state = 'failed', ") + kNextCommits + ", " + kNextToken + ", " +
      kNextVersion +
      ", finished_ms = remeshd_now(), expires_ms = remeshd_now() + $1, problem_status = 504, "
      "problem = replace($2, '{job}', id) WHERE id IN (SELECT id FROM remeshd_job WHERE id = $4 AND state = 'queued' "
      "AND coalesce(queued_ms, created_ms) < remeshd_now() - $3" +
      std::string(driver_.skip_locked()) + ") RETURNING id";
  const Rows rows = database_.run(sql.c_str(), {std::int64_t{rules_.result_ttl.count()}, std::string_view(problem),
                                                std::int64_t{rules_.queue_timeout.count()}, std::string_view(id)});
  done_.timed_out += static_cast<int>(rows.size());
}

void JobUpkeep::expire_results() {
  for_each("SELECT id FROM remeshd_job WHERE state = 'succeeded' AND expires_ms < remeshd_now() LIMIT $1", {kBatch},
           &JobUpkeep::expire);
}

void JobUpkeep::expire(const std::string& id) {
  const std::string sql =
      std::string("UPDATE remeshd_job SET state = 'expired', ") + kNextVersion +
      ", stored = 0, expires_ms = remeshd_now() + $1 "
      "WHERE id IN (SELECT id FROM remeshd_job WHERE id = $2 AND state = 'succeeded' AND expires_ms < remeshd_now()" +
      std::string(driver_.skip_locked()) + ") RETURNING id";
  Transaction transaction(database_);
  if (database_.run(sql.c_str(), {std::int64_t{rules_.history.count()}, std::string_view(id)}).empty()) return;
  const std::vector<std::string> files = blobs_.remove(database_, id, "1 = 1");
  transaction.commit();
  files_.insert(files_.end(), files.begin(), files.end());
  ++done_.expired;
}

void JobUpkeep::forget_jobs() {
  for_each(
      "SELECT id FROM remeshd_job WHERE state IN ('failed', 'cancelled', 'expired') AND expires_ms < remeshd_now() "
      "LIMIT $1",
      {kBatch}, &JobUpkeep::forget);
}

void JobUpkeep::forget(const std::string& id) {
  const std::string sql =
      "DELETE FROM remeshd_job WHERE id IN (SELECT id FROM remeshd_job WHERE id = $1 AND "
      "state IN ('failed', 'cancelled', 'expired') AND expires_ms < remeshd_now()" +
      std::string(driver_.skip_locked()) + ") RETURNING id";
  Transaction transaction(database_);
  if (database_.run(sql.c_str(), {std::string_view(id)}).empty()) return;
  const std::vector<std::string> files = blobs_.remove(database_, id, "1 = 1");
  database_.run("DELETE FROM remeshd_idempotency WHERE job = $1", {std::string_view(id)});
  transaction.commit();
  files_.insert(files_.end(), files.begin(), files.end());
  ++done_.forgotten;
}

void JobUpkeep::forget_keys() {
  database_.run(
      "DELETE FROM remeshd_idempotency WHERE (owner, key) IN "
      "(SELECT owner, key FROM remeshd_idempotency WHERE expires_ms < remeshd_now() LIMIT $1)",
      {kKeys});
}

}  // namespace remesh::server::jobs
