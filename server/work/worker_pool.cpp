#include "server/work/worker_pool.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "server/observe/heap_tops.h"
#include "server/observe/niceness.h"

namespace remesh::server {
namespace {

/// The usual time of a task is a moving average in which each new task has the weight one over this number. The average
/// is long enough that a few tasks delayed by other programs do not make hundreds of waiting tasks look like too many.
constexpr double kAveraged = 32;
/// How often a thread without work checks whether it is asked to return free memory.
constexpr std::chrono::seconds kBetweenLooks{1};
/// How long a thread of TBB stays in an arena that has no other work. Meanwhile the other threads enter it, too.
constexpr std::chrono::milliseconds kStay{5};

/// Lets threads of TBB enter an arena and leave it, which is when they return free memory.
void call_all(tbb::task_arena& arena, int workers) noexcept {
  try {
    arena.execute([workers] {
      tbb::parallel_for(
          0, workers, [](int) { std::this_thread::sleep_for(kStay); }, tbb::simple_partitioner());
    });
  } catch (const std::exception&) {  // no memory for the tasks
  }
}

}  // namespace

/// Counts the threads that enter and leave an arena, lowers their priority, and lets them return free memory.
class WorkerPool::BusyThreads : public tbb::task_scheduler_observer {
 public:
  BusyThreads(tbb::task_arena& arena, std::atomic<std::size_t>& counter)
      : tbb::task_scheduler_observer(arena), counter_(counter) {
    observe(true);
  }
  ~BusyThreads() override { observe(false); }
  void on_scheduler_entry(bool) override {
    ++counter_;
    be_nice();
  }
  void on_scheduler_exit(bool) override {
    --counter_;
    HeapTops::return_if_asked();
  }

