#pragma once

namespace remesh {

/// Prints triangles and times of refinement beside CGAL's Mesh_2.
void bench_refinement();

}  // namespace remesh
