#include "core/stages/patches.h"

#include <utility>

#include "core/base/blocks.h"
#include "core/base/union_find.h"

namespace remesh {
PatchSet patches(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control) {
  const std::size_t n = surface.face_count();
  UnionFind pieces(n);
  for_blocks(surface.corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
      const std::uint32_t twin = adjacency.twin(h);
      if (twin == Adjacency::kNone || twin < h) continue;
      const FaceId f = adjacency.face_of(h), g = adjacency.face_of(twin);
      if (regions.of_face[f] == regions.of_face[g]) pieces.join(f.value, g.value);
    }
  });
  PatchSet set;
  set.of_face.resize(n);
  set.face_begin.clear();
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i % kItemsPerBlock == 0) control.check();
    const FaceId f(i), first(pieces.find(i));
    if (first == f) {
      set.of_face[f] = set.planes.push_back(regions.planes[regions.of_face[f]]);
      set.face_begin.push_back(0);
    } else {
      set.of_face[f] = set.of_face[first];
    }
    ++set.face_begin[set.of_face[f].value];
  }
  // From how many faces there are to where they begin, and after the last one.
  std::uint32_t begin = 0;
  for (std::uint32_t& count : set.face_begin) begin += std::exchange(count, begin);
  set.face_begin.push_back(begin);
  set.faces.resize(n);
  std::vector<std::uint32_t> at(set.face_begin.begin(), set.face_begin.end() - 1);
  for (std::uint32_t i = 0; i < n; ++i) set.faces[at[set.of_face[FaceId(i)].value]++] = FaceId(i);
  return set;
}

}  // namespace remesh
