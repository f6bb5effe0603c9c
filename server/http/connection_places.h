/// The places of a listener's connections. Connections that are being served and connections that wait for their next
/// request each take a thread and a descriptor, so both take a place. Waiting connections stay open as long as there is
/// room: if a new connection finds no free place, the connection that has waited longest is closed.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "server/http/connection.h"

namespace remesh::server {

class ConnectionPlaces {
 public:
  explicit ConnectionPlaces(std::size_t max) : max_(max) {}

  /// The place of a connection that is being served.
  class Served {
   public:
    explicit Served(ConnectionPlaces& all) : all_(&all) {}
    Served(Served&& other) noexcept : all_(std::exchange(other.all_, nullptr)) {}
    Served& operator=(Served&&) = delete;
    ~Served();

   private:
    ConnectionPlaces* all_;
  };
  /// Takes a place. If all are taken, this ends the longest wait.
  /// Output: nothing if all connections are being served.
  std::optional<Served> enter();

  /// The time that one connection spends waiting. The wait is ended by its event and not by closing the socket, so that
  /// a request which arrives just then is served like any other.
  class Wait {
   public:
    /// Input: `end` - the event that is set to end this wait.
    Wait(ConnectionPlaces& all, Event& end);
    ~Wait();
    Wait(const Wait&) = delete;
    Wait& operator=(const Wait&) = delete;

   private:
    ConnectionPlaces& all_;
    const std::uint64_t number_;
  };

  /// Ends all waits, and every wait that begins before `begin_again` is called.
  void end_all();
  void begin_again();

  bool is_over() const { return is_over_; }
  std::size_t served() const { return served_; }
  std::size_t waiting() const { return waiting_; }

 private:
  std::uint64_t add(Event& end);
  /// Ends the longest waits until at most `max_` places are taken.
  void make_room_locked();

  const std::size_t max_;
  std::mutex mutex_;
  std::uint64_t next_number_ = 0;
  std::map<std::uint64_t, Event*> ends_;  ///< events of the waits that were not ended, the oldest first
  std::atomic<bool> is_over_{false};
  std::atomic<std::size_t> served_{0};
  std::atomic<std::size_t> waiting_{0};  ///< including waits that were ended but whose threads have not noticed it yet
};

}  // namespace remesh::server
