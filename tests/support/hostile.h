/// Surfaces that make single steps of the pipeline as expensive as a file can. Somebody might send one to keep a core
/// busy.
///
/// Faces are triangles unless said otherwise. All vertices are welded and used, and coordinates are exact.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/mesh/mesh.h"

namespace remesh::hostile {

/// Makes `count` tetrahedra beside each other.
PolygonMesh components(std::size_t count);
/// Makes a cone of `count` facets around its tip, open below. Its tip has `count` edges, and each facet is a patch of
/// its own.
PolygonMesh cone(std::size_t count);
/// Makes a disc of `count` facets around its middle: one patch with a vertex of `count` edges.
PolygonMesh disc(std::size_t count);
/// Makes one polygon of `count` corners on a circle.
PolygonMesh polygon(std::size_t count);
/// Makes `count` triangles with random corners in a cube. Each of them crosses a large share of the others.
PolygonMesh soup(std::size_t count, unsigned seed);
/// Makes `count` triangles that share one edge, at different angles.
PolygonMesh book(std::size_t count);
/// Makes the same book with every page twice: once seen from the front, and once from behind.
PolygonMesh double_book(std::size_t count);
/// Makes one triangle `count` times.
PolygonMesh repeated(std::size_t count);
/// Makes two triangles whose common edge exists twice: as a whole on one side, in `count` pieces on the other.
PolygonMesh torn_edge(std::size_t count);
/// Makes `count` triangles without area on one line, as a fan between two triangles with area.
PolygonMesh flat_fan(std::size_t count);
/// Makes a sheet of 2 * n * n triangles whose inner vertices are moved up and down. Each facet is a patch of its own.
PolygonMesh crumpled(std::size_t n, unsigned seed);
/// Makes a very long and narrow strip of `count` triangles in a zigzag.
PolygonMesh strip(std::size_t count);
/// Makes a sheet of 2 * n * n triangles with random windings.
PolygonMesh shuffled_winding(std::size_t n, unsigned seed);

/// A surface and the options with which it is remeshed.
struct Case {
  std::string name;
  PolygonMesh mesh;
  Options options;
};

/// Makes each of the surfaces above with about `faces` faces, or fewer if the work grows faster than their number.
std::vector<Case> cases(std::size_t faces);

}  // namespace remesh::hostile
