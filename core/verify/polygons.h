/// What became of the input's polygons, before anything was remeshed: the surface that the other tests take for the
/// input is one that was mended, and mending may be wrong.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"
#include "core/verify/model.h"
#include "core/verify/verification_faults.h"
#include "core/verify/verify.h"

namespace remesh::verification {

/// So many pairs of edges are compared in one check of a mesh. Each takes up to some 25 nanoseconds.
inline constexpr std::uint64_t kMaxEdgePairs = std::uint64_t{1} << 24;

/// Measures each polygon of more than three corners by its outline, as it was read, and holds against it the faces of
/// the surface that came of it. Together they must have the polygon's area vector; and if the polygon is flat once its
/// spikes are cut off, they must cover no more than its area, or some of them lie on each other. Both hold up to what
/// the tolerances move along the outline. Only an outline that is clearly simple in its plane, once its spikes are cut
/// off, says what triangles are right. One that crosses or touches itself, as along a bridge to a hole, is left out.
///
/// To know that an outline is simple, pairs of its edges are compared: those that are next to each other along that
/// axis of space along which the fewest are. A mesh has a budget of such pairs. The polygons in doubt get what they
/// need of it in the order of the file, and one that needs more than is left is left out.
/// Input:   a claim with an input, or without one, and then nothing is tested. Reports kPolygon.
/// Holds:   the findings depend neither on the number of threads nor on how long anything takes.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(corners of polygons), in parallel; for polygons in doubt, O(n log n) and at most `max_pairs` comparisons.
void check_polygons(const Claim& claim, const Model& model, Findings& findings, RunControl& control,
                    std::uint64_t max_pairs = kMaxEdgePairs);

}  // namespace remesh::verification
