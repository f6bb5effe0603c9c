/// Bounds on how long something takes. Every assertion of a C++ test on elapsed time goes through this header.
///
/// Other tests run at the same time, so that work may take several times as long as on an idle machine. A bound is safe
/// for one of these reasons, and the test says which one it is:
/// - It is many times what the work takes on an idle machine (`expect_within`).
/// - The work is tried up to ten times, and the shortest time counts (`expect_best_within`).
/// - A fault makes the work wait for something, such as a time limit, which takes far longer (`expect_sooner_than`).
/// - It is measured in time of the processor, which other programs do not lengthen (`processor_time`).
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

/// Expects that something took less than `bound`, which is the same in every build. The failure is reported at the
/// caller's line.
inline void expect_sooner_than(Seconds bound, Seconds took, const std::string& what = {},
                               const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (took < bound) return;
  ADD_FAILURE_AT(file, line) << "it took " << took.count() << " s; the bound is " << bound.count() << " s " << what;
}

/// Expects that something took less than `bound`.
inline void expect_within(Seconds bound, Seconds took, const std::string& what = {},
                          const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  expect_sooner_than(kSlowdown * bound, took, what, file, line);
}

/// Does some work and expects that it takes less than `bound`.
template <std::invocable Work>
void expect_within(Seconds bound, Work&& work, const std::string& what = {}, const char* file = __builtin_FILE(),
                   int line = __builtin_LINE()) {
  const auto start = std::chrono::steady_clock::now();
  work();
  expect_within(bound, std::chrono::steady_clock::now() - start, what, file, line);
}

/// Expects that the shortest of at most ten attempts takes less than `bound`. It stops at the first one that does.
/// Input:  `attempt` returns the time that it took.
template <std::invocable Attempt>
void expect_best_within(Seconds bound, Attempt&& attempt, const std::string& what = {},
                        const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  Seconds best = attempt();
  for (int more = 9; more > 0 && best >= kSlowdown * bound; --more) best = std::min<Seconds>(best, attempt());
  expect_within(bound, best, what, file, line);
}

/// Returns the time that all threads of this program have spent on processors.
inline Seconds processor_time() { return Seconds(static_cast<double>(std::clock()) / CLOCKS_PER_SEC); }

}  // namespace remesh::test
