#include "server/work/periodic.h"

#include <exception>
#include <utility>

namespace remesh::server {

Periodic::Periodic(std::chrono::milliseconds period, std::function<void()> task)
    : thread_([this, period, run = std::move(task)] {
        std::unique_lock lock(mutex_);
        while (!changed_.wait_for(lock, period, [this] { return stopping_; })) {
          lock.unlock();
          try {
            run();
          } catch (const std::exception&) {
            // The cause is mostly a lack of memory, and next time there may be some.
          }
          lock.lock();
        }
      }) {}

Periodic::~Periodic() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

}  // namespace remesh::server
