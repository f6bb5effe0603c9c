#include "core/verify/folded.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/distances.h"

namespace remesh::verification {
namespace {

using Boxes = BoxTree<NoTag>;

Corners3 corners_of(const Model& model, std::uint32_t output_face) {
  const auto face = model.output.face(output_face);
  return {model.points[face[0].value], model.points[face[1].value], model.points[face[2].value]};
}

}  // namespace

double farthest_of_folded(const Model& model, std::size_t patch, std::span<const std::uint32_t> folded,
                          RunControl& control) {
  std::vector<VertexId> gone;
  StopCheck check(control);
  for (const std::uint32_t f : folded)
    for (const VertexId v : model.input.face(f)) {
      check();
      if (model.is_in_output[v.value] == 0) gone.push_back(v);
    }
  if (gone.empty()) return 0;
  sort_stoppable(gone.begin(), gone.end(), control);
  gone.erase(std::unique(gone.begin(), gone.end()), gone.end());

  const auto faces = model.output_by_patch[patch];
  std::vector<Boxes::Entry> entries(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    check();
    for (const Vec3& p : corners_of(model, faces[i])) entries[i].box.add(p);
  }
  const Boxes boxes(entries, control);
  double farthest = 0;
  for (const VertexId v : gone) {
    control.check();
    const Vec3 p = model.points[v.value];
    double nearest = HUGE_VAL;
    boxes.search(
        nearest, [&](const Boxes::Entry& e) { return squared_distance(e.box, p); },
        [&](std::size_t slot) {
          const Vec3 q = nearest_on_triangle(p, corners_of(model, faces[boxes.number(slot)]));
          nearest = std::min(nearest, norm_squared(q - p));
        });
    farthest = std::max(farthest, nearest);
  }
  return std::sqrt(farthest);
}

}  // namespace remesh::verification
