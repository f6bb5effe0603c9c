#include "server/http/large_answer.h"

#include <algorithm>
#include <chrono>
#include <string_view>

namespace remesh::server {
namespace {

/// A client keeps up if it reads at this pace. An answer of 100 MB then leaves memory within 13 s at most.
constexpr Pace kKeepsUp{std::chrono::milliseconds(1000), 8 << 20};
/// The pace of a client that reads from the spool.
constexpr Pace kSlowest{std::chrono::milliseconds(60'000), 64 << 10};
constexpr std::chrono::minutes kLongest{30};
/// The number of bytes that are given to the system at once.
constexpr std::size_t kPiece = 1 << 20;

/// Sends bytes while the client keeps up.
/// Output: the bytes that are left.
std::string_view send_while_it_keeps_up(Connection& connection, std::string_view bytes) {
  const Clock::time_point start = Clock::now();
  std::uint64_t sent = 0;
  while (!bytes.empty()) {
    const Clock::time_point deadline = kKeepsUp.deadline(start, sent);
    const std::size_t put = connection.write_some(bytes.substr(0, kPiece));
    bytes.remove_prefix(put);
    sent += put;
    if (Clock::now() >= deadline) break;
    if (put == 0 && !connection.wait_until_writable(deadline)) break;
  }
  return bytes;
}

/// Calls `send_some`, which returns the number of bytes that it sent, until all are sent.
/// Errors: ConnectionLost - the client is too slow.
template <typename SendSome>
void send_slowly(Connection& connection, std::uint64_t size, Spool::Reader& reader, SendSome send_some) {
  const Clock::time_point start = Clock::now();
  std::uint64_t sent = 0;
  while (sent < size) {
    const Clock::time_point deadline = std::min(kSlowest.deadline(start, sent), start + kLongest);
    const std::size_t put = send_some(sent);
    sent += put;
    reader.record_sent(put);
    const bool has_time = Clock::now() < deadline && (put > 0 || connection.wait_until_writable(deadline));
    if (sent < size && !has_time) throw ConnectionLost("the client reads too slowly");
  }
}

}  // namespace

void send_large(Connection& connection, std::string body, Spool& spool, const std::function<void()>& release_memory) {
  const std::string_view rest = send_while_it_keeps_up(connection, body);
  if (rest.empty()) return;
  const std::uint64_t size = rest.size();
  Spool::Reader reader(spool, connection);
  if (!reader.place(rest)) {
    send_slowly(connection, size, reader,
                [&](std::uint64_t sent) { return connection.write_some(rest.substr(sent, kPiece)); });
    return;
  }
  std::string().swap(body);
  if (!spool.is_in_memory()) release_memory();
  send_slowly(connection, size, reader, [&](std::uint64_t sent) {
    return connection.send_file(reader.fd(), sent, std::min<std::uint64_t>(kPiece, size - sent));
  });
}

}  // namespace remesh::server
