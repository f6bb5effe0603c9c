#include "core/patches/surface_islands.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// A claim is an island if it has at most kMaxIsland facets, if more than kIslandShore of its border is with seas, and
/// if it is smaller than kIslandArea of the largest of these. A sea is a region of kMinSea facets or more that nobody
/// claims.
constexpr std::size_t kMaxIsland = 40, kMinSea = 40;
constexpr double kIslandShore = 0.6, kIslandArea = 0.05;

/// A claim is no piece of something else, wherever it is, if it has so many facets and if all of their corners are
/// within this part of the tolerance.
constexpr std::size_t kMinClear = 9;
constexpr double kClear = 0.1;

}  // namespace

void drop_islands(const FacetGraph& graph, ClaimTable& table, RunControl& control) {
  StopCheck check(control);
  IdVector<PatchId, std::uint32_t> region_of(graph.size(), kNone);
  std::vector<double> region_area;
  std::vector<PatchId> region;
  const auto is_unclaimed = [&](PatchId p) { return table.owner[p] == kNone && graph.may_be_curved(p); };
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (!is_unclaimed(PatchId(i)) || region_of[PatchId(i)] != kNone) continue;
    const auto id = static_cast<std::uint32_t>(region_area.size());
    region.assign({PatchId(i)});
    region_of[PatchId(i)] = id;
    double area = 0;
    for (std::size_t k = 0; k < region.size(); ++k) {
      area += graph.area(region[k]);
      graph.for_each_neighbour(region[k], [&](PatchId q) {
        check();
        if (!is_unclaimed(q) || region_of[q] != kNone) return;
        region_of[q] = id;
        region.push_back(q);
      });
    }
    // A few facets are planes rather than a surface of their own.
    region_area.push_back(region.size() >= kMinSea ? area : 0);
  }
  for (SurfaceClaim& claim : table.claims) {
    if (claim.facets.empty() || claim.facets.size() > kMaxIsland) continue;
    if (claim.facets.size() >= kMinClear && claim.deviation <= kClear * claim.tolerance) continue;
    double border = 0, shore = 0, sea = 0;
    for (const PatchId p : claim.facets)
      for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s) {
        check();
        const PatchId q = graph.beyond(s);
        if (q.is_valid() && table.owner[q] == table.owner[p]) continue;
        const double length = norm(graph.position(graph.end_vertex(s)) - graph.position(graph.vertex(s)));
        border += length;
        if (!q.is_valid() || region_of[q] == kNone) continue;
        const double area = region_area[region_of[q]];
        if (area > 0) shore += length;
        sea = std::max(sea, area);
      }
    if (shore <= kIslandShore * border || claim.area >= kIslandArea * sea) continue;
    for (const PatchId p : claim.facets) table.owner[p] = kNone;
    claim.facets.clear();
  }
}

}  // namespace remesh
