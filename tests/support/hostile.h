/// Surfaces that make single steps of the pipeline as large as a file can: whoever sends one may want to tie up a core.
///
/// Faces are triangles unless said otherwise, vertices are welded and used, coordinates are exact.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/mesh/mesh.h"

namespace remesh::hostile {

/// `count` tetrahedra beside each other.
PolygonMesh components(std::size_t count);
/// A cone of `count` facets around its tip; it is open below. Its tip has `count` edges and its facets are one patch
/// each.
PolygonMesh cone(std::size_t count);
/// A disc of `count` facets around its middle: one patch with a vertex of `count` edges.
PolygonMesh disc(std::size_t count);
/// One polygon of `count` corners on a circle.
PolygonMesh polygon(std::size_t count);
/// `count` triangles with random corners in a cube; each crosses a large share of the others.
PolygonMesh soup(std::size_t count, unsigned seed);
/// `count` triangles that share one edge, at different angles.
PolygonMesh book(std::size_t count);
/// The same, every page twice: seen from the front and from behind.
PolygonMesh double_book(std::size_t count);
/// One triangle `count` times.
PolygonMesh repeated(std::size_t count);
/// Two triangles whose common edge is there twice: whole on one side, in `count` pieces on the other.
PolygonMesh torn_edge(std::size_t count);
/// `count` triangles without area on one line, in a fan, between two triangles with area.
PolygonMesh flat_fan(std::size_t count);
/// A sheet of 2 * n * n triangles whose inner vertices are moved up and down: each facet is a patch of its own.
PolygonMesh crumpled(std::size_t n, unsigned seed);
/// A strip of `count` triangles, very long and narrow, in zigzag.
PolygonMesh strip(std::size_t count);
/// Triangles whose windings are at random, in a sheet of 2 * n * n.
PolygonMesh shuffled_winding(std::size_t n, unsigned seed);

/// A surface and what is asked of it.
struct Case {
  std::string name;
  PolygonMesh mesh;
  Options options;
};

/// Each of the surfaces above with about `faces` faces (fewer where the work grows faster than they).
std::vector<Case> cases(std::size_t faces);

}  // namespace remesh::hostile
