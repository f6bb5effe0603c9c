#include "core/stages/boundary_loops.h"

namespace remesh {

BoundaryLoops boundary_loops(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                             RunControl& control) {
  BoundaryLoops loops;
  std::vector<std::uint8_t> is_walked(surface.corners.size(), 0);
  std::uint32_t faces_seen = 0;
  for (std::uint32_t p = 0; p < patches.count(); ++p) {
    for (const FaceId f : patches.faces_of(PatchId(p))) {
      if (++faces_seen % 4096 == 0) control.check();
      for (std::uint32_t start = surface.face_begin[f.value]; start < surface.face_begin[f.value + 1]; ++start) {
        if (is_walked[start] || !is_patch_boundary(adjacency, patches, start)) continue;
        std::uint32_t h = start;
        do {
          loops.half_edges.push_back(h);
          is_walked[h] = 1;
          // Turn about the head of h, through the patch's faces, to the next open edge.
          h = adjacency.next(h);
          while (!is_patch_boundary(adjacency, patches, h)) h = adjacency.next(adjacency.twin(h));
        } while (h != start);
        loops.loop_begin.push_back(static_cast<std::uint32_t>(loops.half_edges.size()));
      }
    }
    loops.patch_begin.push_back(static_cast<std::uint32_t>(loops.loop_begin.size() - 1));
  }
  return loops;
}

}  // namespace remesh
