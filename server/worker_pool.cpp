#include "server/worker_pool.h"

#include <tbb/task_arena.h>

#include <algorithm>

namespace remesh::server {

WorkerPool::WorkerPool(int max_running, std::size_t queue_size, int workers)
    : parallelism_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(workers)),
      queue_size_(queue_size) {
  // The lock: a thread must not look at `threads_` while it grows.
  const std::lock_guard lock(mutex_);
  for (int i = 0; i < max_running; ++i) threads_.emplace_back([this, workers] { work(workers); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

std::optional<WorkerPool::Ticket> WorkerPool::try_submit(std::function<void()> job) {
  Ticket ticket = 0;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_ || is_full_locked()) return std::nullopt;
    ticket = next_ticket_++;
    queue_.push_back({ticket, std::move(job)});
  }
  changed_.notify_one();
  return ticket;
}

bool WorkerPool::withdraw(Ticket ticket) {
  const std::lock_guard lock(mutex_);
  const auto entry =
      std::find_if(queue_.begin(), queue_.end(), [&](const Entry& candidate) { return candidate.ticket == ticket; });
  if (entry == queue_.end()) return false;
  queue_.erase(entry);
  return true;
}

bool WorkerPool::is_full() const {
  const std::lock_guard lock(mutex_);
  return stopping_ || is_full_locked();
}

std::size_t WorkerPool::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

std::size_t WorkerPool::queued() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

void WorkerPool::work(int workers) {
  // One arena a thread: a huge mesh can take idle cores, but never the thread that a small one runs on.
  tbb::task_arena arena(workers);
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (stopping_) return;
    std::function<void()> job = std::move(queue_.front().job);
    queue_.pop_front();
    ++running_;
    lock.unlock();
    arena.execute(job);
    job = nullptr;  // what it holds is freed outside the lock
    lock.lock();
    --running_;
  }
}

}  // namespace remesh::server
