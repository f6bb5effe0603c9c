/// Describes triangles that miss the bounds of refinement, and the reasons why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace remesh {

/// Tells why a triangle does not meet the bounds that refinement aims at.
enum class UnrefinedReason : std::uint8_t {
  /// It fills a corner of the input: both its edges there are on the patch's boundary.
  kInputAngle,
  /// Its shortest edge joins two segments that meet under 60 degrees, at the same distance from their corner.
  kAcrossInputAngle,
  /// A new point would be nearer to another one than features or rounding allow (the floor of its spacing). Or it
  /// misses a size that is below the floor of all sizes. In the report, the floor may also be the one that keeps the
  /// number of faces in proportion to the input.
  kSizeFloor,
  /// As kSizeFloor, but the floor comes from the option min_edge_length.
  kMinEdgeLength,
  /// The result would have more faces than allowed.
  kBudget,
  /// A boundary would have to be split that must stay, because it was asked for or because a patch stays as it is.
  kBoundaryLocked,
  /// A limit on the work was reached before the bounds were met, or before it was known whether they are met.
  kEffort,
  /// It met the bounds until its vertices were rounded to what the output format can hold.
  kOutputRounding,
};
inline constexpr int kUnrefinedReasonCount = 8;

/// These are the triangles that miss the bounds of refinement for one reason. `places` holds the centroids of the first
/// 100.
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

/// Returns the stable name of a reason.
std::string_view unrefined_name(UnrefinedReason reason);

}  // namespace remesh
