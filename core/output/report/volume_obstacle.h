/// Something that keeps a surface from bounding a volume.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/vec.h"

namespace remesh {

/// One kind of defect that keeps a surface from bounding a volume. `places` has one point for each of the first
/// 100 defects: the middle of the edge, of the face, or of the part where two faces cross or overlap.
struct VolumeObstacle {
  static constexpr std::size_t kMaxPlaces = 100;

  DiagnosticCode code = DiagnosticCode::kOpenBoundary;
  std::uint64_t count = 0;
  std::vector<Vec3> places;

  void add(const Vec3& place) {
    ++count;
    if (places.size() < kMaxPlaces) places.push_back(place);
  }
  /// Adds the obstacles of a later block.
  void add(const VolumeObstacle& other) {
    count += other.count;
    const std::size_t more = std::min(kMaxPlaces - places.size(), other.places.size());
    places.insert(places.end(), other.places.begin(), other.places.begin() + static_cast<std::ptrdiff_t>(more));
  }
};

}  // namespace remesh