 private:
  std::atomic<std::size_t>& counter_;
};

WorkerPool::WorkerPool(int max_running, const api::QueueLimits& limits, int workers)
    : parallelism_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(workers)),
      max_running_(static_cast<std::size_t>(max_running)),
      limits_(limits),
      running_(2 * max_running_),
      ready_(static_cast<std::ptrdiff_t>(running_.size())) {
  for (std::size_t i = 0; i < running_.size(); ++i) threads_.emplace_back([this, i, workers] { work(i, workers); });
  ready_.wait();  // TBB's thread limit must not be set by one pool while threads of another one enter their arenas
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

std::optional<WorkerPool::Ticket> WorkerPool::try_submit(std::function<void()> job, std::uint64_t bytes) {
  Ticket ticket = 0;
  {
    const std::lock_guard lock(mutex_);
    if (stopping_ || is_full_locked(bytes)) return std::nullopt;
    ticket = next_ticket_++;
    queue_.push_back({ticket, bytes, std::move(job)});
    ++class_of(bytes).queued;
    class_of(bytes).queued_bytes += bytes;
    if (!needs_thread_locked()) return ticket;
  }
  changed_.notify_one();
  return ticket;
}

bool WorkerPool::withdraw(Ticket ticket) {
  const std::lock_guard lock(mutex_);
  const auto entry =
      std::find_if(queue_.begin(), queue_.end(), [&](const Entry& candidate) { return candidate.ticket == ticket; });
  if (entry == queue_.end()) return false;
  remove_locked(entry);
  return true;
}

bool WorkerPool::is_full(std::uint64_t bytes) const {
  const std::lock_guard lock(mutex_);
  return stopping_ || is_full_locked(bytes);
}

std::chrono::milliseconds WorkerPool::expected_wait() const {
  const std::lock_guard lock(mutex_);
  // A task that runs longer than usual shows that other tasks may, too.
  std::chrono::duration<double> small = small_.usual_time;
  std::chrono::duration<double> large = large_.usual_time;
  for (const std::optional<Running>& running : running_) {
    if (!running) continue;
    std::chrono::duration<double>& time = running->size == TaskSize::kSmall ? small : large;
    time = std::max<std::chrono::duration<double>>(time, Clock::now() - running->start);
  }
  return std::chrono::ceil<std::chrono::milliseconds>(time_for_locked(small_, small) + time_for_locked(large_, large));
}

std::chrono::duration<double> WorkerPool::time_for_locked(const Class& tasks,
                                                          std::chrono::duration<double> time) const {
  return time * static_cast<double>(tasks.queued) / static_cast<double>(max_running_);
}

std::size_t WorkerPool::running() const {
  const std::lock_guard lock(mutex_);
  return running_count_;
}

std::size_t WorkerPool::queued() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool WorkerPool::is_full_locked(std::uint64_t bytes) const {
  // Tasks that a free thread has not taken yet do not count as waiting.
  const std::size_t free = max_running_ - std::min(max_running_, running_count_);
  if (queue_.size() < free) return false;
  if (size_of(bytes) == TaskSize::kLarge) return large_.queued >= limits_.max_large + free;
  // One small task may always wait.
  return small_.queued > free && (small_.queued_bytes + bytes > limits_.max_small_bytes ||
                                  time_for_locked(small_, small_.usual_time) > limits_.max_small_wait);
}

WorkerPool::Entry WorkerPool::remove_locked(std::deque<Entry>::iterator entry) {
  Entry taken = std::move(*entry);
  queue_.erase(entry);
  --class_of(taken.bytes).queued;
  class_of(taken.bytes).queued_bytes -= taken.bytes;
  return taken;
}

bool WorkerPool::may_start_locked(TaskSize size) const {
  if (running_count_ < max_running_) return true;
  if (size == TaskSize::kLarge || running_count_ == running_.size()) return false;
  const Clock::time_point long_ago = Clock::now() - kLong;
  return std::all_of(running_.begin(), running_.end(), [&](const std::optional<Running>& running) {
    return !running || running->size == TaskSize::kLarge || running->start <= long_ago;
  });
}

Clock::time_point WorkerPool::next_change_locked() const {
  if (queue_.empty() || running_count_ == running_.size()) return Clock::time_point::max();
  Clock::time_point last = Clock::time_point::min();
  for (const std::optional<Running>& running : running_) {
    if (running && running->size == TaskSize::kSmall) last = std::max(last, running->start + kLong);
  }
  return last > Clock::now() ? last : Clock::time_point::max();
}

std::deque<WorkerPool::Entry>::iterator WorkerPool::next_locked() {
  return std::find_if(queue_.begin(), queue_.end(),
                      [this](const Entry& candidate) { return may_start_locked(size_of(candidate.bytes)); });
}

bool WorkerPool::needs_thread_locked() {
  return !queue_.empty() && (next_change_locked() < watched_until_ || next_locked() != queue_.end());
}

std::optional<WorkerPool::Entry> WorkerPool::take_locked() {
  const auto entry = next_locked();
  if (entry == queue_.end()) return std::nullopt;
  return remove_locked(entry);
}

void WorkerPool::work(std::size_t place, int workers) {
  // Each thread has an arena of its own. A huge mesh can take idle cores, but never the thread that a small one runs
  // on.
  tbb::task_arena arena(workers);
  const BusyThreads observer(arena, busy_threads_);
  ready_.count_down();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    std::optional<Entry> entry = take_locked();
    if (!entry) {
      const Clock::time_point until = next_change_locked();
      if (until < watched_until_) {
        watched_until_ = until;
        changed_.wait_until(lock, until);
        if (watched_until_ == until) watched_until_ = Clock::time_point::max();
      } else if (HeapTops::is_asked()) {
        // TBB's threads are not taken from running work. Of several threads without work, only one calls them.
        const bool may_call = running_count_ == 0 && !std::exchange(is_calling_, true);
        lock.unlock();
        if (may_call) call_all(arena, workers);
        HeapTops::return_if_asked();
        lock.lock();
        if (may_call) is_calling_ = false;
      } else {
        changed_.wait_for(lock, kBetweenLooks);
      }
      continue;
    }
    const std::uint64_t bytes = entry->bytes;
    const Clock::time_point start = Clock::now();
    running_[place] = Running{size_of(bytes), start};
    ++running_count_;
    if (needs_thread_locked()) changed_.notify_one();
    lock.unlock();
    arena.execute(entry->job);
    entry.reset();  // its captures are freed outside the lock
    lock.lock();
    std::chrono::duration<double>& usual = class_of(bytes).usual_time;
    usual += (Clock::now() - start - usual) / kAveraged;
    running_[place].reset();
    --running_count_;  // this thread starts the next task that may start now
  }
}

}  // namespace remesh::server
