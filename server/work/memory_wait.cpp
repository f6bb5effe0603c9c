#include "server/work/memory_wait.h"

namespace remesh::server {
namespace {

/// How often a waiting request checks whether there is memory.
constexpr std::chrono::milliseconds kLook{25};
/// If more requests than this wait, they check less often, but at least once in each `kMaxLook`.
constexpr std::size_t kUsualLine = 16;
constexpr std::chrono::milliseconds kMaxLook{100};

}  // namespace

Connection::HalfClosed half_closed(const RequestHead& head) {
  return head.minor_version >= 1 ? Connection::HalfClosed::kIsAsked : Connection::HalfClosed::kIsGone;
}

void wait_for_memory(MemoryShare& share, const std::function<bool()>& try_hold, Request& request,
                     Connection& connection, Clock::time_point end, Event* wake,
                     const std::function<void(Connection::Wake)>& look) {
  if (try_hold()) return;
  struct Place {
    Place(MemoryShare& its_share, Request& its_request) : share(its_share), request(its_request) {
      if (!share.try_stand_in_line(start)) throw out_of_memory();
    }
    ~Place() {
      share.leave_line();
      request.waited += Clock::now() - start;
    }
    MemoryShare& share;
    Request& request;
    const Clock::time_point start = Clock::now();
  } const place(share, request);
  while (!try_hold()) {
    const MemoryBudget& budget = share.budget();
    if (budget.is_closed()) throw draining();
    if (Clock::now() >= end || share.is_stuck()) throw out_of_memory();
    const auto pause = std::min(kMaxLook, kLook * static_cast<int>(1 + budget.waiting() / kUsualLine));
    // Until the body has been read, the next bytes belong to it, and there is no memory for them.
    const bool has_body = request.timing.body.has_value();
    const Connection::Wake woken =
        connection.wait(wake, std::min(end, Clock::now() + pause), half_closed(request), /*may_read=*/has_body);
    if (look) {
      look(woken);
    } else if (woken == Connection::Wake::kClientGone) {
      throw ConnectionLost("the client has gone while its request waited for memory");
    }
  }
}

void hold_body_in_line(MemoryShare& share, std::uint64_t held, std::uint64_t expected, Request& request,
                       Connection& connection, const MemoryPatience& patience) {
  const Clock::time_point end = end_of_waiting(request, patience.of(std::max(held, expected)));
  wait_for_memory(
      share, [&] { return share.try_hold_body(held, expected); }, request, connection, end);
}

}  // namespace remesh::server
