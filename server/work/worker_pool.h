/// Where geometry is computed: a few threads that take jobs from a bounded queue, which refuses when full.
#pragma once

#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <latch>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "server/http/connection.h"

namespace remesh::server {

/// What a job is expected to take, by the size of its mesh.
enum class JobSize { kSmall, kLarge };

/// First come, first served, with two exceptions so that huge meshes cannot starve small ones:
/// - While every place is held by a job that is large or has run for more than `kLong`, a small job passes, on a place
///   beyond `max_running`; and another one once that has run for so long, too. There are as many such places again.
/// - The last quarter of the queue is for small jobs.
class WorkerPool {
 public:
  static constexpr std::chrono::milliseconds kLong{1000};

  /// At most `max_running` jobs run at once, each in a TBB arena of `workers` threads; `queue_size` more may wait.
  WorkerPool(int max_running, std::size_t queue_size, int workers);
  /// Waits for the jobs that run; those that wait are dropped.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Ticket = std::uint64_t;
  /// Queues a job; it must not throw. Output: nothing when no thread is free and the queue is full.
  std::optional<Ticket> try_submit(std::function<void()> job, JobSize size = JobSize::kSmall);
  /// Takes a job back. Output: false when it has started.
  bool withdraw(Ticket ticket);

  /// True when `try_submit` would refuse now.
  bool is_full(JobSize size = JobSize::kSmall) const;
  std::size_t running() const;
  std::size_t queued() const;
  /// Threads that are inside the arenas.
  std::size_t busy_threads() const { return busy_threads_; }

 private:
  struct Entry {
    Ticket ticket;
    JobSize size;
    std::function<void()> job;
  };
  struct Running {
    JobSize size;
    Clock::time_point start;
  };
  class BusyThreads;

  /// `place`: of this thread in `running_`.
  void work(std::size_t place, int workers);
  bool is_full_locked(JobSize size) const;
  bool may_start_locked(JobSize size) const;
  /// When a place may open although no job ends; the maximum where that cannot be.
  Clock::time_point next_change_locked() const;
  /// The first that may start.
  std::deque<Entry>::iterator next_locked();
  /// Whether a thread that waits has something to do: a job to start, or to know that a place opens earlier.
  bool needs_thread_locked();
  std::optional<Entry> take_locked();

  /// All arenas share this many threads, as many as asked for even where the machine has fewer cores.
  const tbb::global_control parallelism_;
  const std::size_t max_running_;
  const std::size_t queue_size_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  std::vector<std::optional<Running>> running_;  ///< one a thread, so that starting a job takes no memory
  std::size_t running_count_ = 0;
  /// The time that a thread waits for, when a place may open; the maximum where none does.
  Clock::time_point watched_until_ = Clock::time_point::max();
  Ticket next_ticket_ = 1;
  bool stopping_ = false;
  std::atomic<std::size_t> busy_threads_{0};
  std::latch ready_;  ///< the threads have their arenas
  std::vector<std::thread> threads_;
};

}  // namespace remesh::server
