/// The independent check of the promises. It shares no decision with the stages. It has its own edges and its own exact
/// arithmetic, and takes nothing but the claim from the pipeline. Three tools are shared: the search for intersections
/// (patch_intersections); boxes and distances (BoxTree, nearest_on_triangle), which are used for faces that lie folded
/// over their patch and for gaps; and the triangles of polygons (split_polygon), which are used for gaps.
#pragma once

#include <memory>

#include "core/base/run_control.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verdict.h"

namespace remesh {

/// Tests the promises 1 to 3 of README.md.
/// Output:  a verdict. `failed_patches` lists every patch on which a test failed. Each flag is true if the following
///          holds:
///
/// `surface`:
/// - Every output vertex is a surface vertex bit for bit. If new vertices are claimed, it may also be new: then it is
///   inside a patch and as near to its plane as the patch's input is, or on an edge between vertices that stay, to
///   rounding. If it is claimed to be a vertex that was moved, it is as near to that vertex as a curved patch there
///   allows, and keeps to the planes there.
/// - Input and output lie within plane_tolerance of each other, in both directions, patch by patch.
/// - Every patch retains its boundary loops: each output loop is the input loop without some vertices, each of which
///   is within the tolerance of the span that replaces it.
/// - Where a patch is curved, `plane_tolerance` is replaced by the claimed tolerance plus `plane_tolerance`. Both sides
///   of the patch lie that close to the claimed surface, look the same way as it does, and cover it equally often
///   (curved_patch.h). How far they are apart is explained by the turns between the input's facets and by the options
///   (explained_distance.h). A boundary chain with a curved patch beside it may have new vertices anywhere within the
///   claimed tolerance. A plane beside it still keeps its plane exactly.
/// - Euler number, closedness, area and volume change by no more than the deviations explain. `volume_bound` is that
///   bound for the volume. For each patch it is the larger of its input and output area, plus the area between the
///   loops, times the largest difference of their heights; rounding is added.
/// - The faces that were made of an input polygon cover it once, if the polygon does not cross itself.
/// - The faces that were made to close holes fill these and nothing else (verify/polygons/caps.h).
///
/// `conforming`:
/// - Every output edge has the same faces in the same directions as the input's edges under it.
/// - There is no zero-area or inverted triangle except the input's own, no repeated face, no new non-manifold edge,
///   and no T-junction.
/// - Faces intersect (patch_intersections.h) only where their patches do in the input. If the input's
///   intersections are all known, this is tested for all faces, however many intersections there are. If the search in
///   the input was cut short, it is not tested, because any intersection of the output may be one of the input;
///   `are_all_intersections_known` is false then.
///
/// `delaunay`:
/// - The stored plane coordinates are the projections of the vertices. This and the next are tested for planes.
/// - Every edge inside a patch is locally Delaunay in these coordinates by exact arithmetic, or the edge that would
///   replace it exists elsewhere in the output (the chord rule).
///
/// `quality` (only with refinement):
/// - The faces that do not meet the goals, measured on the output's doubles, are exactly those in
///   `refinement->unrefined`.
/// - A face that is in that list because of an input angle is at such an angle. For kInputAngle, the smallest angle is
///   at a surface vertex between two boundary edges of the patch, and the other two angles meet the bound. For
///   kAcrossInputAngle, the ends of the shortest edge lie on two boundary chains (of the patch, between vertices that
///   stay) that meet in a vertex; the ends are equally far from that vertex to 1e-9, and nearer to each other than to
///   it, which means an angle under 60 degrees. For kBoundaryLocked, boundaries are not to be split, or the patch or
///   one beside it is frozen.
/// - The sizes that gaps and short edges ask for are measured anew (verify/goals/varying_sizes.h).
/// - Edges that refinement made are at least min_edge_length long.
///
/// Holds:   the verdict does not depend on the number of threads.
/// Cost:    O(n log n).
Verdict verify(const Claim& claim, RunControl& control);

/// The check in two steps. The test for sizes that vary takes as long as all other tests, so the pipeline makes it only
/// for a result that has passed the first step.
class Verification {
 public:
  /// Tests all promises except the goals of refinement. Until finish(), `claim.refinement` need not list faces that
  /// miss the goals.
  /// Input: the claim must outlive this object.
  Verification(const Claim& claim, RunControl& control);
  ~Verification();
  Verification(const Verification&) = delete;
  Verification& operator=(const Verification&) = delete;

  /// Returns whether a test has failed so far.
  bool has_failed() const;
  /// Tests the goals, and returns the verdict. To be called once.
  Verdict finish();

 private:
  class Tests;
  std::unique_ptr<Tests> tests_;
};

}  // namespace remesh
