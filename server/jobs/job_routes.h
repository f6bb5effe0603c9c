/// The HTTP endpoints for jobs, under /v1/jobs.
#pragma once

#include <string>
#include <vector>

#include "server/http/api_keys.h"
#include "server/http/route.h"
#include "server/jobs/job_json.h"
#include "server/jobs/job_service.h"
#include "server/jobs/kept_answers.h"
#include "server/work/work.h"

namespace remesh::server::jobs {

/// The objects that the routes use. All of them must outlive the routes.
struct JobContext {
  JobService* jobs = nullptr;  ///< null without a job store: every route then answers 501
  const ApiKeys& keys;
  const Workplace work;
  MemoryBudget& memory;
  const std::atomic<bool>& draining;
  KeptAnswers& kept;  ///< results that were asked for in parts
};

/// The error to throw while the store cannot be used.
HttpError store_unavailable();

class JobRoutes {
 public:
  explicit JobRoutes(const JobContext& context) : context_(context) {}

  std::vector<Route> routes();

  /// True if a client asks for a request to be answered later, with `Prefer: respond-async` (RFC 7240).
  static bool wants_job(const RequestHead& head);
  /// Decides on which terms the body of a new job is accepted.
  Admission admit(const RequestHead& head) const;
  /// Accepts a job.
  /// Output: an answer with status 202.
  Response submit(const Call& call) const;

 private:
  JobService& jobs() const;
  JobRecord find_own(const Call& call) const;
  /// Input: `request` - must outlive the links.
  JobLinks links_for(const Request& request) const;
  Response list(const Call& call) const;
  Response show(const Call& call) const;
  Response remove(const Call& call) const;
  /// Reads the bytes of a blob.
  /// Errors: HttpError 410 - the blob has expired; 503 - the store cannot be used.
  std::string read(const std::string& id, BlobKind kind) const;
  std::uint64_t size_of(const std::string& id, BlobKind kind) const;
  /// Makes an answer from blobs in the worker pool.
  /// Input: `memory` - the bytes that the work takes; they stay reserved meanwhile.
  Response answer_from(const Operation& write, std::uint64_t memory, const Call& call) const;
  /// Reserves memory for the bytes that are read from a kept answer.
  Response answer_from(const KeptAnswer& kept, const Call& call) const;
  Response result(const Call& call) const;
  Response report(const Call& call) const;
  Response follow(const Call& call) const;

  const JobContext context_;
};

}  // namespace remesh::server::jobs
