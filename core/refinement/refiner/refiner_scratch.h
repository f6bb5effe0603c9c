/// The scratch memory for refining a patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/refiner/task_queues.h"
#include "core/triangulation/delaunay_mesh.h"

namespace remesh {

/// A triangle in the queue. Half-edge a-b is its shortest edge, and c is its apex.
struct TriangleTask {
  std::uint32_t half_edge, a, b, c;
};

/// A refiner works with this memory during its turn. A thread has one for all its patches. Most patches are small, and
/// each would need as much scratch memory as the patch itself has.
struct RefinerScratch {
  /// A piece of a segment, with the range of the cuts inside it.
  struct Range {
    std::uint32_t piece;
    std::size_t first, last;
  };

  /// A free vertex that was removed and may have to be put back.
  struct Taken {
    Vec2 p;
    MinSpacing spacing;
  };

  DelaunayMesh::Scratch mesh;
  TaskQueues<TriangleTask> waiting;  ///< empty between turns; a refiner borrows its memory
  // These arrays serve one operation.
  std::vector<std::uint32_t> encroached, pieces;
  std::vector<Range> ranges;
  // These arrays serve thinning out. They hold vertices or triangles.
  std::vector<std::uint32_t> to_thin, ring, other_ring, hole, remade;
  std::vector<Taken> taken;
};

}  // namespace remesh
