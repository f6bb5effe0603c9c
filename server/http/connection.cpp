#include "server/http/connection.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <system_error>

namespace remesh::server {
namespace {

/// The timeout to give to poll(): at least 0, and rounded up so that the deadline has passed when poll() returns.
int milliseconds_until(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, std::numeric_limits<int>::max()));
}

/// Output: false if the time ends first.
bool wait_for(int socket, short events, Clock::time_point deadline) {
  for (;;) {
    pollfd entry{socket, events, 0};
    const int ready = ::poll(&entry, 1, milliseconds_until(deadline));
    if (ready > 0) return true;
    if (ready == 0) return false;
    if (errno != EINTR) throw ConnectionLost("poll failed");
  }
}

/// Output: empty if the socket is not an internet socket.
std::string address_of_peer(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return {};
  if (address.ss_family == AF_INET) {
    ::inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in*>(&address)->sin_addr, text.data(), text.size());
  } else if (address.ss_family == AF_INET6) {
    ::inet_ntop(AF_INET6, &reinterpret_cast<sockaddr_in6*>(&address)->sin6_addr, text.data(), text.size());
  }
  return text.data();
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK; }

/// A half-closed client is probed only if its request takes longer than `kAskAfter`, and then again each `kAskAgain`.
constexpr std::chrono::milliseconds kAskAfter{20};
constexpr std::chrono::milliseconds kAskAgain{1000};

/// Sends an interim answer without waiting; if the socket's buffer is full, it is not sent.
/// Output: false if the client is gone.
bool send_interim(int socket, std::string_view head) {
  const ssize_t put = ::send(socket, head.data(), head.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return put == static_cast<ssize_t>(head.size()) || (put < 0 && would_block(errno));
}

}  // namespace

Clock::time_point Pace::deadline(Clock::time_point start, std::uint64_t bytes) const {
  if (min_rate == 0) return Clock::time_point::max();
  return start + grace + std::chrono::seconds(bytes / min_rate);
}

Event::Event() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Event::~Event() { ::close(fd_); }

void Event::set() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(fd_, &one, sizeof one);  // fails only if it was set very often
}

void Event::clear() noexcept {
  std::uint64_t value = 0;
  [[maybe_unused]] const ssize_t got = ::read(fd_, &value, sizeof value);
}

bool Event::wait(Clock::time_point until) const { return wait_for(fd_, POLLIN, until); }

Connection::Connection(int socket, ReadAhead* ahead) : Connection(socket, ahead, Owned{}) {
  peer_address_ = address_of_peer(socket_);
  ::fcntl(socket_, F_SETFD, FD_CLOEXEC);
  ::fcntl(socket_, F_SETFL, ::fcntl(socket_, F_GETFL) | O_NONBLOCK);
  const int yes = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

Connection::~Connection() { ::close(socket_); }

std::size_t Connection::read_some(char* buffer, std::size_t size, Clock::time_point deadline) {
  for (;;) {
    // The deadline is checked first, so that a client which always has one more byte ready cannot get past it.
    if (Clock::now() >= deadline) throw ReadTimeout();
    if (has_put_back()) {
      const std::size_t count = put_back_.copy(buffer, size, read_again_);
      read_again_ += count;
      read_ += count;
      drop_put_back();
      return count;
    }
    const ssize_t got = ::recv(socket_, buffer, size, 0);
    if (got >= 0) {
      read_ += static_cast<std::uint64_t>(got);
      return static_cast<std::size_t>(got);
    }
    if (would_block(errno)) {
      if (!wait_for(socket_, POLLIN, deadline)) throw ReadTimeout();
    } else if (errno != EINTR) {
      throw ConnectionLost("the client reset the connection");
    }
  }
}

void Connection::put_back(std::string_view bytes) {
  if (bytes.size() <= read_again_) {
    // The bytes after the skipped ones stay where they are. There may be many, and this function is called for each
    // request among them.
    read_again_ -= bytes.size();
    put_back_.replace(read_again_, bytes.size(), bytes);
  } else {
    put_back_.replace(0, read_again_, bytes);
    read_again_ = 0;
  }
  read_ -= bytes.size();
}

void Connection::drop_put_back() {
  if (has_put_back()) return;
  put_back_ = {};
  read_again_ = 0;
  ahead_.give_back();
}

bool Connection::wait_for_input(const Event& end, Clock::time_point until) const {
  std::array<pollfd, 2> entries{pollfd{socket_, POLLIN, 0}, pollfd{end.fd(), POLLIN, 0}};
  while (!has_put_back() && ::poll(entries.data(), entries.size(), milliseconds_until(until)) < 0 && errno == EINTR) {
  }
  return has_unread_input();
}

void Connection::write_all(std::string_view bytes, const Pace& pace) {
  const Clock::time_point start = Clock::now();
  std::uint64_t sent = 0;
  while (!bytes.empty()) {
    const Clock::time_point deadline = pace.deadline(start, sent);
    const ssize_t put = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (put >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(put));
      sent += static_cast<std::uint64_t>(put);
      written_ += static_cast<std::uint64_t>(put);
      if (!bytes.empty() && Clock::now() >= deadline) throw ConnectionLost("the client reads too slowly");
    } else if (would_block(errno)) {
      if (!wait_for(socket_, POLLOUT, deadline)) throw ConnectionLost("the client reads too slowly");
    } else if (errno != EINTR) {
      throw ConnectionLost("the client reset the connection");
    }
  }
}

