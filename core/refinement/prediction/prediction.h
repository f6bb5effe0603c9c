/// Estimates how many faces a refinement will make before it is done.
///
/// There are two predictions, because there are two purposes:
/// - predict_roughly steers refinement: it shares out the faces allowed among patches, and tells which attempts are not
///   worth while. Each attempt makes one, so it has to take no time. Results depend on it, so it may only change where
///   results may change.
/// - predict_closely is what users are told. It is nearer to the result, but takes several times as long. It is made
///   once for each answer, and no result depends on it.
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
  /// This is the number of faces to expect.
  double expected = 0;
  /// This is each patch's share in that, which is at least 1.
  std::vector<float> of_patch;
};

/// A refined area has this number of faces per equilateral triangle of the size asked for. See experiments.md,
/// Prediction.
inline constexpr double kFacesPerIdeal = 1.45;

/// Returns the number of rows into which predictions divide a triangle to read sizes in it. There are fewer where a
/// look-up of a size takes long.
int rows_to_read(const SizeField& sizes);

/// A result with more faces cannot be made, because half-edges are numbered in 31 bits.
inline constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 29;

/// Predicts the faces of each patch from its own narrow places, and adds some for cuts that its neighbours need. The
/// shares of the patches leave these out. It does not know needles that may stay, nor that cuts lead to further cuts.
/// Input: Triangulated patches over the vertices that stay.
/// Cost:  O(n), or O(n log n) if sizes vary.
Prediction predict_roughly(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
                           RunControl& control);

/// Predicts the faces of all patches together. With a bound on angles and boundaries that may be cut, the lengths of
/// edges that the bound leads to are estimated first (EdgeSizes), and then the triangles that fit between them are
/// counted. Without, it is predict_roughly. It is mostly right within a factor of 1.5, and nearly always within 3; see
/// experiments.md, Prediction, for the shares. It is too high where patches stay as they are because their refinement
/// fails the check, which nobody can know before.
/// Input: Triangulated patches over the vertices that stay.
/// Holds: The numbers do not depend on the number of threads.
/// Cost:  O(n log n), some microseconds and 300 to 800 bytes for each triangle.
Prediction predict_closely(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
                           RunControl& control);

/// Computes a lower bound on the number of faces in any result. For each patch it is the largest of three numbers: its
/// triangles as they are, the triangles that the pieces of its boundary need, and its area over the area of the largest
/// triangle that is allowed. Near floors, triangles may stay larger than sizes ask for, and the bound allows for that.
/// Beside segments that are to stay as they are, only the area that is far enough from them counts, and only where very
/// many faces are asked for. The bound does not foresee that a refined patch may fail the check and stay as it was.
/// This may happen where the input intersects or touches itself.
/// Input: The limits of the patches' segments are set; cuts need not be planned yet. `is_frozen` marks the patches that
///        are not refined.
/// Cost:  O(n).
double least_faces(const TriangulatedPatches& triangulated, const IdVector<PatchId, std::uint8_t>& is_frozen,
                   const SegmentTable& segments, const Goals& goals, const SizeField& sizes, RunControl& control);

}  // namespace remesh
