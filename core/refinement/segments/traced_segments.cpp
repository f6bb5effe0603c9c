#include "core/refinement/segments/traced_segments.h"

#include <optional>

namespace remesh {

void TracedSegments::add(const Segment& segment, const PatchCharts& charts) {
  at_.push_back(kNone);
  // Where more than two patches meet, no single curve lies on all of their surfaces.
  if (segment.patches.size() > 2) return;
  std::optional<AnalyticSurface> curved, other;
  for (const PatchId p : segment.patches) {
    const AnalyticSurface shape = charts[p].surface();
    const bool is_plane = shape.kind == SurfaceKind::kPlane;
    if (!is_plane && !curved)
      curved = shape;
    else if (is_plane || !is_same(shape, *curved))
      other = shape;
  }
  if (!curved) return;
  const auto trace = CurveTrace::choose(segment.from, segment.to, *curved, other);
  if (!trace) return;
  at_.back() = static_cast<std::uint32_t>(traces_.size());
  traces_.push_back(*trace);
}

}  // namespace remesh
