/// How near a surface comes to itself: the distance to the nearest facet that is not a neighbour.
#pragma once

#include <memory>
#include <optional>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/stages/patches.h"

namespace remesh {

/// Answers, for places on the surface, how far the nearest other patch is - across a thin wall, a slot, a shell -
/// where a patch that is joined to this one counts only if the way through the air is much shorter than the way over
/// the surface: less than a third of the shortest way through a vertex or edge that the two share. So dihedral angles
/// above some 37 degrees never count. Source: REFINEMENT, rule 9.
class GapSearch {
 public:
  /// Builds a tree of boxes over the input's faces. The arguments must outlive this.
  GapSearch(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, RunControl& control);
  ~GapSearch();

  /// The gap at a place of that patch, model units; infinity if there is nothing within `limit`.
  double at(const Vec3& place, PatchId patch, double limit) const;

  /// The smallest gap of the whole surface; empty if no two facets face each other so.
  std::optional<double> smallest(RunControl& control) const;

 private:
  class Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace remesh
