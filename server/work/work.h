/// Hands the work of a connection's thread to the pool, and waits for the result.
#pragma once

#include <algorithm>
#include <functional>
#include <string>

#include "api/operations.h"
#include "server/http/http_message.h"
#include "server/http/route.h"
#include "server/work/memory_wait.h"
#include "server/work/request_registry.h"
#include "server/work/worker_pool.h"

namespace remesh::server {

using Operation = std::function<api::Response(const api::Request&, const api::Limits&, RunControl&)>;
using Check = std::function<void(const api::Request&, const api::Limits&, RunControl&)>;

struct WorkLimits {
  api::Limits api;
  /// The memory for all requests together. An error reports it to a request that is too large for it.
  std::uint64_t memory_budget = 0;

  /// A small request may wait for memory for as long as its work may take. A large request gives up sooner, because
  /// other requests may have gone before it for good reasons.
  MemoryPatience memory_patience() const {
    MemoryPatience patience;
    patience.small = api.request_timeout;
    patience.large = std::min(patience.large, patience.small);
    return patience;
  }
};

/// Returns the same limits, with which each attempt at a result writes a line to the log, at the level debug.
/// Input: the id of the request or of the job.
api::Limits with_trace(const api::Limits& limits, const std::string& id);

/// The objects that all work needs. They must outlive it.
struct Workplace {
  WorkerPool& pool;
  RequestRegistry& registry;
  const WorkLimits& limits;
};

/// Runs `operation` on the request in the pool. While it runs, the request can be found in the registry. It stops
/// when the client goes away, when its time is over, or when it is cancelled.
/// Input:   `call` - its request has a share of the memory, which shrinks to the size of the answer.
/// Output:  the answer of the operation. `request.id` becomes the id under which it ran, and `request.timing` the
///          times that it took; the request's body is consumed.
/// Errors:  whatever the operation throws; remesh::Error kTimeout, kCancelled; HttpError 503 - the queue is full, no
///          thread became free in time, the daemon is about to stop, or the request was ended because of its memory
///          (413 if it was alone).
Response run_in_pool(const Workplace& place, const Operation& operation, const Call& call);

/// Runs `check` on the request in the pool, as run_in_pool does. In the queue, the check counts as a small request,
/// however large the body is. Afterwards the request has its body and its memory as before.
/// Errors:  as run_in_pool.
void check_in_pool(const Workplace& place, Check check, const Call& call);

/// The error to throw if the pool has no place for the work. Its Retry-After is the time that the waiting tasks will
/// probably take.
HttpError overloaded(const WorkerPool& pool);

}  // namespace remesh::server
