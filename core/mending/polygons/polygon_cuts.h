/// Cuts polygons into triangles in such a way that no cut joins sheets that the surface keeps apart.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/mending/polygons/polygon_split.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The edges of the faces of a surface, and those that cuts have added. A cut along an existing edge would make one
/// edge with four faces out of two edges with two faces each.
/// Holds: the surface's faces must not change while this object exists. `cut` adds vertices to the surface.
class PolygonCuts {
 public:
  using Corners = std::array<VertexId, 3>;

  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  PolygonCuts(Surface& surface, RunControl& control);

  /// The triangles of a polygon that is not to stay whole.
  /// Input:  the polygon's loop, with no two consecutive corners equal, and how it splits.
  /// Output: triangles over the loop's vertices. If a cut is an edge already, a quadrilateral without a plane is cut
  ///         along its other diagonal, if that lies inside. Otherwise the cut gets a new vertex, at its middle if that
  ///         place is free.
  /// Cost:   O(k log n) for k corners.
  std::vector<Corners> cut(std::span<const VertexId> loop, const PolygonSplit& split);

  /// Returns whether two vertices are joined by an edge of a face other than f.
  bool is_of_others(VertexId a, VertexId b, FaceId f) const;

 private:
  using Edge = std::pair<VertexId, VertexId>;

  bool is_taken(VertexId a, VertexId b) const;
  bool is_free_place(const Vec3& p) const;
  std::optional<VertexId> vertex_on(VertexId a, VertexId b);

  Surface& surface_;
  Adjacency edges_;
  std::set<Edge> cuts_;
  std::vector<Vec3> places_;  ///< the places of the surface's vertices, sorted
  std::set<Vec3> new_places_;
};

}  // namespace remesh
