#include "core/verify/model/changed_faces.h"

#include <numeric>

#include "core/base/blocks.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/verify/model/face_measures.h"

namespace remesh::verification {

std::vector<std::uint32_t> faces_near_changes(const Claim& claim, const NumberedClaim& numbered,
                                              const EdgeTable& input_edges, RunControl& control) {
  const std::size_t n = claim.faces.size();
  const std::vector<std::uint32_t> changed = select_ids<std::uint32_t>(n, kItemsPerBlock, control, [&](std::size_t f) {
    return numbered.is_kept[claim.face_patch[f].value] == 0 &&
           !is_input_triangle(numbered, input_edges, claim.face_patch[f], numbered.output.face(f));
  });
  if (changed.empty()) return {};
  // A tree would exclude few faces.
  constexpr std::size_t kMany = 2;
  if (kMany * changed.size() >= n) {
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }
  std::vector<Triangle> triangles;
  triangles.reserve(changed.size());
  for (const std::uint32_t f : changed) triangles.push_back(claim.faces[f]);
  const TriangleTree tree(claim.positions, triangles, control);
  return select_ids<std::uint32_t>(n, kItemsPerBlock, control, [&](std::size_t f) {
    Box3 box;
    for (const VertexId v : claim.faces[f]) box.add(claim.positions[v.value]);
    bool is_near = false;
    tree.visit_meeting(box, 0, [&](std::size_t) {
      is_near = true;
      return false;
    });
    return is_near;
  });
}

}  // namespace remesh::verification
