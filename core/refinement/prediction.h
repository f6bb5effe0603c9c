/// How many faces a refinement will make, before it is done.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/refinement/goals.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"

namespace remesh {

struct Prediction {
  /// What to expect: by sizes within some 30 %, by angles alone within a factor of two or so, along narrow strips too
  /// (fans of needles have no cheap tight estimate).
  double expected = 0;
  /// One per patch, at least 1: its share in that, but for what it makes of cuts that others need.
  std::vector<float> of_patch;
};

/// What has more faces cannot be made: half-edges are numbered in 31 bits.
inline constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 29;

/// Input:  triangulated patches over the vertices that stay.
/// Cost:   O(n), with sizes that vary O(n log n).
Prediction predict(const std::vector<PatchMesh>& meshes, const Goals& goals, const SizeField& sizes,
                   RunControl& control);

/// A lower bound on the number of faces in any result. For each patch it is the largest of three numbers: its triangles
/// as they are, what the pieces of its boundary take, and its area over the largest triangle that is allowed. Near
/// floors, triangles may stay larger than sizes ask for, and so they are taken here. Beside segments that are to stay
/// as they are, only what is far enough from them counts, and only where very many faces are asked for. It is not
/// foreseen that a refined patch fails the check, as may happen where the input intersects or touches itself, and
/// stays as it was.
/// Input:  the patches' segments, as they are limited; cuts need not be planned. `is_frozen`: the patches that are not
///         refined.
/// Cost:   O(n).
double least_faces(const std::vector<PatchMesh>& meshes, const std::vector<std::uint8_t>& is_frozen,
                   const SegmentTable& segments, const Goals& goals, const SizeField& sizes, RunControl& control);

}  // namespace remesh
