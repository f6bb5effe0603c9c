/// The state of a triangle with regard to the goals of refinement.
#pragma once

#include <cassert>
#include <cstdint>

#include "core/refinement/goals/unrefined_reason.h"

namespace remesh {

/// A triangle meets the goals, or it waits to be treated, or it misses a goal and stays for a reason.
class TriangleState {
 public:
  static constexpr TriangleState good() { return TriangleState(kGood); }
  /// The triangle meets the goals, and thinning out has tried the points around it since it was made.
  static constexpr TriangleState settled() { return TriangleState(kSettled); }
  static constexpr TriangleState waiting() { return TriangleState(kWaiting); }
  explicit constexpr TriangleState(UnrefinedReason why) : value_(static_cast<std::uint8_t>(why)) {}

  bool is_good() const { return value_ == kGood || value_ == kSettled; }
  bool is_settled() const { return value_ == kSettled; }
  bool is_waiting() const { return value_ == kWaiting; }
  /// The triangle must be one that stays.
  UnrefinedReason reason() const {
    assert(!is_good() && !is_waiting());
    return static_cast<UnrefinedReason>(value_);
  }

 private:
  static constexpr std::uint8_t kGood = 0xff, kWaiting = 0xfe, kSettled = 0xfd;
  explicit constexpr TriangleState(std::uint8_t value) : value_(value) {}

  std::uint8_t value_;
};

}  // namespace remesh
