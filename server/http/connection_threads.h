/// Gives each connection a thread, so that a slow client blocks only its own thread. A thread stays for a moment to
/// serve the next connection.
#pragma once

#include <httplib.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "server/observe/heap_tops.h"

namespace remesh::server {

/// The task queue to which httplib gives accepted connections.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  /// Input: `end_waits` - called when the threads must end, to wake threads that wait for an event that may never come.
  ConnectionThreads(std::size_t max_threads, std::function<void()> end_waits)
      : max_threads_(max_threads), end_waits_(std::move(end_waits)) {
    waiting_.reserve(max_threads);  // so that handing on a connection allocates no memory
  }

  void enqueue(std::function<void()> serve) override {
    {
      std::unique_lock lock(mutex_);
      if (waiting_.size() < idle_) {
        waiting_.push_back(std::move(serve));
        lock.unlock();
        return changed_.notify_one();
      }
      if (running_ >= max_threads_) {
        lock.unlock();
        return serve();  // in the listener's thread, which only refuses
      }
      ++running_;
    }
    try {
      std::thread([this, serve] { run(serve); }).detach();
    } catch (const std::exception&) {  // no thread, or no memory for one
      leave();
      serve();
    }
  }

  /// The library also calls this when it cannot accept a connection, before it listens again.
  void shutdown() override {
    end_waits_();
    std::unique_lock lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
    left_.wait(lock, [this] { return running_ == 0; });
  }

 private:
  /// How long a thread waits for another connection. With it, clients that come one after another do not need a new
  /// thread each.
  static constexpr std::chrono::seconds kStay{2};

  void run(std::function<void()> serve) {
    while (serve) {
      serve();
      HeapTops::return_if_asked();
      serve = next();
    }
    HeapTops::return_now();
    leave();
  }

  /// Output: null if no connection came in time.
  std::function<void()> next() {
    std::unique_lock lock(mutex_);
    ++idle_;
    changed_.wait_for(lock, kStay, [this] { return is_over_ || !waiting_.empty(); });
    --idle_;
    if (waiting_.empty()) return nullptr;
    std::function<void()> serve = std::move(waiting_.back());
    waiting_.pop_back();
    return serve;
  }

  void leave() {
    // The notification happens under the lock because this object may be destroyed once `shutdown` returns.
    const std::lock_guard lock(mutex_);
    --running_;
    left_.notify_all();
  }

  const std::size_t max_threads_;
  const std::function<void()> end_waits_;
  std::mutex mutex_;
  std::condition_variable changed_;             ///< wakes threads that wait for a connection
  std::condition_variable left_;                ///< wakes `shutdown`
  std::vector<std::function<void()>> waiting_;  ///< connections that were handed on; never more than idle threads
  std::size_t idle_ = 0;                        ///< threads that wait for a connection
  std::size_t running_ = 0;                     ///< all threads, including idle ones
  bool is_over_ = false;
};

}  // namespace remesh::server
