/// Finds the largest number that a test allows.
#pragma once

namespace remesh {

/// Returns the largest number up to `limit` for which `is_too_much` is false, with an error of at most limit / 2^40.
/// Input: a test that is false for 0. Once it is true, it stays true for all larger numbers.
template <class Test>
double largest_allowed(double limit, const Test& is_too_much) {
  constexpr int kSteps = 40;
  if (!is_too_much(limit)) return limit;
  double good = 0, bad = limit;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = 0.5 * (good + bad);
    (is_too_much(middle) ? bad : good) = middle;
  }
  return good;
}

}  // namespace remesh