std::size_t Connection::sent(ssize_t put) {
  if (put < 0 && !would_block(errno) && errno != EINTR) throw ConnectionLost("the client reset the connection");
  const std::size_t count = put > 0 ? static_cast<std::size_t>(put) : 0;
  written_ += count;
  return count;
}

std::size_t Connection::write_some(std::string_view bytes) {
  return sent(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

std::size_t Connection::send_file(int file, std::uint64_t offset, std::size_t size) {
  auto at = static_cast<off_t>(offset);
  return sent(::sendfile(socket_, file, &at, size));  // SIGPIPE is ignored by the whole process
}

bool Connection::wait_until_writable(Clock::time_point until) const { return wait_for(socket_, POLLOUT, until); }

void Connection::abort() const { ::shutdown(socket_, SHUT_RDWR); }

Connection::Ahead Connection::read_ahead() {
  std::array<char, 64 << 10> piece;
  const std::size_t room = ahead_.take(piece.size());
  if (room == 0) return Ahead::kIsFull;
  const ssize_t got = ::recv(socket_, piece.data(), room, MSG_DONTWAIT);
  const std::size_t count = got > 0 ? static_cast<std::size_t>(got) : 0;
  ahead_.give_back(room - count);
  put_back_.append(piece.data(), count);
  return got == 0 ? Ahead::kEnd : Ahead::kHasRead;  // poll() reports errors
}

Connection::Wake Connection::wait(const Event* event, Clock::time_point until, HalfClosed half_closed, bool may_read) {
  for (;;) {
    // poll() reports a reset whatever the events are.
    const auto events = static_cast<short>(ask_at_ ? 0 : may_read ? POLLRDHUP | POLLIN : POLLRDHUP);
    std::array<pollfd, 2> entries{pollfd{socket_, events, 0}, pollfd{event == nullptr ? -1 : event->fd(), POLLIN, 0}};
    const int ready =
        ::poll(entries.data(), entries.size(), milliseconds_until(std::min(until, ask_at_.value_or(until))));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return Wake::kClientGone;
    if (entries[1].revents != 0) return Wake::kEvent;
    if (ready == 0 && Clock::now() >= until) return Wake::kTime;
    if (ready == 0) {
      if (!send_interim(socket_, "HTTP/1.1 102 Processing\r\n\r\n")) return Wake::kClientGone;
      ask_at_ = Clock::now() + kAskAgain;
      continue;
    }
    if (entries[0].revents == POLLIN) {
      const Ahead ahead = read_ahead();
      may_read = ahead != Ahead::kIsFull;
      if (ahead != Ahead::kEnd) continue;
    }
    const bool is_half_closed = (entries[0].revents & (POLLERR | POLLHUP)) == 0;
    if (!is_half_closed || half_closed == HalfClosed::kIsGone) return Wake::kClientGone;
    ask_at_ = Clock::now() + kAskAfter;
  }
}

void Connection::skip_line_end() {
  const std::string_view end = "\r\n";
  std::array<char, 2> next{};
  if (has_put_back()) {
    if (put_back_.compare(read_again_, end.size(), end) != 0) return;
    read_again_ += end.size();
    drop_put_back();
  } else {
    const auto size = static_cast<ssize_t>(next.size());
    if (::recv(socket_, next.data(), next.size(), MSG_PEEK | MSG_DONTWAIT) != size) return;
    if (std::string_view(next.data(), next.size()) != end) return;
    if (::recv(socket_, next.data(), next.size(), MSG_DONTWAIT) != size) return;
  }
  read_ += end.size();
}

bool Connection::has_unread_input() const {
  if (has_put_back()) return true;
  char byte = 0;
  return ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
}

void Connection::finish(const Linger& linger, const std::function<bool()>& may_linger) {
  ::shutdown(socket_, SHUT_WR);
  const Clock::time_point start = Clock::now();
  const Clock::time_point end = start + linger.max_time;
  std::array<char, 64 << 10> sink;
  try {
    std::uint64_t dropped = 0;
    std::size_t got = 1;
    while (got > 0 && dropped <= linger.max_bytes && may_linger()) {
      got = read_some(sink.data(), sink.size(), std::min(end, linger.pace.deadline(start, dropped)));
      dropped += got;
    }
  } catch (const std::runtime_error&) {
    // The client is gone or still sending. In both cases this connection ends.
  }
}

}  // namespace remesh::server
