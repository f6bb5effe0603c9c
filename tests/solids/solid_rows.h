/// The table of solids that touch, overlap and cross in every way, with what is known of them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"

namespace remesh {

/// Solids, and the figures of their union and of their arrangement, which a grid or a closed formula gives.
struct SolidRow {
  int number = 0;
  std::string name;
  std::vector<PolygonMesh> parts;  ///< closed; their faces are triangles or convex polygons
  double volume = 0, area = 0;     ///< those of the union
  int euler = 0;                   ///< of the union's boundary: vertices - edges + faces
  std::size_t shells = 1;          ///< of the union, where edges with four faces do not connect
  std::size_t four_faces = 0;      ///< edges of the union with four faces, without refinement
  std::size_t triangles = 0;       ///< of the union without refinement; 0: not given
  std::vector<double> cells{};     ///< volumes, ascending; a cell of nested parts that touch nothing counts whole
  bool is_large = false;           ///< it has hundreds or thousands of parts
};

/// Makes the twenty rows of the table.
std::vector<SolidRow> solid_rows();

/// Divides each triangle n times along each side, so that it becomes n * n triangles.
/// Input: triangles.
PolygonMesh divided(const PolygonMesh& mesh, int n);

/// Returns all parts as one mesh, in which equal coordinates of parts are separate vertices.
PolygonMesh as_one(const std::vector<PolygonMesh>& parts);

}  // namespace remesh
