/// Does something again and again in a thread of its own, until its end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace remesh::server {

class Periodic {
 public:
  /// What `task` throws is forgotten: it comes again.
  Periodic(std::chrono::milliseconds period, std::function<void()> task);
  /// Waits for the task if it runs.
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
