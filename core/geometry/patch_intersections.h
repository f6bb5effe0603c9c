/// Intersecting faces of a surface whose patches are known to be flat and simple: much faster than holding all faces
/// against each other where patches are large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/self_intersections.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A triangulated surface in patches.
struct PatchedFaces {
  std::span<const Vec3> positions;       ///< finite, pairwise different
  std::span<const VertexId> corners;     ///< three a face
  std::span<const PatchId> patch;        ///< of each face
  std::span<const Vec3> normals;         ///< unit, of each patch
  std::span<const std::uint8_t> simple;  ///< of each patch: 1 - it covers nothing twice, seen along its normal

  std::size_t face_count() const { return patch.size(); }
  Triangle face(std::size_t f) const { return {corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]}; }
};

/// Patches of at most so many faces are looked at inside, and held against each other as a whole: all of their faces
/// are near their rim.
inline constexpr std::uint32_t kFewFaces = 16;

/// Finds the pairs of faces that intersect (`self_intersections`), but for pairs within one large patch that is simple.
/// Output:  as self_intersections.
/// Holds:   nothing is missed between patches: a face is left out only if no face of another patch reaches into its
///          box and, in height over that other patch's plane, to where that patch is. Simple patches of few faces are
///          looked at inside, too.
/// Cost:    O(n) and, for the faces near other patches, as self_intersections; for all faces, where to find those that
///          are near takes more than 256 looks at patches for each on the average.
SelfIntersections patch_intersections(const PatchedFaces& surface, std::size_t max_pairs, RunControl& control);

}  // namespace remesh
