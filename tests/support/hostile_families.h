/// Families of surfaces that grow without end and make single steps of the pipeline as expensive as a file can. Tests
/// and measurements make each of them in any size.
///
/// All families are the same on every platform. No two vertices have equal coordinates, unless said otherwise.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/mesh/mesh.h"

namespace remesh::hostile {

/// Tells how the number of pairs of faces that meet grows with the size of a family. The report lists such pairs.
enum class Answer {
  kInProportion,  ///< it grows at most in proportion, so time must do so as well, up to a logarithm
  kQuadratic,     ///< a large share of all pairs meet
};

/// A kind of surface that can be made in any size.
struct Family {
  std::string_view name;
  Answer answer = Answer::kInProportion;
  /// Makes a member of the family with about this many faces, or with one face of this many corners.
  PolygonMesh (*make)(std::size_t size) = nullptr;
};

/// Lists all families:
/// - soups of triangles with random corners in a cube, in a plane, and on a grid (where many corners are equal),
/// - polygons of random corners in a plane and in a cube,
/// - planks that all cross in one line,
/// - sheets that are stacked, straight and askew to the axes,
/// - combs, as one polygon and as a prism,
/// - needles that span the part in random directions, and needles that lie side by side askew to the axes,
/// - fans around a vertex and around an edge.
std::span<const Family> families();

/// Returns the family of this name.
/// Errors: std::out_of_range - there is none.
const Family& family(std::string_view name);

}  // namespace remesh::hostile
