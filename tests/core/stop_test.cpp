// Tests that a run stops soon at any moment, on surfaces that make single steps of the pipeline as long as possible.

#include <gtest/gtest.h>

#include "core/remesh.h"
#include "tests/support/hostile.h"
#include "tests/support/random.h"
#include "tests/support/sanitizer.h"
#include "tests/support/time_limit.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

TEST(stops, they_are_obeyed_soon_whatever_the_surface) {
  Random random(base_seed(11));
  int stopped = 0;
  for (const hostile::Case& hostile : hostile::cases(unless_sanitized(100'000, 10'000)))
    for (int i = 0; i < 2; ++i) {
      constexpr double kLongest = 0.25;
      const test::Seconds stop_after(kLongest * random.unit() * random.unit());
      SCOPED_TRACE(hostile.name);
      const auto took = test::time_to_stop(stop_after, [&](RunControl& control) {
        remesh_surface(hostile.mesh, hostile.options, {2, true}, control);
      });
      if (!took) continue;
      ++stopped;
      // The promise is 0.2 s, which are 0.4 s of two threads.
      test::expect_within(test::Seconds(1), *took);
    }
  EXPECT_GT(stopped, 10);
}

}  // namespace
}  // namespace remesh
