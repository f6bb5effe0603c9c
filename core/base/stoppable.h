/// Long serial work that can be cancelled.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "core/base/parallel.h"
#include "core/base/run_control.h"

namespace remesh {

/// Serial loops over the input call this once per item. It checks for cancellation once in `kCalls` calls, so that it
/// costs only a few instructions. If items cost up to a microsecond each, the loop stops within some ten milliseconds.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
class StopCheck {
 public:
  explicit StopCheck(const RunControl& control) : control_(control) {}
  void operator()() {
    if (--left_ != 0) return;
    left_ = kCalls;
    control_.check_and_move();
  }

 private:
  static constexpr std::uint32_t kCalls = 1 << 13;

  const RunControl& control_;
  std::uint32_t left_ = kCalls;
};

/// Sorts like std::sort, in parallel if there are many items, and stops when it is cancelled. Then the items are in no
/// order, and some may be missing. Sorting ten million items takes seconds, which is too long to wait.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
template <class Iterator, class Less = std::less<>>
void sort_stoppable(Iterator begin, Iterator end, const RunControl& control, const Less& less = {}) {
  constexpr std::ptrdiff_t kFew = 1 << 13;
  control.check();
  // A check reads one value that hardly ever changes. Most comparisons cost more.
  const auto stoppable = [&](const auto& a, const auto& b) {
    control.check_comparison();
    return less(a, b);
  };
  sort_all(begin, end, stoppable, kFew);
}

/// Sorts the items of a vector, and leaves one of those that are equal.
template <class Items>
void sort_unique(Items& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

/// Does the same for many items, and stops when it is cancelled, as sort_stoppable does.
template <class Items>
void sort_unique(Items& items, const RunControl& control) {
  sort_stoppable(items.begin(), items.end(), control);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace remesh
