#include "tests/support/time_to_stop.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/base/error.h"

namespace remesh::test {

std::optional<Seconds> time_to_stop(Seconds stop_after, const std::function<void(RunControl&)>& run) {
  RunControl control;
  std::mutex mutex;
  std::condition_variable has_ended;
  bool is_over = false;
  Seconds asked{0};
  std::thread watcher([&] {
    std::unique_lock lock(mutex);
    if (has_ended.wait_for(lock, stop_after, [&] { return is_over; })) return;
    asked = processor_time();
    control.cancel();
  });
  bool is_stopped = false;
  try {
    run(control);
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled) << error.what();
    is_stopped = error.code == Code::kCancelled;
  }
  const Seconds ended = processor_time();
  {
    const std::lock_guard lock(mutex);
    is_over = true;
  }
  has_ended.notify_all();
  watcher.join();
  if (!is_stopped) return std::nullopt;
  return ended - asked;
}

}  // namespace remesh::test
