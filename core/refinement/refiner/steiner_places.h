/// Chooses the places of new points inside a patch.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/vec.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/triangle_judge.h"
#include "core/refinement/refiner/working_patch.h"
#include "core/triangulation/delaunay_mesh.h"

namespace remesh {

/// Finds places where a point mends a triangle, and compares them by the triangles that the point would make. Of the
/// mesh, it changes only the cavity that was found last.
/// Source: A. Üngör, Off-centers, 2004; S. Rebay, Efficient unstructured mesh generation by means of Delaunay
///         triangulation and Bowyer-Watson algorithm, 1993 (sizes).
class SteinerPlaces {
 public:
  /// Both objects must outlive this one.
  SteinerPlaces(const PatchSizes& sizes, WorkingPatch& patch)
      : sizes_(sizes), criteria_(sizes.criteria()), patch_(patch), mesh_(patch.mesh) {}

  /// Returns the place over the middle of the triangle's shortest edge where the new triangle at that edge just meets
  /// the bound and the size. If rounding prevents this, the coordinates are not finite.
  Vec2 off_centre(const TriangleJudge::Shape& shape) const;

  /// Returns the best of several places from an off-centre down towards the shortest edge. A lower place may serve the
  /// edge's neighbours too: along a straight chain of equal edges, one point serves three of them. The first place is
  /// taken with which the most edges of the off-centre's cavity make good triangles.
  Vec2 lowered(const DelaunayMesh::Cavity& of_off_centre, std::uint32_t shortest) const;

  /// Returns the place, among some about an off-centre and about the triangle, that leaves the fewest bad triangles.
  /// Among equals it is the one with the best shaped triangles. This matters beside a lattice whose edges have the max
  /// length: a point at the wrong place would make other edges too long, and their refinement would spread across the
  /// whole lattice.
  Vec2 best_for_size(Vec2 off_centre, std::uint32_t shortest);

 private:
  /// Describes the effect that a point would have on its cavity.
  struct InsertionOutcome {
    /// This is the number of new triangles that miss a bound, minus the number of old ones that did.
    int more_bad;
    double worst_shape;  ///< minimum of TriangleMeasures::shape over the new triangles
  };

  int count_good(std::span<const DelaunayMesh::RimEdge> rim, Vec2 p, int count_to_beat) const;
  bool is_encroaching(const DelaunayMesh::Cavity& cavity) const;
  InsertionOutcome outcome(const DelaunayMesh::Cavity& cavity, int max_more_bad) const;

  const PatchSizes& sizes_;
  const Criteria& criteria_;
  WorkingPatch& patch_;
  const DelaunayMesh& mesh_;
};

}  // namespace remesh
