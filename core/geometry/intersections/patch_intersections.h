/// Finds intersecting faces of a surface whose patches are known to be flat and simple. If patches are large, this is
/// much faster than testing all faces against each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/intersections/search_limits.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A triangulated surface that is divided into patches.
struct PatchedFaces {
  std::span<const Vec3> positions;       ///< finite, pairwise different
  std::span<const VertexId> corners;     ///< three per face
  std::span<const PatchId> patch;        ///< one per face
  std::span<const Vec3> normals;         ///< the unit normal of each patch
  std::span<const std::uint8_t> simple;  ///< one per patch; 1: seen along its normal, the patch covers nothing twice

  std::size_t face_count() const { return patch.size(); }
  Triangle face(std::size_t f) const { return {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]}; }
};

/// Patches with at most this many faces are also tested for intersections inside, and all of their faces are tested,
/// because all of them are near the rim.
inline constexpr std::uint32_t kFewFaces = 16;

/// Finds the pairs of faces that intersect (`self_intersections`), except pairs within one large simple patch.
/// Output:  as self_intersections.
/// Holds:   no pair of faces of different patches is missed. A face is left out only if, for every other patch, no part
///          of the face is both in that patch's box and, by height over its plane, where that patch is. Simple patches
///          of few faces are tested inside, too.
/// Cost:    O(n) and, for the faces near other patches, the cost of self_intersections. If it takes more than 64 looks
///          at patches per face, on average, to find the faces near others, the cost of self_intersections for all
///          faces.
SelfIntersections patch_intersections(const PatchedFaces& surface, const SearchLimits& limits, RunControl& control);

}  // namespace remesh
