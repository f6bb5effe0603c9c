#include "core/stages/patches.h"

#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

/// Numbers the pieces of regions that edges hold together, by their first faces.
void number_pieces(const Surface& surface, const Adjacency& adjacency, const Regions& regions, PatchSet& set,
                   RunControl& control) {
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
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) pieces.flatten(static_cast<std::uint32_t>(f));
  });
  const auto firsts = select_ids<FaceId>(
      n, kItemsPerBlock, control, [&](std::size_t f) { return pieces.root_of(static_cast<std::uint32_t>(f)) == f; });
  set.of_face.resize(n);
  for (const FaceId f : firsts) set.of_face[f] = set.planes.push_back(regions.planes[regions.of_face[f]]);
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value)
      if (const FaceId first(pieces.root_of(f.value)); first != f) set.of_face[f] = set.of_face[first];
  });
}

}  // namespace

PatchSet patches(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control) {
  const std::size_t n = surface.face_count();
  PatchSet set;
  number_pieces(surface, adjacency, regions, set, control);
  auto by_patch = group_by<FaceId>(
      n, set.count(), [&](std::uint32_t f) { return set.of_face[FaceId(f)].value; }, control);
  set.face_begin = std::move(by_patch.begin);
  set.faces = std::move(by_patch.items);
  return set;
}

}  // namespace remesh
