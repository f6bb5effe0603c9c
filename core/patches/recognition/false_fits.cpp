#include "core/patches/recognition/false_fits.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "core/base/stoppable.h"
#include "core/patches/recognition/free_regions.h"

namespace remesh {
namespace {

/// A claim fits by chance if it has at most kMaxFacets facets, if more than kFreeShare of its border is with seas, and
/// if its area is below kMaxAreaShare of the largest sea's. A sea is a free region.
constexpr std::size_t kMaxFacets = 40;
constexpr double kFreeShare = 0.6, kMaxAreaShare = 0.05;

/// A claim does not fit by chance if it has at least this many facets and if all of their corners are within this part
/// of the tolerance.
constexpr std::size_t kMinClear = 9;
constexpr double kClear = 0.1;

}  // namespace

void drop_false_fits(const FacetGraph& graph, ClaimTable& table, RunControl& control) {
  StopCheck check(control);
  std::optional<FreeRegions> seas;  // on most surfaces none is needed
  for (SurfaceClaim& claim : table.claims) {
    if (claim.facets.empty() || claim.facets.size() > kMaxFacets) continue;
    if (claim.facets.size() >= kMinClear && claim.deviation <= kClear * claim.tolerance) continue;
    if (!seas) seas.emplace(graph, table, control);
    double border = 0, shore = 0, sea = 0;
    for (const PatchId p : claim.facets)
      for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s) {
        check();
        const PatchId q = graph.beyond(s);
        if (q.is_valid() && table.owner[q] == table.owner[p]) continue;
        const double length = norm(graph.position(graph.end_vertex(s)) - graph.position(graph.vertex(s)));
        border += length;
        if (!q.is_valid()) continue;
        const double area = seas->area_of(q);
        if (area > 0) shore += length;
        sea = std::max(sea, area);
      }
    if (shore <= kFreeShare * border || claim.area >= kMaxAreaShare * sea) continue;
    for (const PatchId p : claim.facets) table.owner[p] = kNone;
    claim.facets.clear();
  }
}

}  // namespace remesh
