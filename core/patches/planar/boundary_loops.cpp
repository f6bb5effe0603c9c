#include "core/patches/planar/boundary_loops.h"

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
BoundaryLoops boundary_loops(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                             RunControl& control) {
  BoundaryLoops loops;
  // The half-edges of the boundary, patch by patch. A loop may begin at any of them.
  const auto starts = map_blocks<std::vector<std::uint32_t>>(
      patches.faces.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> found;
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t f = patches.faces[i].value;
          for (std::uint32_t h = surface.face_begin[f]; h < surface.face_begin[f + 1]; ++h)
            if (is_patch_boundary(adjacency, patches, h)) found.push_back(h);
        }
        return found;
      });
  // In the end every boundary half-edge has been walked. The marks are bits, because memory use has its maximum here.
  std::vector<bool>& is_walked = loops.is_boundary;
  is_walked.resize(surface.corners.size());
  const auto close_patch = [&] {
    loops.patch_begin.push_back(static_cast<std::uint32_t>(loops.loop_begin.size() - 1));
  };
  PatchId patch(0);
  StopCheck check(control);
  for (const std::vector<std::uint32_t>& block : starts) {
    control.check();
    for (const std::uint32_t start : block) {
      if (is_walked[start]) continue;
      for (; patches.of_face[adjacency.face_of(start)] != patch; ++patch.value) close_patch();
      std::uint32_t h = start;
      do {
        check();
        loops.half_edges.push_back(h);
        is_walked[h] = true;
        // Turn around the head of h, through the patch's faces, to the next boundary half-edge.
        h = adjacency.next(h);
        while (!is_patch_boundary(adjacency, patches, h)) {
          check();
          h = adjacency.next(adjacency.twin(h));
        }
      } while (h != start);
      loops.loop_begin.push_back(static_cast<std::uint32_t>(loops.half_edges.size()));
    }
  }
  for (; patch.value < patches.count(); ++patch.value) close_patch();
  return loops;
}

}  // namespace remesh
