#include "core/stages/patches.h"

namespace remesh {

PatchSet patches(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control) {
  const std::size_t n = surface.face_count();
  PatchSet set;
  set.of_face.resize(n);
  std::vector<FaceId> stack;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i % 4096 == 0) control.check();
    if (set.of_face[FaceId(i)].is_valid()) continue;
    const RegionId region = regions.of_face[FaceId(i)];
    const PatchId patch = set.planes.push_back(regions.planes[region]);
    set.of_face[FaceId(i)] = patch;
    stack.push_back(FaceId(i));
    while (!stack.empty()) {
      const FaceId f = stack.back();
      stack.pop_back();
      for (std::uint32_t h = surface.face_begin[f.value]; h < surface.face_begin[f.value + 1]; ++h) {
        const std::uint32_t twin = adjacency.twin(h);
        if (twin == Adjacency::kNone) continue;
        const FaceId g = adjacency.face_of(twin);
        if (regions.of_face[g] != region || set.of_face[g].is_valid()) continue;
        set.of_face[g] = patch;
        stack.push_back(g);
      }
    }
  }
  set.face_begin.assign(set.count() + 1, 0);
  for (const PatchId p : set.of_face) ++set.face_begin[p.value + 1];
  for (std::size_t p = 0; p < set.count(); ++p) set.face_begin[p + 1] += set.face_begin[p];
  set.faces.resize(n);
  std::vector<std::uint32_t> at(set.face_begin.begin(), set.face_begin.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i) set.faces[at[set.of_face[FaceId(i)].value]++] = FaceId(i);
  return set;
}

}  // namespace remesh
