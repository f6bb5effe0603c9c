/// The changes of jobs that are due with time, as statements on a database.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/jobs/database.h"
#include "server/jobs/job_store.h"
#include "server/jobs/lease_judge.h"

namespace remesh::server::jobs {

/// One round of upkeep. It changes a bounded number of jobs.
class JobUpkeep {
 public:
  JobUpkeep(Database& database, const DatabaseDriver& driver, const StoreRules& rules)
      : database_(database), driver_(driver), rules_(rules) {}

  /// Makes all changes that are due. What the data keeps from being done does not keep the rest from being done.
  void run(LeaseJudge& judge);

  const Upkeep& done() const { return done_; }
  /// The files to remove.
  const std::vector<std::string>& files() const { return files_; }

 private:
  /// Fails jobs whose rows are damaged, so that no other statement meets them.
  void end_damaged();
  /// Queues the jobs of dead workers again, or fails them.
  void end_abandoned(LeaseJudge& judge);
  /// Fails jobs that have waited too long.
  void end_waiting();
  void expire_results();
  void forget_jobs();
  void requeue_or_fail(const LeaseJudge::Sign& sign);
  void remove_blobs(const std::string& id);

  Database& database_;
  const DatabaseDriver& driver_;
  const StoreRules& rules_;
  Upkeep done_;
  std::vector<std::string> files_;
};

/// Makes a problem with `{job}` as its request_id. The statements that end jobs, many at once, replace `{job}` by the
/// id of each job.
std::string problem_text(int status, const char* code, const char* detail);

/// The jobs that are running, for the judge.
std::vector<LeaseJudge::Sign> running_jobs(Database& database, std::chrono::milliseconds usual_lease);

}  // namespace remesh::server::jobs
