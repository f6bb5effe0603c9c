/// Estimates how many faces a refinement will make before it is done.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/patches/triangulated_patches.h"
#include "core/refinement/goals.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"

namespace remesh {

struct Prediction {
  /// This is the number of faces to expect. It is mostly right within a factor of 1.5, and nearly always within 3; see
  /// experiments.md, Prediction, for the shares. (For fans of needles, and for facets whose neighbours are cut again
  /// and again at a bound of 30 degrees, there is no cheap tight estimate.)
  double expected = 0;
  /// This is each patch's share in that, which is at least 1. It leaves out what the patch makes of cuts that other
  /// patches need.
  std::vector<float> of_patch;
};

/// A result with more faces cannot be made, because half-edges are numbered in 31 bits.
inline constexpr std::uint64_t kMaxFaces = std::uint64_t{1} << 29;

/// Input: Triangulated patches over the vertices that stay.
/// Cost:  O(n), or O(n log n) if sizes vary.
Prediction predict(const TriangulatedPatches& triangulated, const Goals& goals, const SizeField& sizes,
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
