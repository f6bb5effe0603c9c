/// Connections between two requests. Each holds a thread and a descriptor, so there may be so many; then the one that
/// has waited longest is ended for the next.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

namespace remesh::server {

class IdleConnections {
 public:
  explicit IdleConnections(std::size_t most) : most_(most) {}

  /// A connection's stay among them.
  class Stay {
   public:
    /// Ends another's where there are too many.
    Stay(IdleConnections& all, int socket);
    ~Stay();
    Stay(const Stay&) = delete;
    Stay& operator=(const Stay&) = delete;

   private:
    IdleConnections& all_;
    const std::uint64_t number_;
  };

  /// Ends all, and those that come after.
  void end_all();

  std::size_t count() const { return count_; }

 private:
  /// As if the client had nothing more to say; what it has said is still read.
  static void end(int socket);

  const std::size_t most_;
  std::mutex mutex_;
  std::uint64_t next_number_ = 0;
  std::map<std::uint64_t, int> sockets_;  ///< those that were not ended, the oldest first
  bool is_over_ = false;
  std::atomic<std::size_t> count_{0};
};

}  // namespace remesh::server
