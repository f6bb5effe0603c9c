#include "core/patches/torus_limits.h"

#include <algorithm>
#include <cstdint>

#include "core/base/stoppable.h"

namespace remesh {

void deepen_tori(const Surface& surface, const PatchSet& facets, const RecognisedSurfaces& recognised,
                 double plane_tolerance, std::vector<CurvedLimits>& limits, RunControl& control) {
  std::vector<std::uint8_t> is_inside(limits.size(), 0);
  bool is_any = false;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    is_inside[i] = limits[i].tolerance > 0 && recognised.surfaces[SurfaceId(i)].shape.kind == SurfaceKind::kTorus;
    is_any = is_any || is_inside[i] != 0;
  }
  if (!is_any) return;
  StopCheck check(control);
  for (std::size_t p = 0; p < facets.count(); ++p) {
    const SurfaceId s = recognised.of_patch[PatchId(p)];
    if (is_inside[s.value] == 0) continue;
    const AnalyticSurface& torus = recognised.surfaces[s].shape;
    for (const FaceId f : facets.faces_of(PatchId(p))) {
      const auto face = surface.face(f);
      Vec3 before = surface.positions[face.back()];
      for (const VertexId v : face) {
        check();
        // An edge around the axis has its middle farthest outside.
        const Vec3 here = surface.positions[v];
        if (torus.distance(0.5 * (before + here)) > plane_tolerance) is_inside[s.value] = 0;
        before = here;
      }
    }
  }
  for (std::size_t i = 0; i < limits.size(); ++i)
    if (is_inside[i] != 0) limits[i].max_height = std::max(limits[i].max_height, limits[i].boundary_tolerance);
}

}  // namespace remesh
