/// The part in the README's picture. It is a mechanical bracket that code makes and cuts into many irregular triangles.
#pragma once

#include <cstddef>

#include "core/mesh/mesh.h"

namespace remesh::figures {

/// Makes an L-shaped bracket with a rib, rounded corners, two slots and two round holes. It is as an export would be:
/// planar faces are cut into far too many triangles of all shapes, and coordinates are rounded to six decimals.
/// Output:  `face_count` triangles or one more.
/// Holds:   closed, conforming, no label; the same mesh on every run.
PolygonMesh make_bracket(std::size_t face_count);

}  // namespace remesh::figures
