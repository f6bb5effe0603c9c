/// Where geometry is computed: a few threads that take jobs from a bounded queue, which refuses when full.
#pragma once

#include <tbb/global_control.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace remesh::server {

class WorkerPool {
 public:
  /// At most `max_running` jobs run at once, each in a TBB arena of `workers` threads; `queue_size` more may wait.
  WorkerPool(int max_running, std::size_t queue_size, int workers);
  /// Waits for the jobs that run; those that wait are dropped.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Ticket = std::uint64_t;
  /// Queues a job, first come first served; it must not throw. Output: nothing when all threads are busy and the queue
  /// is full.
  std::optional<Ticket> try_submit(std::function<void()> job);
  /// Takes a job back. Output: false when it has started.
  bool withdraw(Ticket ticket);

  /// True when `try_submit` would refuse now.
  bool is_full() const;
  std::size_t running() const;
  std::size_t queued() const;

 private:
  struct Entry {
    Ticket ticket;
    std::function<void()> job;
  };

  void work(int workers);
  bool is_full_locked() const { return queue_.size() + running_ >= threads_.size() + queue_size_; }

  /// All arenas share this many threads, as many as asked for even where the machine has fewer cores.
  const tbb::global_control parallelism_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  std::vector<std::thread> threads_;
  const std::size_t queue_size_;
  std::size_t running_ = 0;
  Ticket next_ticket_ = 1;
  bool stopping_ = false;
};

}  // namespace remesh::server
