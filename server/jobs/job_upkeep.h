/// The changes of jobs that are due with time, as statements on a database.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/jobs/blob_table.h"
#include "server/jobs/database.h"
#include "server/jobs/job_store.h"
#include "server/jobs/lease_judge.h"

namespace remesh::server::jobs {

/// One round of upkeep. It changes a bounded number of jobs, each in a transaction of its own, so that a job whose row
/// or size prevents its change does not prevent the changes of other jobs.
class JobUpkeep {
 public:
  JobUpkeep(Database& database, const DatabaseDriver& driver, const StoreRules& rules, const BlobTable& blobs)
      : database_(database), driver_(driver), rules_(rules), blobs_(blobs) {}

  /// Makes the changes that are due.
  void run(LeaseJudge& judge);

  const Upkeep& done() const { return done_; }
  /// The files to remove.
  const std::vector<std::string>& files() const { return files_; }

 private:
  /// Fails jobs whose rows are damaged, so that no other statement reads these rows.
  void end_damaged();
  /// Queues the jobs of dead workers again, or fails them.
  void end_abandoned(LeaseJudge& judge);
  /// Fails jobs that have waited too long.
  void end_waiting();
  void expire_results();
  void forget_jobs();
  void forget_keys();
  void mend(const std::string& id);
  void requeue_or_fail(const LeaseJudge::Sign& sign);
  void end_waiting(const std::string& id);
  void expire(const std::string& id);
  void forget(const std::string& id);
  /// Makes one change. If the data prevents it, the reason is recorded.
  void attempt(const std::function<void()>& change);
  /// Changes the jobs whose ids a statement returns, as many as there is time for but at least one.
  void for_each(const std::string& sql, const Values& values, void (JobUpkeep::*change)(const std::string&));

  Database& database_;
  const DatabaseDriver& driver_;
  const StoreRules& rules_;
  const BlobTable& blobs_;
  Upkeep done_;
  std::vector<std::string> files_;
};

/// Makes a problem with `{job}` as its request_id. The statements that end many jobs at once replace `{job}` by the id
/// of each job.
std::string problem_text(int status, const char* code, const char* detail);

/// The jobs that are running, for the judge.
std::vector<LeaseJudge::Sign> running_jobs(Database& database, std::chrono::milliseconds usual_lease);

}  // namespace remesh::server::jobs
