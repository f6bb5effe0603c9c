/// Measures of the triangles and edges at a node, for code that tests a change at the node.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/mending/details/detail_complex.h"
#include "core/mending/details/rules.h"

namespace remesh {

using Places = std::array<Vec3, 3>;

inline Places places_of(const PresentTriangle& t, const DetailComplex& complex) {
  return {complex.place(t.corners[0]), complex.place(t.corners[1]), complex.place(t.corners[2])};
}

/// Measures of a triangle.
struct TriangleShape {
  explicit TriangleShape(const Places& p) : twice_area(cross(p[1] - p[0], p[2] - p[0])) {
    for (int k = 0; k < 3; ++k) {
      length[k] = norm(p[(k + 1) % 3] - p[k]);
      if (length[k] > length[longest]) longest = k;
    }
    height = length[longest] > 0 ? norm(twice_area) / length[longest] : 0;
  }

  bool has_edge_below(double size) const { return std::min({length[0], length[1], length[2]}) < size; }

  Vec3 twice_area;
  std::array<double, 3> length{};  ///< of the edge that begins at each corner
  int longest = 0;
  double height = 0;  ///< over the longest edge
};

/// Returns whether a triangle may change in this way. A triangle that is a detail, and not noise, may not be turned
/// over; other triangles may turn by at most 60 degrees.
bool may_become(const TriangleShape& before, const TriangleShape& after, const DetailRules& rules);

/// The edge from a node to a neighbour, with facts from the triangles there.
struct Spoke {
  std::uint32_t to;
  std::uint32_t faces = 0;
  int balance = 0;  ///< faces that have the edge in one direction minus those that have it in the other
  bool is_crease = false;
  bool is_border = false;

  bool is_open() const { return faces == 1; }
};

/// Returns the edges from a node, ascending by `to`.
/// Input: all triangles that are present there.
std::vector<Spoke> spokes_of(std::uint32_t node, const std::vector<PresentTriangle>& triangles,
                             const DetailComplex& complex, const DetailRules& rules);

/// Returns the edge to a node, or null if there is none.
const Spoke* find_spoke(const std::vector<Spoke>& spokes, std::uint32_t to);

/// Returns the corner of a triangle that is neither of two nodes.
std::uint32_t third(const PresentTriangle& t, std::uint32_t a, std::uint32_t b);

/// Two faces at one edge lie on each other if they enclose less than about 8 degrees.
inline constexpr double kFoldedCosine = 0.99;

/// The triangles at a node, except those that have another node as well.
struct FacesAtEdge {
  std::uint32_t node, without;
  const std::vector<PresentTriangle>& at_node;
};

/// Returns whether triangles of both nodes have a common edge opposite to their node.
bool do_see_common_edge(const FacesAtEdge& a, const FacesAtEdge& b);

/// Returns whether two faces that are no details would lie on each other at the edge from `target` to `end`: one of
/// those at the edge between `end` and the node of `moved`, and one of those between `end` and the node of `kept`.
bool would_fold(const FacesAtEdge& moved, const FacesAtEdge& kept, std::uint32_t end, const Vec3& target,
                const DetailComplex& complex, const DetailRules& rules);

}  // namespace remesh
