#include "core/patches/recognition/facet_graph.h"

#include <cmath>
#include <numbers>

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// A facet of a curved surface has few corners. A facet with more than this is flat in itself.
constexpr std::uint32_t kMaxCorners = 12;

}  // namespace

FacetGraph::FacetGraph(const Facets& facets, double feature_angle_deg, RunControl& control)
    : facets_(facets),
      beyond_(facets.loops.half_edges.size()),
      corner_count_(FilledIdVector<PatchId, std::uint8_t>::of_size(facets.patches.count())),
      inverse_unit_(1 / facets.surface.unit) {
  const double cosine = std::cos(feature_angle_deg * std::numbers::pi / 180);
  const auto beyond_of = [&](PatchId p, std::uint32_t half_edge) {
    const std::uint32_t twin = facets.adjacency.twin(half_edge);
    if (twin == kNone || feature_angle_deg <= 0) return PatchId();
    const FaceId f = facets.adjacency.face_of(half_edge), g = facets.adjacency.face_of(twin);
    const PatchId q = facets.patches.of_face[g];
    if (q == p || facets.surface.label(f) != facets.surface.label(g)) return PatchId();
    return dot(normal(p), normal(q)) >= cosine ? q : PatchId();
  };
  const auto counts = map_blocks<std::size_t>(size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    std::size_t smooth = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const PatchId p(i);
      std::uint32_t corners = 0;
      std::size_t smooth_here = 0;
      for (std::uint32_t s = sides_begin(p); s < sides_end(p); ++s) {
        beyond_[s] = beyond_of(p, facets.loops.half_edges[s]);
        if (beyond_[s].is_valid()) ++smooth_here;
        if (is_corner(s)) ++corners;
      }
      const bool has_one_loop = facets.loops.patch_begin[i + 1] - facets.loops.patch_begin[i] == 1;
      corner_count_[p] = 0;
      if (has_one_loop && corners >= 3 && corners <= kMaxCorners && smooth_here > 0)
        corner_count_[p] = static_cast<std::uint8_t>(corners);
      else if (!has_one_loop && smooth_here > 0 && smooth_here == sides_end(p) - sides_begin(p))
        corner_count_[p] = kManyCorners;
      smooth += smooth_here;
    }
    return smooth;
  });
  for (const std::size_t smooth : counts) smooth_edges_ += smooth;
}

}  // namespace remesh
