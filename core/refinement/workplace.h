/// What refining a patch takes besides the patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/refinement/delaunay_mesh.h"
#include "core/refinement/task_queues.h"

namespace remesh {

/// What a refiner works with during its turn. A thread has one for all its patches: most of these are small, and what
/// each would need for itself is as large as they are.
struct Workplace {
  /// A triangle that waits, by its shortest edge.
  struct Task {
    std::uint32_t half_edge, a, b, c;
  };
  /// A piece of a segment, and the cuts inside it.
  struct Range {
    std::uint32_t piece;
    std::size_t first, last;
  };

  /// A vertex that was taken away, and may have to come back.
  struct Taken {
    Vec2 p;
    double value;
  };

  DelaunayMesh::Scratch mesh;
  TaskQueues<Task> waiting;  ///< empty between turns: it is lent
  // Of one operation.
  std::vector<std::uint32_t> encroached, to_cut, pieces;
  std::vector<Range> ranges;
  // Of thinning out: vertices, triangles.
  std::vector<std::uint32_t> to_thin, ring, other_ring, hole, remade;
  std::vector<Taken> taken;
};

}  // namespace remesh
