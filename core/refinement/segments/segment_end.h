/// Names segments and their ends.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

#include "core/base/ids.h"

namespace remesh {

struct SegmentTag {
  static constexpr char kPrefix = 's';
};
using SegmentId = Id<SegmentTag>;

/// One of the two ends of a segment.
class SegmentEnd {
 public:
  constexpr SegmentEnd() = default;
  constexpr SegmentEnd(SegmentId segment, bool is_from) : index_(2 * segment.value + (is_from ? 0u : 1u)) {}
  /// Returns the end with that index.
  static constexpr SegmentEnd at(std::uint32_t index) { return SegmentEnd(index); }

  constexpr SegmentId segment() const { return SegmentId(index_ / 2); }
  /// Returns true for the end at which the parameter is 0.
  constexpr bool is_from() const { return index_ % 2 == 0; }
  constexpr SegmentEnd opposite() const { return SegmentEnd(index_ ^ 1u); }
  /// Returns the place in an array that has one entry for each end of all segments.
  constexpr std::uint32_t index() const { return index_; }
  /// Returns the place in an array that has one entry for each end of one segment.
  constexpr std::size_t place() const { return index_ % 2; }

  friend constexpr auto operator<=>(SegmentEnd, SegmentEnd) = default;

 private:
  constexpr explicit SegmentEnd(std::uint32_t index) : index_(index) {}

  std::uint32_t index_ = kNone;
};

}  // namespace remesh
