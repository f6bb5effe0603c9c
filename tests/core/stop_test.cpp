// Tests that a run stops soon at any moment, on surfaces that make single steps of the pipeline as long as possible.

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "core/remesh.h"
#include "tests/support/hostile.h"
#include "tests/support/random.h"
#include "tests/support/sanitizer.h"

namespace remesh {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// Cancels a run `stop_after` its beginning, and returns how long it then takes to end. Returns nothing if the run ends
/// before.
std::optional<Seconds> time_to_stop(const hostile::Case& hostile, Seconds stop_after) {
  RunControl control;
  std::mutex mutex;
  std::condition_variable has_ended;
  bool is_over = false;
  Clock::time_point asked;
  std::thread watcher([&] {
    std::unique_lock lock(mutex);
    if (has_ended.wait_for(lock, stop_after, [&] { return is_over; })) return;
    asked = Clock::now();
    control.cancel();
  });
  bool is_stopped = false;
  try {
    remesh_surface(hostile.mesh, hostile.options, {2, true}, control);
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled) << hostile.name << ": " << error.what();
    is_stopped = error.code == Code::kCancelled;
  }
  const Clock::time_point ended = Clock::now();
  {
    const std::lock_guard lock(mutex);
    is_over = true;
  }
  has_ended.notify_all();
  watcher.join();
  if (!is_stopped) return std::nullopt;
  return ended - asked;
}

TEST(stops, they_are_obeyed_soon_whatever_the_surface) {
  Random random(base_seed(11));
  int stopped = 0;
  for (const hostile::Case& hostile : hostile::cases(unless_sanitized(100'000, 10'000)))
    for (int i = 0; i < 2; ++i) {
      constexpr double kLongest = 0.25;
      const auto took = time_to_stop(hostile, Seconds(kLongest * random.unit() * random.unit()));
      if (!took) continue;
      ++stopped;
      // The promise is 0.2 s on a quiet machine. The margin is for slow builds and busy machines.
      EXPECT_LT(took->count(), 1.0) << hostile.name;
    }
  EXPECT_GT(stopped, 10);
}

}  // namespace
}  // namespace remesh
