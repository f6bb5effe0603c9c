#include "core/patches/recognised_surfaces.h"

#include <utility>

namespace remesh {

void RecognisedSurfaces::follow(const PatchSet& before, const PatchSet& now) {
  IdVector<PatchId, SurfaceId> followed;
  followed.reserve(now.count());
  for (RecognisedSurface& s : surfaces) s.patches = 0;
  for (std::size_t p = 0; p < now.count(); ++p) {
    const SurfaceId s = of_patch[before.of_face[now.faces_of(PatchId(p)).front()]];
    followed.push_back(s);
    ++surfaces[s].patches;
  }
  of_patch = std::move(followed);
}

std::string_view side_name(SurfaceSide side) {
  switch (side) {
    case SurfaceSide::kConvex: return "convex";
    case SurfaceSide::kConcave: return "concave";
    case SurfaceSide::kBoth: return "both";
  }
  return "";
}

std::string_view reason_name(FreeReason reason) {
  switch (reason) {
    case FreeReason::kNone: return "";
    case FreeReason::kNoKindFits: return "no_kind_fits";
    case FreeReason::kFewFacets: return "few_facets";
    case FreeReason::kUnevenFacets: return "uneven_facets";
  }
  return "";
}

}  // namespace remesh
