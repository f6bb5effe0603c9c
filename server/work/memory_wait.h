/// Lets a connection's thread wait for memory that others have reserved.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>

#include "server/http/connection.h"
#include "server/http/http_message.h"
#include "server/work/memory_budget.h"
#include "server/work/worker_pool.h"

namespace remesh::server {

/// How long requests may wait for memory.
struct MemoryPatience {
  std::chrono::milliseconds small{300'000};  ///< requests with bodies of at most WorkerPool::kSmallBytes
  std::chrono::milliseconds large{30'000};

  /// Input: the size of the body, as far as it is known.
  std::chrono::milliseconds of(std::uint64_t bytes) const { return bytes <= WorkerPool::kSmallBytes ? small : large; }
};

/// How a client that has closed its sending side is treated while its request waits or is worked on.
Connection::HalfClosed half_closed(const RequestHead& head);

/// The end of the waiting of a request, if it may wait for this long in all.
inline Clock::time_point end_of_waiting(const Request& request, std::chrono::milliseconds patience) {
  return Clock::now() + std::max<Clock::duration>(patience - request.waited, Clock::duration(0));
}

/// Waits until `try_hold`, which reserves memory for this share, succeeds. The time is added to `request.waited`.
/// Input:  `wake` - ends a pause between two attempts; may be null. `look` - called after each pause; it may throw.
/// Errors: HttpError 503 `out_of_memory` - the time is over, too many requests wait, or all shares that hold memory
///         wait for more; 503 `draining` - the budget was closed; ConnectionLost - the client is gone, and `look` is
///         null.
void wait_for_memory(MemoryShare& share, const std::function<bool()>& try_hold, Request& request,
                     Connection& connection, Clock::time_point end, Event* wake = nullptr,
                     const std::function<void(Connection::Wake)>& look = nullptr);

/// Does the same as MemoryShare::hold_body, and waits if there is not enough memory now.
/// Errors: as MemoryShare::hold_body and above.
void hold_body_in_line(MemoryShare& share, std::uint64_t held, std::uint64_t expected, Request& request,
                       Connection& connection, const MemoryPatience& patience);

}  // namespace remesh::server
