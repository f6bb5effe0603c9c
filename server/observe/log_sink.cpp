#include "server/observe/log_sink.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace remesh::server::log {
namespace {

using Clock = std::chrono::steady_clock;

/// The interval in which a waiting sink checks whether the process ends.
constexpr int kLookMs = 50;

/// Writes some bytes without waiting.
/// Output: their number; -1 with errno, which is EAGAIN if writing would have to wait.
ssize_t write_some(int descriptor, std::string_view bytes) {
  const ssize_t sent = ::send(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent >= 0 || errno != ENOTSOCK) return sent;
  // The descriptor must not be made non-blocking, because other processes may use it too. But a pipe that is ready
  // takes this many bytes at once.
  pollfd entry{descriptor, POLLOUT, 0};
  if (::poll(&entry, 1, 0) == 0) {
    errno = EAGAIN;
    return -1;
  }
  return ::write(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), PIPE_BUF));
}

}  // namespace

void LogSink::sink_it_(const spdlog::details::log_msg& message) {
  spdlog::memory_buf_t line;
  if (is_cut_) line.push_back('\n');
  formatter_->format(message, line);
  if (!write_all({line.data(), line.size()})) ++dropped_;
}

bool LogSink::write_all(std::string_view line) {
  bool is_begun = false;
  while (!line.empty()) {
    const ssize_t written = write_some(descriptor_, line);
    if (written >= 0) {
      line.remove_prefix(static_cast<std::size_t>(written));
      is_begun = true;
      continue;
    }
    if (errno == EINTR) continue;
    const bool waits = errno == EAGAIN || errno == EWOULDBLOCK;
    if (!waits || Clock::now() >= end_.load()) {
      is_cut_ = is_cut_ || is_begun;
      return false;
    }
    pollfd entry{descriptor_, POLLOUT, 0};
    ::poll(&entry, 1, kLookMs);
  }
  is_cut_ = false;
  return true;
}

}  // namespace remesh::server::log
