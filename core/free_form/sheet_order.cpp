#include "core/free_form/sheet_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/base/stoppable.h"

namespace remesh {
void rearrange(FreeSheet& free, const std::vector<VertexId>& order, RunControl& control) {
  const Sheet& before = free.sheet;
  FreeSheet after;
  IdVector<VertexId, VertexId> number(before.positions.size());
  const std::size_t n = order.size();
  StopCheck check(control);
  after.sheet.positions.reserve(n);
  for (const VertexId v : order) {
    check();
    number[v] = after.sheet.positions.push_back(before.positions[v]);
    after.sheet.kind.push_back(before.kind[v]);
    after.quadrics.push_back(free.quadrics[v]);
    after.source.push_back(free.source[v]);
    after.witnesses.of_vertex.push_back(free.witnesses.of_vertex[v]);
  }
  struct Face {
    Triangle corners;
    std::uint32_t first;  ///< the corner before that is the first one now
  };
  std::vector<Face> faces;
  for (FaceId f(0); f.value < before.faces.size(); ++f.value) {
    check();
    if (!before.is_alive(f)) continue;
    const Triangle& t = before.faces[f];
    const std::array<VertexId, 3> now{number[t[0]], number[t[1]], number[t[2]]};
    const auto k = static_cast<std::uint32_t>(std::min_element(now.begin(), now.end()) - now.begin());
    faces.push_back({{now[k], now[(k + 1) % 3], now[(k + 2) % 3]}, 3 * f.value + k});
  }
  sort_stoppable(faces.begin(), faces.end(), control, [](const Face& a, const Face& b) {
    return std::pair(a.corners, a.first) < std::pair(b.corners, b.first);
  });
  after.sheet.faces.reserve(faces.size());
  after.witnesses.all.reserve(free.witnesses.all.size());
  for (const Face& face : faces) {
    check();
    after.sheet.faces.push_back(face.corners);
    after.sheet.origin.push_back(before.origin[Sheet::face_of(face.first)]);
    after.sheet.is_of_plane.push_back(before.is_of_plane[Sheet::face_of(face.first)]);
    for (std::uint32_t c = face.first, k = 0; k < 3; ++k, c = Sheet::after(c))
      after.sheet.chain.push_back(before.chain[c]);
    std::uint32_t w = free.witnesses.of_face[Sheet::face_of(face.first)];
    after.witnesses.of_face.push_back(w == kNone ? kNone : static_cast<std::uint32_t>(after.witnesses.all.size()));
    for (; w != kNone; w = free.witnesses.all[w].next) {
      check();
      SheetWitnesses::Witness witness = free.witnesses.all[w];
      witness.next = witness.next == kNone ? kNone : static_cast<std::uint32_t>(after.witnesses.all.size() + 1);
      after.witnesses.all.push_back(witness);
    }
  }
  after.sheet.is_at_plane = std::move(free.sheet.is_at_plane);
  after.witnesses.on_chains = std::move(free.witnesses.on_chains);
  after.witnesses.of_chain = std::move(free.witnesses.of_chain);
  free = std::move(after);
  free.sheet.link(control);
}

}  // namespace remesh
