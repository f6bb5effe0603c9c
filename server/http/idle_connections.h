/// The connections that wait between two requests. Each one takes a thread and a descriptor, so their number is
/// limited. At the limit, a new one ends the one that has waited longest.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include "server/http/connection.h"

namespace remesh::server {

class IdleConnections {
 public:
  explicit IdleConnections(std::size_t most) : most_(most) {}

  /// The time that one connection spends waiting. Only its event ends it, not its socket, so that a request which
  /// arrives just then is served like any other.
  class Stay {
   public:
    /// Begins to wait. If the limit is reached, this ends the oldest stay.
    /// Input: `end` - the event that is set to end this stay.
    Stay(IdleConnections& all, Event& end);
    ~Stay();
    Stay(const Stay&) = delete;
    Stay& operator=(const Stay&) = delete;

   private:
    IdleConnections& all_;
    const std::uint64_t number_;
  };

  /// Ends all stays, and every stay that begins before `begin_again` is called.
  void end_all();
  void begin_again();

  bool is_over() const { return is_over_; }
  std::size_t count() const { return count_; }

 private:
  std::uint64_t add(Event& end);

  const std::size_t most_;
  std::mutex mutex_;
  std::uint64_t next_number_ = 0;
  std::map<std::uint64_t, Event*> ends_;  ///< events of the stays that were not ended, the oldest first
  std::atomic<bool> is_over_{false};
  std::atomic<std::size_t> count_{0};
};

}  // namespace remesh::server
