/// The measurements of refinement.
#pragma once

#include "tests/bench/rows.h"

namespace remesh::bench {

/// Prints triangles and times beside those of CGAL's Mesh_2, on the same planar regions and for the same bound, and the
/// time per face in patches of two triangles beside that in one large patch. The same figures are added to `rows`.
void measure_refinement(Rows& rows);

}  // namespace remesh::bench
