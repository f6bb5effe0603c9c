/// Shares out the steps that patches may take above the bounds on their work.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/base/work_bound.h"

namespace remesh {

/// The steps of work that all patches together may still take beyond their own bounds (kWorkOfPatch).
/// Holds: how many extra steps a patch may take depends on the rounds before, and not on threads.
class ExtraWorkPool {
 public:
  /// Must be called before each round, with the number of its patches.
  void begin_round(std::size_t patches) {
    constexpr std::uint64_t kUneven = 4, kMin = 1 << 13;
    of_turn_ = left_ == 0 ? 0 : std::max(kMin, kUneven * left_ / std::max<std::size_t>(1, patches));
  }
  /// Returns the number of steps that each patch of the round may take. It is 0 as soon as no steps are left.
  std::uint64_t of_turn() const { return of_turn_; }
  /// Subtracts the steps that a patch has taken, after the round.
  void take(std::uint64_t steps) { left_ -= std::min(left_, steps); }

 private:
  std::uint64_t left_ = kWorkAboveBounds;
  std::uint64_t of_turn_ = 0;
};

}  // namespace remesh
