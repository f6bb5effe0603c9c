/// One accepted connection. It reads and writes under deadlines, and notices when the client goes away.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "server/http/read_ahead.h"

namespace remesh::server {

using Clock = std::chrono::steady_clock;

inline double milliseconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

/// The slowest permitted transfer: `grace` plus the time that the bytes take at `min_rate` bytes a second.
struct Pace {
  std::chrono::milliseconds grace{10'000};
  std::uint64_t min_rate = 1024;

  Clock::time_point deadline(Clock::time_point start, std::uint64_t bytes) const;
};

/// The client reset the connection or stopped reading, so nothing can be sent to it any more.
struct ConnectionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The deadline of a read has passed.
struct ReadTimeout : std::runtime_error {
  ReadTimeout() : std::runtime_error("read timeout") {}
};

/// A flag that poll() can wait for. Any thread may set it.
/// Errors: std::system_error - no descriptor is left.
class Event {
 public:
  Event();
  ~Event();
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  void set() noexcept;
  void clear() noexcept;
  /// Waits until the event is set.
  /// Output: false if the time ends first.
  bool wait(Clock::time_point until) const;
  int fd() const { return fd_; }

 private:
  int fd_;
};

class Connection {
 public:
  /// Takes ownership of the socket.
  /// Input: `ahead` - bounds the number of bytes that are read ahead; if it is null, none are.
  explicit Connection(int socket, ReadAhead* ahead = nullptr);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Begins the next request: the byte counts restart at 0, and a half-closed client is probed again.
  void begin_exchange() {
    read_ = written_ = 0;
    ask_at_.reset();
  }

  /// Waits for bytes.
  /// Output: the number of bytes read; 0 at the end of input.
  /// Errors: ReadTimeout, ConnectionLost.
  std::size_t read_some(char* buffer, std::size_t size, Clock::time_point deadline);
  /// Returns the last bytes that were read, so that the next read begins with them.
  void put_back(std::string_view bytes);
  /// Waits until there are bytes to read, `end` is set, or the time ends.
  /// Output: true if there are bytes to read.
  bool wait_for_input(const Event& end, Clock::time_point until) const;

  /// Sends all bytes.
  /// Errors: ConnectionLost - also if the client reads more slowly than `pace`.
  void write_all(std::string_view bytes, const Pace& pace);
  /// Does the same at the pace set by `set_write_pace`, for answers that stream.
  void write_all(std::string_view bytes) { write_all(bytes, write_pace_); }
  void set_write_pace(const Pace& pace) { write_pace_ = pace; }

  /// Sends as many bytes as the system takes without waiting.
  /// Output: their number; it may be 0.
  /// Errors: ConnectionLost - the client is gone.
  std::size_t write_some(std::string_view bytes);
  /// Does the same with `size` bytes of a file, from `offset` on.
  std::size_t send_file(int file, std::uint64_t offset, std::size_t size);
  /// Output: false if the time ends first.
  bool wait_until_writable(Clock::time_point until) const;
  /// Ends the connection. Threads that read from it or write to it get an error. Any thread may call this.
  void abort() const;

  enum class Wake { kEvent, kClientGone, kTime };
  /// How to treat a client that has closed its sending side. `nc -N` does that and still waits for its answer, but a
  /// client that was killed looks the same.
  enum class HalfClosed {
    kIsGone,  ///< the client is treated as gone
    /// The client is probed by an interim answer, 102. If the client no longer exists, its machine answers with a
    /// reset. Only clients of HTTP/1.1 can be probed.
    kIsAsked,
  };
  /// Waits until the event is set, the client goes away, or the time is over. Meanwhile it reads ahead bytes of the
  /// client's next request, because the end of the client's data can only be seen after all bytes before it. Beyond the
  /// limits of ReadAhead, only a reset shows that the client is gone.
  /// Input: `may_read` - false leaves the client's bytes unread: they belong to a request whose body has not been read
  ///        yet, or that has no memory.
  Wake wait(const Event* event, Clock::time_point until, HalfClosed half_closed = HalfClosed::kIsGone,
            bool may_read = true);

  /// The limits for reading the bytes that a client still sends after its answer.
  struct Linger {
    Pace pace;                              ///< slower clients are cut off
    std::chrono::milliseconds max_time{0};  ///< the longest time in all
    std::uint64_t max_bytes = 0;
  };
  /// Ends the answer so that the client can read it. It stops sending, and then reads and drops the bytes that the
  /// client still sends: closing a socket with unread bytes would reset the connection, and many clients look for an
  /// answer only after they have sent everything.
  /// Input: `may_linger` - asked between reads; false ends the reading.
  void finish(const Linger& linger, const std::function<bool()>& may_linger);

  /// Reads and drops a CRLF if those are the next bytes.
  void skip_line_end();
  /// True if bytes have arrived that have not been read.
  bool has_unread_input() const;

  const std::string& peer_address() const { return peer_address_; }
  /// The bytes of the current request and its answer.
  std::uint64_t bytes_written() const { return written_; }
  std::uint64_t bytes_read() const { return read_; }

 private:
  /// Lets the public constructor delegate here, so that the socket is closed even if that constructor fails later.
  struct Owned {};
  Connection(int socket, ReadAhead* ahead, Owned) noexcept : socket_(socket), ahead_(ahead) {}

  enum class Ahead {
    kHasRead,
    kEnd,    ///< the client sends no more
    kIsFull  ///< the limits are reached
  };
  /// Reads bytes that have arrived, for the next request.
  Ahead read_ahead();

  /// Evaluates the result of a system call that sends.
  std::size_t sent(ssize_t put);
  /// Frees the bytes that were put back, once all of them have been read again.
  void drop_put_back();
  bool has_put_back() const { return read_again_ < put_back_.size(); }

  int socket_;
  std::string peer_address_;
  std::optional<Clock::time_point> ask_at_;  ///< the time of the next probe of a half-closed client
  Pace write_pace_;
  std::string put_back_;        ///< bytes that were read too early and will be read again
  std::size_t read_again_ = 0;  ///< the number of bytes in `put_back_` that were read again
  ReadAhead::Share ahead_;
  std::uint64_t written_ = 0;
  std::uint64_t read_ = 0;
};

}  // namespace remesh::server
