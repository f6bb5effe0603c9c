#include "core/refinement/sizes/patch_slabs.h"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.h"

namespace remesh {

PatchSlabs::PatchSlabs(const Surface& surface, const PatchSet& patches, const PatchCharts* charts,
                       std::span<const Triangle> triangles, std::span<const std::uint32_t> begin, RunControl& control)
    : surface_(&surface), slabs_(patches.count()) {
  if (charts != nullptr && charts->has_curved()) curved_.assign(patches.count(), nullptr);
  for_blocks(patches.count(), 1024, control, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const PatchId p(i);
      if (!curved_.empty()) curved_[p] = (*charts)[p].curved();
      Slab& slab = slabs_[p];
      slab.plane = patches.planes[p];
      for (const Triangle& t : triangles.subspan(begin[i], begin[i + 1] - begin[i]))
        for (const VertexId v : t)
          slab.half_thickness = std::max(slab.half_thickness, std::fabs(slab.plane.distance(surface.local[v])));
      slab.half_thickness += kRounding;
    }
  });
}

Vec3 PatchSlabs::curved_normal(PatchId p, const Vec3& place) const {
  const SurfaceMap& map = curved_[p]->map();
  return map.side() * map.shape().normal(surface_->centre + surface_->unit * place);
}

PatchSlabs::OfPieces PatchSlabs::around(PatchId p, std::span<const Corners3> pieces) const {
  if (!is_curved(p) || pieces.empty()) return {slabs_[p], kSteep};
  Box3 box;
  for (const Corners3& piece : pieces)
    for (const Vec3& corner : piece) box.add(corner);
  OfPieces around{at(p, 0.5 * (box.min + box.max)), kSteep};
  // A way w is steep at a place with the normal n if |n w| > s |w|. Then |m w| > (s - |n - m|) |w| for the normal m of
  // the slab.
  double turn = 0;
  for (const Corners3& piece : pieces)
    for (const Vec3& corner : piece) {
      turn = std::max(turn, norm(curved_normal(p, corner) - around.slab.plane.normal));
      around.slab.half_thickness =
          std::max(around.slab.half_thickness, std::fabs(around.slab.plane.distance(corner)) + kRounding);
    }
  const double sine = std::max(0.0, std::sqrt(kSteep) - turn);
  around.steep = sine * sine;
  return around;
}

}  // namespace remesh
