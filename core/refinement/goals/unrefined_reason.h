/// The reasons why triangles miss the bounds of refinement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace remesh {

/// The reason why a triangle does not meet the bounds at which refinement aims.
enum class UnrefinedReason : std::uint8_t {
  /// The triangle fills a corner of the input: both its edges there are on the patch's boundary.
  kInputAngle,
  /// Its shortest edge joins two segments that meet under 60 degrees, at the same distance from their corner.
  kAcrossInputAngle,
  /// A new point would be nearer to another point than features or rounding allow (the floor of its spacing). Or the
  /// triangle misses a size that is below the floor of all sizes. In the report, the floor may also be the one that
  /// keeps the number of faces in proportion to the input.
  kSizeFloor,
  /// As kSizeFloor, but the floor comes from the option min_edge_length.
  kMinEdgeLength,
  /// The result would have more faces than allowed.
  kBudget,
  /// A boundary would have to be split that must stay, because of an option or because a patch stays as it is.
  kBoundaryLocked,
  /// A limit on the work was reached before the bounds were met, or before it was known whether they are met.
  kEffort,
  /// The triangle met the bounds until its vertices were rounded to coordinates that the output format can hold.
  kOutputRounding,
  /// The triangle belongs to a free-form surface that was made coarser. The surface tolerance, or an edge that stays,
  /// allows no better triangle.
  kSurfaceTolerance,
};
inline constexpr int kUnrefinedReasonCount = 9;

/// The triangles that miss the bounds of refinement for one reason. `places` holds the centroids of the first 100.
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
