/// The map by which a surface becomes one without small details.
#pragma once

#include <array>
#include <vector>

#include "core/base/ids.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Maps each triangle of a surface onto a triangle, an edge or a vertex of another surface. First, some triangles are
/// cut into pieces, by points on edges. Then each corner gets a place, and a piece goes linearly to where its corners
/// go. So no point of a piece moves farther than one of its corners does. Where every triangle of the other surface is
/// the image of a piece, the two surfaces are no farther apart than the corners move, in both directions.
///
/// A part of the surface that is connected with nothing else may be removed as a whole. Then all of its corners are
/// anchored at one point of the other surface, and no point of the part is farther from that point than the farthest
/// corner.
///
/// Points are the vertices of the surface, followed by one point per cut.
struct DetailMap {
  /// A point on an edge between two earlier points: from + at * (to - from).
  struct Cut {
    VertexId from, to;
    double at;  ///< above 0 and below 1
  };
  struct Piece {
    Triangle corners;  ///< points
    FaceId of;         ///< the triangle of which it is a piece
  };

  /// A vertex of a removed part, and the point near it: the sum of a face's corners, each times its weight.
  struct Anchor {
    VertexId vertex;
    FaceId face;  ///< a face of the other surface
    std::array<double, 3> weights;
  };

  std::vector<Cut> cuts;
  /// These are the pieces of all triangles, ascending by `of`. A triangle that is not cut is its own piece.
  std::vector<Piece> pieces;
  /// For each point, the vertex of the other surface to which it goes; invalid for anchored vertices.
  IdVector<VertexId, VertexId> image;
  std::vector<Anchor> anchors;  ///< ascending by vertex
};

}  // namespace remesh
