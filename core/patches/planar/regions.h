/// Regions of one plane, and the rule by which faces belong to one.
#pragma once

#include <cstdint>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/geometry/planes/plane.h"

namespace remesh {

struct RegionTag {
  static constexpr char kPrefix = 'r';
};
using RegionId = Id<RegionTag>;

/// The regions found so far. Faces without a region are still to be grouped. If `of_face` is empty, that is all of
/// them.
struct Regions {
  FilledIdVector<FaceId, RegionId> of_face;
  FilledIdVector<RegionId, Plane> planes;
  FilledIdVector<RegionId, double>
      deviation;  ///< largest distance from the plane of any corner of the faces in the region
  /// Each region is connected over edges, like those that coplanar_regions makes.
  bool are_connected = false;
};

/// The rule by which faces belong to one plane or not. Tolerances are in local units.
struct CoplanarityRule {
  double plane_tolerance = 0;
  double normal_tolerance = 1e-6;
  /// One zone per face. Only faces in equal zones may share a region. Zones come from labels and from what the ladder
  /// separates. Empty: all faces are in one zone.
  const IdVector<FaceId, std::uint32_t>* zone = nullptr;
  /// One rung per face, 0 to kSingleFace (see face_rungs.h). Faces of patches that fail get higher rungs, where the
  /// tolerance is smaller. On the last rung each face is a region of its own.
  const IdVector<FaceId, std::uint8_t>* rung = nullptr;
  /// The step to which each coordinate is printed, if the tolerance comes from that; 0 if unknown.
  Vec3 printed_steps = {};
};

/// The last rung of the ladder. Each input face on it is a patch of its own.
inline constexpr std::uint8_t kSingleFace = 3;

}  // namespace remesh
