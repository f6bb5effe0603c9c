/// A thread a connection: a slow client holds nothing but its own.
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace remesh::server {

/// What httplib hands accepted connections to.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(std::size_t max_threads) : max_threads_(max_threads) {}

  void enqueue(std::function<void()> serve) override {
    {
      const std::lock_guard lock(mutex_);
      if (running_ >= max_threads_) return serve();  // in the listener's thread, which only refuses
      ++running_;
    }
    try {
      std::thread([this, serve] {
        serve();
        leave();
      }).detach();
    } catch (const std::exception&) {  // no thread, or no memory for one
      leave();
      serve();
    }
  }

  void shutdown() override {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return running_ == 0; });
  }

 private:
  void leave() {
    // Told under the lock: once `shutdown` returns, this object is gone.
    const std::lock_guard lock(mutex_);
    --running_;
    idle_.notify_all();
  }

  const std::size_t max_threads_;
  std::mutex mutex_;
  std::condition_variable idle_;
  std::size_t running_ = 0;
};

}  // namespace remesh::server
