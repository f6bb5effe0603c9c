/// How near a surface comes to itself: the distance to the nearest facet that is not a neighbour.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "core/base/run_control.h"
#include "core/geometry/frame.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Answers, for places on the surface, how far the nearest other patch is - across a thin wall, a slot, a shell.
///
/// What counts is what a place faces: the way there leaves its plane at more than 51 degrees. So the next facets but
/// one around a round hole are no gap, the opposite ones are.
///
/// A patch that is joined to this one counts only where the way through the air is much shorter than the way over the
/// surface: less than a third of the shortest way through a vertex or edge that the two share, straight on both sides
/// of it. Of each triangle of the other patch its nearest point is the one that is tested: a further one can only count
/// where the ways are within 6 % of that third. (From there the way through the air grows at a right angle or more, the
/// way over the surface at most as fast: 3 becomes 8^(1/2) at best.) So two faces that meet at an edge see each other
/// below 37 degrees, and above 39 degrees never. Nor is a triangle faced whose nearest point is not: seen aslant, what
/// is a gap depends on the triangles.
///
/// A closed, consistently wound surface hides what is beyond itself: a way that leaves it inwards and comes back to it
/// from outside meets it between. So the two treads of a shallow step are no gap, though the riser is low.
///
/// What is within the plane tolerance touches; there is no gap there. Places on the same patch are never a gap.
/// Source: rules.md, Gaps.
class GapSearch {
 public:
  /// Builds a tree of boxes over the patches' triangles. Surface, adjacency and patches must outlive this.
  /// Input:  the plane tolerance in model units; `meshes`, one a patch and not yet refined, or none at all: a patch
  ///         without one is taken by its input faces, which are the same places, but may be a great many.
  GapSearch(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, double plane_tolerance,
            RunControl& control, std::span<const PatchMesh> meshes = {});
  ~GapSearch();

  /// The gap at a place of that patch, model units; infinity if it is not less than `limit`.
  /// Input:  a triangle of the patch: those that cross it, or touch it but where they are joined to it, do not count:
  ///         gaps to these have no smallest one.
  /// Cost:   O(log n) and what is faced about as far as the answer: in a sphere a whole circle, n^(1/2) triangles.
  double at(const Vec3& place, PatchId patch, double limit, const Triangle* on = nullptr) const;

  /// The same without the patches that cross or touch this one anywhere.
  /// Input:  these patches, ascending.
  double at(const Vec3& place, PatchId patch, double limit, std::span<const PatchId> crossing) const;

  /// The same, but for all that would count if it were faced: what another place near this one may face.
  double nearest(const Vec3& place, PatchId patch, double limit, const Triangle* on = nullptr) const;

  /// How near other patches are that some place of these pieces of the patch may face, and that share no vertex with
  /// it: no more than the gaps there, and less where what is near is only beside them. Triangles that touch a piece, or
  /// that the surface hides from it by the shortest way, are left out. Infinity if none is below `limit`.
  /// Input:  triangles in the patch, in local units; the limit and the answer are in model units.
  /// Cost:   as `at`, and a few distances between triangles for each piece.
  double beside(std::span<const std::array<Vec3, 3>> pieces, PatchId patch, double limit) const;

  /// The smallest gap of the whole surface; empty if there is none. Between patches that share no vertex it is exact,
  /// pairs of triangles that touch or cross left out; between those that do, it is looked for at the corners where
  /// three to sixteen patches meet, at most some 64 of each patch. (A wedge has no smallest gap, but it has ends.)
  /// Input:  meshes given to the constructor, or few faces a patch: else it may take as long as n^1.5.
  /// Holds:  the same for any number of threads.
  std::optional<double> smallest(RunControl& control) const;

  /// The triangles that are searched: the same surface for whoever walks over it. The axes are those of the mesh's
  /// frame; without one, they lie along the patch's longest edge.
  std::size_t patch_count() const;
  std::span<const Triangle> triangles_of(PatchId patch) const;
  const Axes& axes_of(PatchId patch) const;

 private:
  class Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace remesh
