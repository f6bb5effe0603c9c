/// Bounds on how long something takes. Every assertion of a C++ test on time goes through this header.
///
/// A test must pass on a machine that is slow or busy, so what must be fast is held by time of the processor, which
/// other programs do not lengthen (`expect_within`, `processor_time`). Where it may be too much once by accident, the
/// least of ten attempts counts (`expect_best_within`). Elapsed time is compared only with what the same test has
/// measured, or where a fault makes the work wait for something else, such as a time limit, which takes half a minute
/// longer (`expect_sooner_than`).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <concepts>
#include <ctime>
#include <string>

#include "tests/support/sanitizer.h"

namespace remesh::test {

using Seconds = std::chrono::duration<double>;

/// The factor by which bounds on computations are longer in this build, because code without optimisation or with a
/// sanitizer is several times slower.
#ifdef NDEBUG
constexpr double kSlowdown = kIsSanitized ? 20 : 1;
#else
constexpr double kSlowdown = kIsSanitized ? 20 : 10;
#endif

/// Expects that something took less than `bound`, which is the same in every build. Elapsed time is compared only with
/// the time for which a fault would wait. The failure is reported at the caller's line.
inline void expect_sooner_than(Seconds bound, Seconds took, const std::string& what = {},
                               const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (took < bound) return;
  ADD_FAILURE_AT(file, line) << "it took " << took.count() << " s; the bound is " << bound.count() << " s " << what;
}

/// Returns the time that all threads of this program have spent on processors.
inline Seconds processor_time() { return Seconds(static_cast<double>(std::clock()) / CLOCKS_PER_SEC); }

/// Expects that something took less than `bound` of the processor's time.
inline void expect_within(Seconds bound, Seconds took, const std::string& what = {},
                          const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  expect_sooner_than(kSlowdown * bound, took, what, file, line);
}

/// Does some work and expects that it takes less than `bound` of the processor's time, summed over all threads.
template <std::invocable Work>
void expect_within(Seconds bound, Work&& work, const std::string& what = {}, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
  const Seconds start = processor_time();
  work();
  expect_within(bound, processor_time() - start, what, file, line);
}

/// Expects that the shortest of at most ten attempts takes less than `bound`. It stops at the first one that does.
/// Input:  `attempt` returns the time that it took: the processor's, unless the bound was measured in the same test.
template <std::invocable Attempt>
void expect_best_within(Seconds bound, Attempt&& attempt, const std::string& what = {},
                        const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  Seconds best = attempt();
  for (int more = 9; more > 0 && best >= kSlowdown * bound; --more) best = std::min<Seconds>(best, attempt());
  expect_within(bound, best, what, file, line);
}

}  // namespace remesh::test
