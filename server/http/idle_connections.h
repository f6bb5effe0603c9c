/// Connections between two requests. Each holds a thread and a descriptor, so there may be so many; then the one that
/// has waited longest is ended for the next.
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

  /// A connection's stay among them. It is ended by its event alone: the socket is left as it is, so that a request
  /// which arrives just then is served as any other.
  class Stay {
   public:
    /// Ends another's where there are too many.
    Stay(IdleConnections& all, Event& end);
    ~Stay();
    Stay(const Stay&) = delete;
    Stay& operator=(const Stay&) = delete;

   private:
    IdleConnections& all_;
    const std::uint64_t number_;
  };

  /// Ends all, and those that come before it `begins_again`.
  void end_all();
  void begin_again();

  bool is_over() const { return is_over_; }
  std::size_t count() const { return count_; }

 private:
  std::uint64_t add(Event& end);

  const std::size_t most_;
  std::mutex mutex_;
  std::uint64_t next_number_ = 0;
  std::map<std::uint64_t, Event*> ends_;  ///< of those that were not ended, the oldest first
  std::atomic<bool> is_over_{false};
  std::atomic<std::size_t> count_{0};
};

}  // namespace remesh::server
