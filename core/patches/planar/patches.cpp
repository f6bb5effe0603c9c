#include "core/patches/planar/patches.h"

#include <atomic>
#include <limits>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

/// The first face of each face's patch.
class FirstFaces {
 public:
  FirstFaces(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control)
      : regions_(regions), pieces_(regions.are_connected ? 0 : surface.face_count()) {
    if (regions.are_connected)
      find_by_region(control);
    else
      connect(surface, adjacency, control);
  }

  FaceId operator()(FaceId f) const {
    return FaceId(regions_.are_connected ? first_of_region_[regions_.of_face[f].value] : pieces_.root_of(f.value));
  }

 private:
  void find_by_region(RunControl& control) {
    first_of_region_.assign(regions_.planes.size(), std::numeric_limits<std::uint32_t>::max());
    for_blocks(regions_.of_face.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      RegionId before;
      for (FaceId f(begin); f.value < end; ++f.value) {
        if (regions_.of_face[f] == before) continue;
        before = regions_.of_face[f];
        const std::atomic_ref first(first_of_region_[before.value]);
        std::uint32_t known = first.load(std::memory_order_relaxed);
        while (f.value < known && !first.compare_exchange_weak(known, f.value, std::memory_order_relaxed)) continue;
      }
    });
  }

  void connect(const Surface& surface, const Adjacency& adjacency, RunControl& control) {
    const std::size_t n = surface.face_count();
    for_blocks(surface.corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (auto h = static_cast<std::uint32_t>(begin); h < end; ++h) {
        const std::uint32_t twin = adjacency.twin(h);
        if (twin == kNone || twin < h) continue;
        const FaceId f = adjacency.face_of(h), g = adjacency.face_of(twin);
        if (regions_.of_face[f] == regions_.of_face[g]) pieces_.join(f.value, g.value);
      }
    });
    for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) pieces_.flatten(static_cast<std::uint32_t>(f));
    });
  }

  const Regions& regions_;
  std::vector<std::uint32_t> first_of_region_;
  UnionFind pieces_;  ///< pieces of the regions that may be disconnected; empty if there are none
};

/// Numbers the edge-connected pieces of regions by their first faces.
void number_pieces(const Surface& surface, const Adjacency& adjacency, const Regions& regions, PatchSet& set,
                   RunControl& control) {
  const std::size_t n = surface.face_count();
  const FirstFaces first_of(surface, adjacency, regions, control);
  const auto firsts =
      select_ids<FaceId>(n, kItemsPerBlock, control, [&](std::size_t f) { return first_of(FaceId(f)) == FaceId(f); });
  set.of_face = FilledIdVector<FaceId, PatchId>::of_size(n);
  for (const FaceId f : firsts) {
    const RegionId r = regions.of_face[f];
    set.of_face[f] = set.planes.push_back(regions.planes[r]);
    set.deviation.push_back(regions.deviation[r]);
  }
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value)
      if (const FaceId first = first_of(f); first != f) set.of_face[f] = set.of_face[first];
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
