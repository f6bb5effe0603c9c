/// Estimates, before a refinement, how many faces it will make.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

struct Prediction {
  /// The number of faces to expect.
  double expected = 0;
  /// Each patch's share in that number, at least 1.
  std::vector<float> of_patch;
};

/// A refined area has this number of faces per equilateral triangle of the size asked for. See experiments.md,
/// Prediction.
inline constexpr double kFacesPerIdeal = 1.45;

/// Returns the number of rows into which predictions divide a triangle to read sizes in it. If a look-up of a size is
/// slow, there are fewer rows.
int rows_to_read(const SizeField& sizes);

/// A result with more faces cannot be made, because half-edges are numbered in 31 bits.
inline constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 29;

/// Predicts the faces of each patch. The prediction steers refinement: it divides the allowed faces among patches, and
/// rules out attempts that are not worth their time. Each attempt calls it, so it has to be fast. Results depend on it.
/// Users see it where a surface is too large to be remeshed just to count its faces (see analyze_surface).
///
/// The faces of a patch follow from its own narrow places. Some are added for cuts that its neighbours need; the shares
/// of the patches leave these out. The prediction ignores that needles may stay and that cuts lead to further cuts.
/// Input: Triangulated patches over the vertices that stay.
/// Cost:  O(n), or O(n log n) if sizes vary.
Prediction predict_faces(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
                         RunControl& control);

/// Computes a lower bound on the number of faces in any result. For each patch it is the largest of three numbers: its
/// triangles as they are, the triangles that the pieces of its boundary need, and its area over the area of the largest
/// triangle that is allowed. Near floors, triangles may stay larger than sizes ask for, and the bound accounts for
/// that. Beside segments that are to stay as they are, only the area that is far enough from them counts, and only
/// where very many faces are asked for. The bound does not foresee that a refined patch may fail the check and stay as
/// it was. This may happen where the input intersects or touches itself.
/// Input: The limits of the patches' segments are set; cuts need not be planned yet. `is_frozen` marks the patches that
///        are not refined.
/// Cost:  O(n).
double least_faces(const TriangulatedPatches& triangulated, const IdVector<PatchId, std::uint8_t>& is_frozen,
                   const SegmentTable& segments, const Goals& goals, const SizeField& sizes, RunControl& control);

}  // namespace remesh
