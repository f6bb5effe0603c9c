/// Jobs as the JSON that the API returns.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// The links of jobs for one client.
struct JobLinks {
  std::string prefix;  ///< the path that comes before all paths for this client (Request::prefix)
  /// Returns the token with which a browser may follow the events at a path. The function is null, or returns an empty
  /// token, if the browser needs none.
  std::function<std::string(const std::string& path)> token_for = nullptr;
};

/// Formats one job: `{"id": ..., "state": ..., "stage": ..., ...}`
std::string job_json(const JobRecord& job, const JobLinks& links);
/// Formats a list of jobs: `{"jobs": [...]}`
std::string jobs_json(const std::vector<JobRecord>& jobs, const JobLinks& links);

/// True if this is the JSON of a problem.
bool is_problem(std::string_view text);
/// Returns the `code` member of a problem, or an empty string if it has none.
std::string problem_code(std::string_view problem);

/// The path of a job: "/v1/jobs/0123..."
std::string job_path(const std::string& id);

}  // namespace remesh::server::jobs
