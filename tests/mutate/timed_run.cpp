#include "tests/mutate/timed_run.h"

#include <pthread.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <thread>
#include <typeinfo>
#include <utility>

namespace remesh::mutate {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The state that the thread and its watcher share. It outlives a thread that never ends.
struct Shared {
  RunControl control;
  std::mutex mutex;
  std::condition_variable changed;
  bool is_over = false;
  Clock::time_point end;
  double end_thread_s = 0, end_process_s = 0;
  RunEnd result;
};

void run(const std::function<void(RunControl&)>& work, Shared& shared) {
  RunEnd result;
  try {
    work(shared.control);
  } catch (const Error& error) {
    result.ending = Ending::kRefused;
    result.error = error;
  } catch (const std::bad_alloc&) {
    result.ending = Ending::kOutOfMemory;
  } catch (const std::exception& other) {
    result.ending = Ending::kStrange;
    result.strange = std::string(typeid(other).name()) + ": " + other.what();
  } catch (...) {
    result.ending = Ending::kStrange;
    result.strange = "an exception of an unknown type";
  }
  const std::lock_guard lock(shared.mutex);
  shared.end = Clock::now();
  shared.end_thread_s = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  shared.end_process_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  shared.result = std::move(result);
  shared.is_over = true;
  shared.changed.notify_all();
}

/// Looks at the progress of a run now and then, and keeps the longest time for which it stood.
class ProgressWatch {
 public:
  ProgressWatch(const RunControl& control, std::thread& run)
      : control_(control),
        has_clock_(pthread_getcpuclockid(run.native_handle(), &clock_) == 0),
        start_(now()),
        seen_(look()),
        since_(start_) {}

  void look_again() {
    const Seen seen = look();
    if (seen == seen_) return;
    longest_ = longest_until_now();
    seen_ = seen;
    since_ = now();
  }
  Stand longest_until_now() const {
    const Times end = now();
    const double busy_s = std::max(0.0, end.busy_s - since_.busy_s);
    const Stand stand{since_.wall_s - start_.wall_s, end.wall_s - since_.wall_s, busy_s, seen_.first};
    // Other work on the machine lengthens the time on the wall.
    return stand.busy_s > longest_.busy_s ? stand : longest_;
  }

 private:
  struct Times {
    double wall_s = 0, busy_s = 0;
  };
  using Seen = std::pair<Stage, long>;

  Times now() const { return {seconds_of(CLOCK_MONOTONIC), has_clock_ ? seconds_of(clock_) : 0}; }
  Seen look() const { return {control_.stage(), std::lround(control_.fraction() * 1e6)}; }

  const RunControl& control_;
  clockid_t clock_{};
  bool has_clock_;
  Times start_;
  Seen seen_;
  Times since_;
  Stand longest_;
};

}  // namespace

RunEnd run_watched(const std::function<void(RunControl&)>& work, double stop_after_s, double patience_s, int workers) {
  const auto shared = std::make_shared<Shared>();
  const Clock::time_point start = Clock::now();
  const double start_process_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  std::thread thread([work, shared] { run(work, *shared); });
  ProgressWatch progress(shared->control, thread);
  std::unique_lock lock(shared->mutex);
  const auto is_over = [&] { return shared->is_over; };
  bool was_stopped = false;
  Stage stage = Stage::kQueued;
  Clock::time_point stop;
  double stop_thread_s = 0, stop_process_s = 0;
  const auto last_moment =
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(stop_after_s));
  constexpr auto kBetweenLooks = std::chrono::milliseconds(20);
  while (!is_over() && Clock::now() < last_moment) {
    shared->changed.wait_until(lock, std::min(Clock::now() + kBetweenLooks, last_moment), is_over);
    progress.look_again();
  }
  const Stand longest_stand = progress.longest_until_now();
  if (!is_over()) {
    was_stopped = true;
    clockid_t clock{};
    if (pthread_getcpuclockid(thread.native_handle(), &clock) == 0) stop_thread_s = seconds_of(clock);
    stop_process_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    stage = shared->control.stage();
    stop = Clock::now();
    shared->control.cancel();
    if (!shared->changed.wait_for(lock, std::chrono::duration<double>(patience_s), is_over)) {
      thread.detach();
      RunEnd never;
      never.ending = Ending::kNever;
      never.was_stopped = true;
      never.stage = stage;
      never.longest_stand = longest_stand;
      never.stop_wall_ms = never.stop_busy_ms = patience_s * 1e3;
      never.wall_s = stop_after_s + patience_s;
      never.busy_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - start_process_s;
      return never;
    }
  }
  lock.unlock();
  thread.join();
  RunEnd result = std::move(shared->result);
  result.wall_s = std::chrono::duration<double>(shared->end - start).count();
  result.busy_s = shared->end_process_s - start_process_s;
  result.was_stopped = was_stopped;
  result.stage = stage;
  result.longest_stand = longest_stand;
  if (was_stopped) {
    result.stop_wall_ms = std::chrono::duration<double, std::milli>(shared->end - stop).count();
    const double own_ms = 1e3 * (shared->end_thread_s - stop_thread_s);
    const double share_ms = 1e3 * (shared->end_process_s - stop_process_s) / std::max(workers, 1);
    result.stop_busy_ms = std::min(result.stop_wall_ms, std::max(own_ms, workers > 1 ? share_ms : 0));
  }
  return result;
}

}  // namespace remesh::mutate
