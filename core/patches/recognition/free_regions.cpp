#include "core/patches/recognition/free_regions.h"

#include <cstddef>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// A region has at least this many facets that no claim has.
constexpr std::size_t kMinRegion = 40;

}  // namespace

FreeRegions::FreeRegions(const FacetGraph& graph, const ClaimTable& table, RunControl& control)
    : region_of_(graph.size(), kNone) {
  StopCheck check(control);
  std::vector<PatchId> region;
  const auto is_unclaimed = [&](PatchId p) { return table.owner[p] == kNone && graph.may_be_curved(p); };
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (!is_unclaimed(PatchId(i)) || region_of_[PatchId(i)] != kNone) continue;
    const auto id = static_cast<std::uint32_t>(area_.size());
    region.assign({PatchId(i)});
    region_of_[PatchId(i)] = id;
    double area = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      area += graph.area(region[k]);
      graph.for_each_neighbour(region[k], [&](PatchId q) {
        check();
        if (!is_unclaimed(q) || region_of_[q] != kNone) return;
        region_of_[q] = id;
        region.push_back(q);
      });
    }
    area_.push_back(region.size() >= kMinRegion ? area : 0);
  }
}

}  // namespace remesh
