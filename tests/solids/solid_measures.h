/// Measures the results of cutting and uniting solids, without the code that made them.
#pragma once

#include <cstddef>

#include "core/mesh/mesh.h"

namespace remesh {

/// Measures of a result, by sums over its triangles. The sums of doubles over many equal parts would drift by more than
/// what rounding may do to the coordinates.
struct Measures {
  double volume = 0, area = 0, lengths = 0;
  double largest = 0;    ///< coordinate
  double narrowest = 0;  ///< the smallest height of a triangle
  int euler = 0;
  std::size_t shells = 0;                       ///< parts that hang together over edges of two faces
  std::size_t four_faces = 0, other_edges = 0;  ///< edges with four faces, and with neither two nor four
};
Measures measures_of(const TriangleMesh& mesh);

/// Counts pairs of triangles that intersect by CGAL, among those whose boxes meet, until there are enough.
std::size_t pairs_by_cgal(const TriangleMesh& mesh, std::size_t enough);

}  // namespace remesh
