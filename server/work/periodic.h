/// Calls a function periodically in a thread of its own until the object is destroyed.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace remesh::server {

class Periodic {
 public:
  /// Starts the thread. Exceptions from `task` are ignored, and the next call comes as usual.
  Periodic(std::chrono::milliseconds period, std::function<void()> task);
  /// Waits for the task if it is running.
  ~Periodic();
  Periodic(const Periodic&) = delete;
  Periodic& operator=(const Periodic&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace remesh::server
