/// Triangles that refinement has left below its bounds, and why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace remesh {

/// Why a triangle does not meet the bounds that refinement aims at.
enum class UnrefinedReason : std::uint8_t {
  kInputAngle,        ///< it fills a corner of the input: both its edges there are of the patch's boundary
  kAcrossInputAngle,  ///< its shortest edge joins two segments that meet under 60 degrees, as far from there on both
  kSizeFloor,         ///< a point that would mend it, or a size that it misses, is below the floor or below rounding
  kMinEdgeLength,     ///< the same for the option's floor
  kBudget,            ///< the result would have more faces than allowed
  kBoundaryLocked,    ///< a boundary would have to be split that must stay: as asked, or for a patch that stays
  kEffort,            ///< the work that is in proportion was spent before the bounds were met
  kOutputRounding,    ///< it met the bounds until its vertices were rounded to what the output format can hold
};
inline constexpr int kUnrefinedReasonCount = 8;

/// Triangles that refinement has left below its bounds. `places` holds the centroids of the first 100.
struct Unrefined {
  static constexpr std::size_t kMaxPlaces = 100;

  UnrefinedReason reason = UnrefinedReason::kInputAngle;
  std::uint64_t count = 0;
  std::vector<Vec3> places;

  void add(const Vec3& place) {
    ++count;
    if (places.size() < kMaxPlaces) places.push_back(place);
  }
};

/// The stable name.
std::string_view unrefined_name(UnrefinedReason reason);

}  // namespace remesh
