/// Jobs as the JSON that the API returns.
#pragma once

#include <string>
#include <vector>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// Formats one job: `{"id": ..., "state": ..., "stage": ..., ...}`
std::string job_json(const JobRecord& job);
/// Formats a list of jobs: `{"jobs": [...]}`
std::string jobs_json(const std::vector<JobRecord>& jobs);

/// Returns the `code` member of a problem, or an empty string if it has none.
std::string problem_code(const std::string& problem);

/// The path of a job: "/v1/jobs/0123..."
std::string job_path(const std::string& id);

}  // namespace remesh::server::jobs
