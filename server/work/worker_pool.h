/// The threads that compute. A few threads take tasks from a queue, which refuses more when it is full. The queue is
/// full when the waiting tasks mean too much work, not when there are many: hundreds of small tasks are done in a
/// moment.
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

#include "api/operations.h"
#include "server/http/connection.h"

namespace remesh::server {

/// Tasks start in the order of their arrival, with two exceptions so that huge meshes cannot starve small ones:
/// - While every running task is either large or has run for more than `kLong`, one small task may start beyond
///   `max_running`. Once that task has run for more than `kLong`, too, another one may start. At most `max_running`
///   tasks run in this way.
/// - Large and small tasks have separate limits in the queue.
class WorkerPool {
 public:
  static constexpr std::chrono::milliseconds kLong{1000};
  /// Tasks for bodies up to this size count as small: they have some ten thousand faces.
  static constexpr std::uint64_t kSmallBytes = 1 << 20;

  /// At most `max_running` tasks run at once, apart from the exceptions above, each in a TBB arena of `workers`
  /// threads.
  WorkerPool(int max_running, const api::QueueLimits& limits, int workers);
  /// Waits for the tasks that run. Tasks that wait in the queue are dropped.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Ticket = std::uint64_t;
  /// Queues a task, which must not throw.
  /// Input:  `bytes` - the size of its body, by which its effort is judged.
  /// Output: nothing if no thread is free and the queue is full.
  std::optional<Ticket> try_submit(std::function<void()> job, std::uint64_t bytes = 0);
  /// Removes a task from the queue.
  /// Output: false if the task has started.
  bool withdraw(Ticket ticket);

  /// True if `try_submit` would refuse a task of this size now.
  bool is_full(std::uint64_t bytes = 0) const;
  /// The time after which all tasks that wait now have probably started.
  std::chrono::milliseconds expected_wait() const;
  std::size_t running() const;
  std::size_t queued() const;
  /// The number of threads that are inside the arenas.
  std::size_t busy_threads() const { return busy_threads_; }

 private:
  enum class TaskSize { kSmall, kLarge };
  struct Entry {
    Ticket ticket;
    std::uint64_t bytes;
    std::function<void()> job;
  };
  struct Running {
    TaskSize size;
    Clock::time_point start;
  };
  /// The tasks of one size.
  struct Class {
    std::size_t queued = 0;
    std::uint64_t queued_bytes = 0;
    std::chrono::duration<double> usual_time{0};  ///< a moving average over the tasks that have ended
  };
  class BusyThreads;

  /// The loop of one thread.
  /// Input: `place` - the index of this thread in `running_`.
  void work(std::size_t place, int workers);
  static TaskSize size_of(std::uint64_t bytes) { return bytes <= kSmallBytes ? TaskSize::kSmall : TaskSize::kLarge; }
  Class& class_of(std::uint64_t bytes) { return size_of(bytes) == TaskSize::kSmall ? small_ : large_; }
  bool is_full_locked(std::uint64_t bytes) const;
  /// The time that the waiting tasks of one size need from all threads together, if each task takes `time`.
  std::chrono::duration<double> time_for_locked(const Class& tasks, std::chrono::duration<double> time) const;
  /// Takes an entry out of the queue.
  Entry remove_locked(std::deque<Entry>::iterator entry);
  bool may_start_locked(TaskSize size) const;
  /// The next time at which a small task may become free to start although no task has ended; the maximum if there is
  /// no such time.
  Clock::time_point next_change_locked() const;
  /// Finds the first task in the queue that may start now.
  std::deque<Entry>::iterator next_locked();
  /// True if a waiting thread must wake, either to start a task or because a place becomes free earlier than the thread
  /// expects.
  bool needs_thread_locked();
  std::optional<Entry> take_locked();

  /// All arenas together may use this many threads, even if the machine has fewer cores.
  const tbb::global_control parallelism_;
  const std::size_t max_running_;
  const api::QueueLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  Class small_, large_;
  /// One entry for each thread, so that starting a task allocates no memory.
  std::vector<std::optional<Running>> running_;
  std::size_t running_count_ = 0;
  /// The time until which one thread waits because a place may become free then; the maximum if no thread waits for
  /// this.
  Clock::time_point watched_until_ = Clock::time_point::max();
  Ticket next_ticket_ = 1;
  bool stopping_ = false;
  bool is_calling_ = false;  ///< one thread lets TBB's threads return free memory
  std::atomic<std::size_t> busy_threads_{0};
  std::latch ready_;  ///< released once all threads have their arenas
  std::vector<std::thread> threads_;
};

}  // namespace remesh::server
