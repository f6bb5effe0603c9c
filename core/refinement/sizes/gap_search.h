/// Measures how near a surface comes to itself: the distance to the nearest facet that is not a neighbour.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/base/run_control.h"
#include "core/base/work_bound.h"
#include "core/geometry/planes/frame.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

struct TriangulatedPatches;

/// Answers, for places on the surface, how far away the nearest other patch is - across a thin wall, a slot, a shell.
///
/// Only patches that the place faces count. It faces them if the straight way to them leaves the plane of its own patch
/// at more than 51 degrees. So in a round hole there is no gap between a facet and the neighbours of its neighbours,
/// but there is one between opposite facets.
///
/// A patch that is joined to the place's patch counts only if the way through the air is much shorter than the way over
/// the surface. It has to be shorter than a third of the shortest way that crosses a vertex or edge which the two
/// patches share, straight on both sides of it. Of each triangle of the other patch, only the nearest point is tested.
/// A farther point could count only where the ways are within 6 % of that third. (From the nearest point on, the way
/// through the air grows at a right angle or more, and the way over the surface at most as fast: 3 becomes 8^(1/2) at
/// best.) So two faces that meet at an edge see each other below 37 degrees, and never above 39 degrees. A triangle is
/// not faced either if its nearest point is not: for a triangle that is seen aslant, the gap depends on how the surface
/// is divided into triangles.
///
/// The other side of a wedge does not count either. A wedge is formed by the two sides of an edge at which patches meet
/// at less than 60 degrees, whatever the number of patches on each side (Wedges).
///
/// Patches that cross or touch each other anywhere in the input are no gap for each other. Beside their common line,
/// there would be no smallest gap.
///
/// A closed, consistently wound surface hides places beyond itself: a way that leaves it inwards and comes back to it
/// from outside meets it in between. So there is no gap between the two treads of a shallow step, though the riser is
/// low.
///
/// Where two patches are within the plane tolerance of each other, they touch, so there is no gap. There is never a gap
/// between two places on the same patch.
///
/// If narrow gaps do not count, a side of the patch has no gap at all if the nearest point that the place faces there
/// has a height over the patch's plane below the smallest gap that counts. The height counts, because otherwise the
/// places beside a narrow gap would see its rim as a wider one.
///
/// The triangles of a curved patch are its facets. At a place of it, the tangent plane of its surface counts instead of
/// a plane of the patch, and the outside is that of the surface there.
/// Source: rules.md, Gaps.
class GapSearch {
 public:
  /// The rules that decide whether a patch counts as a gap.
  struct Rules {
    double min_gap = 0;             ///< narrower gaps do not count, except for the smallest one; model units
    double feature_angle_deg = 30;  ///< patches that turn by less are on the same side of a wedge
    /// The pairs of patches that cross or touch each other in the input, the smaller id first; sorted. They must
    /// outlive the search.
    std::span<const std::pair<PatchId, PatchId>> crossing = {};
  };

  /// Builds a tree of boxes over the patches' triangles. `surface`, `adjacency`, `patches` and the charts in
  /// `triangulated` must outlive this object.
  /// Input: The plane tolerance is in model units. `triangulated` has the patches before they are refined; it may be
  ///        null. The input faces of a patch are used if it has no mesh; they cover the same places, but there may be
  ///        very many of them.
  GapSearch(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, double plane_tolerance,
            RunControl& control, const TriangulatedPatches* triangulated, const Rules& rules);
  GapSearch(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, double plane_tolerance,
            RunControl& control, const TriangulatedPatches* triangulated = nullptr)
      : GapSearch(surface, adjacency, patches, plane_tolerance, control, triangulated, Rules()) {}
  ~GapSearch();

  /// Returns the gap at a place of that patch in model units, or infinity if it is not less than `limit`. This search
  /// and the three that follow end early if the bound on their work is spent. Their answer may then be too large.
  /// Input: `on` is a triangle of the patch. Triangles that cross it do not count, and neither do those that touch it
  ///        other than where they are joined to it, because there is no smallest gap to these.
  /// Cost: O(log n), and the number of faced triangles at about the same distance as the answer. In a sphere these are
  ///       a whole circle, n^(1/2) triangles.
  double at(const Vec3& place, PatchId patch, double limit, const Triangle* on = nullptr,
            WorkBound* work = nullptr) const;

  /// Returns the gap at a place as above.
  /// Input: The search ends as soon as it has found a point that is at most `enough` away, in model units, and returns
  ///        its distance, whether or not another point is nearer. Where a surface is near itself everywhere, this saves
  ///        most of the search. If narrow gaps do not count, the search continues.
  double at(const Vec3& place, PatchId patch, double limit, WorkBound* work, double enough) const;

  /// Returns the distance to the nearest patch as `at` does, but also counts patches that the place does not face.
  /// Another place near this one may face them.
  double nearest(const Vec3& place, PatchId patch, double limit, const Triangle* on = nullptr,
                 WorkBound* work = nullptr) const;

  /// Returns the distance to the nearest patch that shares no vertex with this one and that some place of these pieces
  /// of the patch may face. The result is at most the smallest gap to such patches at these places. It is smaller if
  /// the near patch lies only beside the pieces. Triangles are left out that touch a piece, or that the surface hides
  /// from it on the shortest way. The result is infinity if nothing is nearer than `limit`.
  /// Input: The pieces are triangles in the patch, in local units. The limit and the result are in model units.
  /// Cost:  The same as for `at`, and a few distances between triangles for each piece.
  double beside(std::span<const std::array<Vec3, 3>> pieces, PatchId patch, double limit,
                WorkBound* work = nullptr) const;

  /// Returns the smallest gap of the whole surface, or nothing if there is none. Between patches that share no vertex
  /// it is exact; pairs of triangles that touch or cross are left out. Between patches that share a vertex, gaps are
  /// only searched at corners where three to sixteen patches meet, at no more than some 64 corners of each patch. (A
  /// wedge has no smallest gap, but it has ends.) The search has a bound on its work (kWorkOfSmallestGap), which only
  /// surfaces exceed that are near themselves nearly everywhere. Then the smallest gap is not known, and nothing is
  /// returned either.
  /// Input: The bound grows with the number of faces that the output may have.
  /// Holds: The result is the same for any number of threads. Between curved patches, the planes of their facets decide
  ///        what is steep.
  std::optional<double> smallest(RunControl& control, std::uint64_t max_output_faces = WorkBound::kNone) const;

  /// The following functions give the triangles that are searched. Other parts that walk over the surface use the same
  /// triangles. The axes of a patch are those of its chart. Without a chart, they lie along the patch's longest edge. A
  /// patch is curved if its chart is; without charts no patch is curved.
  std::size_t patch_count() const;
  std::span<const Triangle> triangles_of(PatchId patch) const;
  const Axes& axes_of(PatchId patch) const;
  bool is_curved(PatchId patch) const;

 private:
  class Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace remesh
