/// Holds the goals of refinement in the form that the inner loops test.
#pragma once

#include <cstdint>

#include "core/base/vec.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/triangle_measures.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// The sizes that the whole surface is asked to have.
enum class SizeGoal : std::uint8_t {
  kNone,     ///< any triangle is small enough
  kUniform,  ///< the same size, the same area or both everywhere
  kVarying,  ///< the size differs from place to place
};

/// The goals of one refinement. The object refers to the size field.
struct Criteria {
  Criteria(const Goals& goals, const SizeField& sizes);

  SizeGoal size_goal;
  /// The tangent of the bound on angles; 0 if there is none. The bound is a little above the goal, because angles are
  /// measured in space in the end.
  double tangent;
  /// An apex over a piece encroaches on it if the squared cosine of the (obtuse) angle there is larger than this.
  double lens;
  /// The height of an off-centre over the shortest edge, per length of that edge.
  double off_centre;
  bool are_lower_places_tried;  ///< places below an off-centre are tried too, and the best of them is taken
  /// True if all sides that are longer than the size are cut before any other change. Otherwise a triangle may still
  /// have a side that has to be cut for its length.
  bool are_long_sides_cut_first;
  double max_area;   ///< model units
  double even_size;  ///< edge of the triangles that fill wide areas; infinity: there are none
  double area_edge;  ///< no triangle with edges up to this length is larger than max_area
  double min_angle_deg;
  double min_edge_length;
  const SizeField& sizes;

  bool has_sizes() const { return size_goal != SizeGoal::kNone; }
  /// Returns whether, in the end, points are removed that the bounds do not need. With a bound on angles alone, hardly
  /// any point is superfluous.
  bool is_thinned() const { return has_sizes() || min_angle_deg == 0; }

  /// Returns whether a triangle has an angle below the bound.
  bool is_sharp(const TriangleMeasures& m) const {
    // The smallest angle is opposite the shortest edge. The product of the other two edges is 2 |u| |v| cos.
    return m.twice_area < tangent * (m.squares - 2 * m.shortest_squared) / 2;
  }
  /// Returns whether a point encroaches on the piece from a to b.
  bool is_encroached(Vec2 p, Vec2 a, Vec2 b) const {
    const Vec2 u = a - p, v = b - p;
    const double product = dot(u, v);
    return product < 0 && product * product > lens * dot(u, u) * dot(v, v);
  }
};

}  // namespace remesh
