/// The longest edge that is allowed at each place of the surface.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals.h"
#include "core/stages/patches.h"

namespace remesh {

/// Holds:  at(x) <= goals.max_edge_length; |at(x) - at(y)| <= slope |x - y|, where slope = gradation - 1 (two edges of
///         lengths h and gradation h that meet: their sizes are read one h apart); it reads the input, never the
///         growing mesh.
/// Cost:   at() is O(log n) as long as sizes vary slowly; constant where there is no proximity and no gradation.
class SizeField {
 public:
  /// The same size everywhere.
  explicit SizeField(double size = std::numeric_limits<double>::infinity()) : largest_(size) {}

  /// With goals.proximity > 0: samples the surface so densely that the gap is known everywhere (distance between
  /// samples in proportion to the size there), size = max(gap / proximity, floor), floor = max(goals.min_edge_length,
  /// 2^-12 of the box's diagonal, 10 plane tolerances).
  /// With goals.gradation > 0: the lengths of the segments between essential vertices are samples, too, so that sizes
  /// grade away from small features.
  /// Input:  `segments` as pairs of essential vertices.
  SizeField(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
            std::span<const std::array<VertexId, 2>> segments, const Goals& goals, double plane_tolerance,
            RunControl& control);

  /// Is it the same everywhere? Then `largest()` is all there is to know.
  bool is_uniform() const { return nodes_.empty(); }
  double largest() const { return largest_; }
  /// The size at a place, model units.
  double at(const Vec3& place) const;

 private:
  struct Node {};  // a tree of boxes over the samples, with the smallest size in each
  double largest_;
  double slope_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace remesh
