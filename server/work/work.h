/// How a connection's thread hands work to the pool and waits for it, without computing itself.
#pragma once

#include <chrono>
#include <functional>

#include "api/service.h"
#include "server/http/connection.h"
#include "server/http/http_message.h"
#include "server/work/request_registry.h"
#include "server/work/worker_pool.h"

namespace remesh::server {

using Operation = std::function<api::Response(const api::Request&, const api::Limits&, RunControl&)>;

struct WorkLimits {
  api::Limits api;
  std::chrono::milliseconds request_timeout{300'000};  ///< of computing; a place in the queue is given up after as long
  std::uint64_t memory_budget = 0;                     ///< of all requests, to be told to one that is too large for it
};

/// Runs `operation` on the request in the pool. While it runs, the request can be found in the registry; it stops when
/// the client goes away, when its time is over and when it is cancelled.
/// Output:  what the operation answers. `request.id` becomes the id it ran under, `request.timing` what it took; its
///          body is consumed.
/// Errors:  what the operation throws; remesh::Error kTimeout, kCancelled; HttpError 503 - the queue is full, no thread
///          came free in time, or it was ended for its memory (413 where it was alone).
api::Response run_in_pool(WorkerPool& pool, RequestRegistry& registry, const WorkLimits& limits,
                          const Operation& operation, Request& request, Connection& connection);

/// What the pool is told of a body of that size.
JobSize size_of_job(std::uint64_t body_bytes);

/// The answer to work that finds no place. Throw it.
HttpError overloaded();

}  // namespace remesh::server
