/// Cuts polygons into triangles so that no cut joins sheets that the surface keeps apart.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/mending/polygon_split.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The edges that faces of a surface have, and those that cuts have added. A cut along one of them would make an edge
/// of four faces where two faces met twice.
/// Holds: the surface's faces do not change while this lives; cut adds vertices to it.
class PolygonCuts {
 public:
  using Corners = std::array<VertexId, 3>;

  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  PolygonCuts(Surface& surface, RunControl& control);

  /// The triangles of a polygon that is not to stay whole.
  /// Input:  its loop, no two consecutive corners equal, and how it splits.
  /// Output: triangles over the loop's vertices. Where a cut is taken, a quadrilateral without a plane takes the other
  ///         one, if that lies inside; else the cut gets a new vertex on it, in its middle if that place is free.
  /// Cost:   O(k log n) for k corners.
  std::vector<Corners> cut(std::span<const VertexId> loop, const PolygonSplit& split);

  /// Whether a face other than f has an edge between two vertices.
  bool is_of_others(VertexId a, VertexId b, FaceId f) const;

 private:
  using Edge = std::pair<VertexId, VertexId>;

  bool is_taken(VertexId a, VertexId b) const;
  bool is_free_place(const Vec3& p) const;
  std::optional<VertexId> vertex_on(VertexId a, VertexId b);

  Surface& surface_;
  Adjacency edges_;
  std::set<Edge> cuts_;
  std::vector<Vec3> places_;  ///< of the surface's vertices, sorted
  std::set<Vec3> new_places_;
};

}  // namespace remesh
