/// The part of the README's picture: a mechanical bracket, made by code and cut into many irregular triangles.
#pragma once

#include <cstddef>

#include "core/mesh/mesh.h"

namespace remesh::figures {

/// An L-shaped bracket with a rib, rounded corners, two slots and two round holes, as an export would hold it: planar
/// faces in far too many triangles of all shapes, coordinates rounded to six decimals.
/// Output:  `face_count` triangles or one more.
/// Holds:   closed, conforming, no label; the same mesh on every run.
PolygonMesh make_bracket(std::size_t face_count);

}  // namespace remesh::figures
