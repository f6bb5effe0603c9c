#include "server/work/memory_wait.h"

#include <algorithm>

namespace remesh::server {
namespace {

/// How often a request that waits looks whether there is memory.
constexpr std::chrono::milliseconds kLook{25};
/// If more requests than this wait, they look less often.
constexpr std::size_t kUsualLine = 16;

}  // namespace

Connection::HalfClosed half_closed(const RequestHead& head) {
  return head.minor_version >= 1 ? Connection::HalfClosed::kIsAsked : Connection::HalfClosed::kIsGone;
}

void wait_for_memory(MemoryShare& share, const std::function<bool()>& try_hold, const RequestHead& head,
                     Connection& connection, Clock::time_point end, Event* wake,
                     const std::function<void(Connection::Wake)>& look) {
  if (try_hold()) return;
  struct Place {
    explicit Place(MemoryShare& its_share) : share(its_share) { share.stand_in_line(); }
    ~Place() { share.leave_line(); }
    MemoryShare& share;
  } const place(share);
  while (!try_hold()) {
    const MemoryBudget& budget = share.budget();
    if (budget.is_closed()) {
      throw HttpError(503, "draining", "this server is about to stop");
    }
    if (Clock::now() >= end || share.is_stuck()) throw out_of_memory();
    const auto pause = kLook * static_cast<int>(1 + budget.waiting() / kUsualLine);
    const Connection::Wake woken = connection.wait(wake, std::min(end, Clock::now() + pause), half_closed(head));
    if (look) {
      look(woken);
    } else if (woken == Connection::Wake::kClientGone) {
      throw ConnectionLost("the client has gone while its request waited for memory");
    }
  }
}

void hold_body_in_line(MemoryShare& share, std::uint64_t held, std::uint64_t expected, const RequestHead& head,
                       Connection& connection, const MemoryPatience& patience) {
  const Clock::time_point end = Clock::now() + patience.of(std::max(held, expected));
  wait_for_memory(
      share, [&] { return share.try_hold_body(held, expected); }, head, connection, end);
}

}  // namespace remesh::server
