#include "core/solids/active_faces.h"

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/geometry/trees/triangle_tree.h"

namespace remesh {

SelectedFaces select_near_active(const Soup& soup, std::span<const std::uint8_t> active, double distance,
                                 RunControl& control) {
  SelectedFaces selected;
  if (active.empty()) return selected;
  std::vector<Triangle> of_active;
  StopCheck check(control);
  for (std::size_t f = 0; f < soup.faces.size(); ++f, check())
    if (active[f] != 0) of_active.push_back(soup.faces[f]);
  const TriangleTree tree(soup.positions, of_active, control);
  const auto is_near = [&](std::size_t f) {
    Box3 box;
    for (const VertexId v : soup.faces[f]) box.add(soup.positions[v.value]);
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] -= distance;
      box.max[axis] += distance;
    }
    bool is_found = false;
    tree.visit_meeting(box, 0, [&](std::size_t) {
      is_found = true;
      return false;
    });
    return is_found;
  };
  selected.numbers = select_ids<FaceId>(soup.faces.size(), kItemsPerBlock, control, [&](std::size_t f) {
    return active[f] != 0 || (!of_active.empty() && is_near(f));
  });
  for (const FaceId f : selected.numbers) selected.copies.push_back(soup.faces[f.value]);
  return selected;
}

}  // namespace remesh
