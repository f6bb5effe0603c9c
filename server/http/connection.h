/// One accepted connection: reads and writes under deadlines, and notices when the client goes away.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace remesh::server {

using Clock = std::chrono::steady_clock;

inline double milliseconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

/// How slow a transfer may be: `grace` plus the time that its bytes take at `min_rate` bytes a second.
struct Pace {
  std::chrono::milliseconds grace{10'000};
  std::uint64_t min_rate = 1024;

  Clock::time_point deadline(Clock::time_point start, std::uint64_t bytes) const;
};

/// The client reset the connection or stopped reading: nothing can be answered any more.
struct ConnectionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The deadline of a read has passed.
struct ReadTimeout : std::runtime_error {
  ReadTimeout() : std::runtime_error("read timeout") {}
};

/// A flag that poll() can wait for; set from any thread. Errors: std::system_error - no descriptor is left.
class Event {
 public:
  Event();
  ~Event();
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  void set() noexcept;
  void clear() noexcept;
  /// Output: false when the time is over first.
  bool wait(Clock::time_point until) const;
  int fd() const { return fd_; }

 private:
  int fd_;
};

class Connection {
 public:
  /// Takes over the socket.
  explicit Connection(int socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// What follows belongs to another request: bytes are counted from 0, and the client is asked anew.
  void begin_exchange() {
    read_ = written_ = 0;
    ask_at_.reset();
  }

  /// Waits for bytes. Output: how many, 0 at the end of input. Errors: ReadTimeout, ConnectionLost.
  std::size_t read_some(char* buffer, std::size_t size, Clock::time_point deadline);
  /// Gives back the last bytes that were read: the next read begins with them.
  void put_back(std::string_view bytes);
  /// Waits until there is something to read, `end` is set or the time is over. Output: whether there is.
  bool wait_for_input(const Event& end, Clock::time_point until) const;

  /// Sends everything. Errors: ConnectionLost - also when the client reads more slowly than `pace`.
  void write_all(std::string_view bytes, const Pace& pace);
  /// As above, at the pace given by `set_write_pace`: for answers that stream.
  void write_all(std::string_view bytes) { write_all(bytes, write_pace_); }
  void set_write_pace(const Pace& pace) { write_pace_ = pace; }

  enum class Wake { kEvent, kClientGone, kTime };
  /// What to think of a client that has closed its sending side. `nc -N` does that and waits for its answer; of one
  /// that was killed nothing else is seen.
  enum class HalfClosed {
    kIsGone,
    kIsAsked,  ///< by an interim answer, 102, to which a machine without this client sends a reset; from HTTP/1.1 on
  };
  /// Waits for the event, the client's going away, or the time.
  Wake wait(const Event* event, Clock::time_point until, HalfClosed half_closed = HalfClosed::kIsGone);

  /// Ends the answer so that the client can read it: stops sending, then takes in for a moment what it still sends
  /// (closing on unread bytes would reset the connection, and the answer with it).
  void finish(std::chrono::milliseconds patience);

  /// Takes a CRLF if that is what has arrived next.
  void skip_line_end();
  /// True when bytes have arrived that nobody has read.
  bool has_unread_input() const;

  const std::string& peer_address() const { return peer_address_; }
  /// Of the exchange at hand.
  std::uint64_t bytes_written() const { return written_; }
  std::uint64_t bytes_read() const { return read_; }

 private:
  /// The socket is closed whatever fails after this.
  struct Owned {};
  Connection(int socket, Owned) noexcept : socket_(socket) {}

  bool has_put_back() const { return read_again_ < put_back_.size(); }

  int socket_;
  std::string peer_address_;
  std::optional<Clock::time_point> ask_at_;  ///< of a client that is half closed
  Pace write_pace_;
  std::string put_back_;        ///< what was read too far, to be read again
  std::size_t read_again_ = 0;  ///< how much of that has been
  std::uint64_t written_ = 0;
  std::uint64_t read_ = 0;
};

}  // namespace remesh::server
