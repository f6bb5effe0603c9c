/// The threads that compute. A few threads take tasks from a bounded queue, which refuses more when it is full.
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

/// The expected effort of a task, judged by the size of its mesh.
enum class JobSize { kSmall, kLarge };

/// Tasks start in the order of their arrival, with two exceptions so that huge meshes cannot starve small ones:
/// - While every running task is either large or has run for more than `kLong`, one small task may start beyond
///   `max_running`. Once that one has run for so long too, another may start. At most `max_running` tasks run in this
///   way.
/// - The last quarter of the queue is reserved for small tasks.
class WorkerPool {
 public:
  static constexpr std::chrono::milliseconds kLong{1000};

  /// At most `max_running` tasks run at once, except as said above, each in a TBB arena of `workers` threads.
  /// `queue_size` more may wait.
  WorkerPool(int max_running, std::size_t queue_size, int workers);
  /// Waits for the tasks that run. Tasks that wait in the queue are dropped.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Ticket = std::uint64_t;
  /// Queues a task, which must not throw.
  /// Output: nothing if no thread is free and the queue is full.
  std::optional<Ticket> try_submit(std::function<void()> job, JobSize size = JobSize::kSmall);
  /// Removes a task from the queue.
  /// Output: false if the task has started.
  bool withdraw(Ticket ticket);

  /// True if `try_submit` would refuse a task of this size now.
  bool is_full(JobSize size = JobSize::kSmall) const;
  std::size_t running() const;
  std::size_t queued() const;
  /// The number of threads that are inside the arenas.
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

  /// The loop of one thread.
  /// Input: `place` - the index of this thread in `running_`.
  void work(std::size_t place, int workers);
  bool is_full_locked(JobSize size) const;
  bool may_start_locked(JobSize size) const;
  /// The next time at which a small task may become free to start although no task has ended; the maximum if there is
  /// no such time.
  Clock::time_point next_change_locked() const;
  /// Finds the first task in the queue that may start now.
  std::deque<Entry>::iterator next_locked();
  /// True if a waiting thread must wake, either to start a task or because a place opens earlier than it waits for.
  bool needs_thread_locked();
  std::optional<Entry> take_locked();

  /// All arenas together may use this many threads, even if the machine has fewer cores.
  const tbb::global_control parallelism_;
  const std::size_t max_running_;
  const std::size_t queue_size_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  /// One entry for each thread, so that starting a task allocates no memory.
  std::vector<std::optional<Running>> running_;
  std::size_t running_count_ = 0;
  /// The time until which one thread waits because a place may open then; the maximum if no thread does.
  Clock::time_point watched_until_ = Clock::time_point::max();
  Ticket next_ticket_ = 1;
  bool stopping_ = false;
  std::atomic<std::size_t> busy_threads_{0};
  std::latch ready_;  ///< released once all threads have their arenas
  std::vector<std::thread> threads_;
};

}  // namespace remesh::server
