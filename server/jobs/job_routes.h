/// What can be asked about jobs over HTTP.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/http/route.h"
#include "server/jobs/job_service.h"
#include "server/work/work.h"

namespace remesh::server::jobs {

/// What the routes stand on; all of it outlives them.
struct JobContext {
  JobService* jobs = nullptr;  ///< none: all of it is answered with 501
  const WorkLimits& limits;
  MemoryBudget& memory;
  RequestRegistry& registry;
  WorkerPool& pool;
  const std::atomic<bool>& draining;
};

/// The answer while the store cannot be used. Throw it.
HttpError store_unavailable();

class JobRoutes {
 public:
  explicit JobRoutes(const JobContext& context) : context_(context) {}

  std::vector<Route> routes();

  /// Whether a request to remesh wants to be answered later (`Prefer: respond-async`, RFC 7240).
  static bool wants_job(const RequestHead& head);
  /// On what terms the body of a new job is let in.
  Admission admit(const RequestHead& head) const;
  /// Accepts a job. Output: 202.
  Response submit(const Call& call) const;

 private:
  JobService& jobs() const;
  JobRecord find_own(const Call& call) const;
  Response list(const Call& call) const;
  Response show(const Call& call) const;
  Response remove(const Call& call) const;
  /// A blob's bytes, or its size. Errors: HttpError 410 - its time is over; 503.
  std::string read(const std::string& id, BlobKind kind) const;
  std::uint64_t size_of(const std::string& id, BlobKind kind) const;
  /// Makes an answer from blobs in the pool. `memory`: what that takes, held meanwhile.
  Response answer_from(const Operation& write, std::uint64_t memory, const Call& call) const;
  Response result(const Call& call) const;
  Response report(const Call& call) const;
  Response follow(const Call& call) const;

  const JobContext context_;
};

}  // namespace remesh::server::jobs
