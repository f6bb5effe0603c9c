#include "core/verify/model/face_measures.h"

#include <algorithm>

#include "core/base/stoppable.h"

namespace remesh::verification {

bool is_input_triangle(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch,
                       std::span<const VertexId> face) {
  if (std::any_of(face.begin(), face.end(),
                  [&](VertexId v) { return v.value >= numbered.surface_vertex_count || numbered.is_moved(v); }))
    return false;
  const auto count_uses = [&](std::size_t side) { return input_edges.count_uses(face[side], face[(side + 1) % 3]); };
  // The edge with the fewest faces is searched, because another edge may have a million faces.
  std::size_t i = 0;
  for (const std::size_t k : {1, 2})
    if (count_uses(k) < count_uses(i)) i = k;
  const VertexId from = face[i], to = face[(i + 1) % 3], apex = face[(i + 2) % 3];
  for (const Use& use : input_edges.find(from, to)) {
    if (use.patch() != patch || use.is_forward() != (from < to)) continue;
    const auto after =
        std::upper_bound(numbered.input.face_begin.begin(), numbered.input.face_begin.end(), use.half_edge);
    const auto same = numbered.input.face(static_cast<std::size_t>(after - numbered.input.face_begin.begin() - 1));
    if (same.size() == 3 && std::find(same.begin(), same.end(), apex) != same.end()) return true;
  }
  return false;
}

bool is_unchanged(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch, RunControl& control) {
  const auto before = numbered.input_by_patch[patch.value], after = numbered.output_by_patch[patch.value];
  if (before.size() != after.size()) return false;
  StopCheck check(control);
  return std::all_of(after.begin(), after.end(), [&](std::uint32_t f) {
    check();
    return is_input_triangle(numbered, input_edges, patch, numbered.output.face(f));
  });
}

}  // namespace remesh::verification
