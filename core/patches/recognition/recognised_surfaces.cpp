#include "core/patches/recognition/recognised_surfaces.h"

#include <algorithm>
#include <utility>

#include "core/base/stoppable.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

RecognisedSurfaces RecognisedSurfaces::copy(RunControl& control) const {
  RecognisedSurfaces copied;
  copied.of_patch = of_patch;
  copied.surfaces.reserve(surfaces.size());
  StopCheck check(control);
  for (const RecognisedSurface& s : surfaces) {
    check();
    copied.surfaces.push_back(s);
  }
  return copied;
}

namespace {

/// Gives each patch the surface of its first face.
template <class SurfaceOf>
void follow_first_faces(RecognisedSurfaces& recognised, const PatchSet& now, const SurfaceOf& surface_of) {
  IdVector<PatchId, SurfaceId> followed;
  followed.reserve(now.count());
  for (RecognisedSurface& s : recognised.surfaces) s.patches = 0;
  for (PatchId p(0); p.value < now.count(); ++p.value) {
    const SurfaceId s = surface_of(now.faces_of(p).front());
    followed.push_back(s);
    ++recognised.surfaces[s].patches;
  }
  recognised.of_patch = std::move(followed);
}

}  // namespace

void RecognisedSurfaces::follow(const PatchSet& before, const PatchSet& now) {
  follow_first_faces(*this, now, [&](FaceId f) { return of_patch[before.of_face[f]]; });
}

void RecognisedSurfaces::follow(const IdVector<FaceId, SurfaceId>& of_face, const PatchSet& now) {
  follow_first_faces(*this, now, [&](FaceId f) { return of_face[f]; });
}

void RecognisedSurfaces::join_bands() {
  for (SurfaceId& s : of_patch)
    if (const SurfaceId whole = surfaces[s].whole; whole.is_valid()) {
      ++surfaces[whole].patches;
      s = whole;
    }
  for (const RecognisedSurface& band : surfaces) {
    if (!band.whole.is_valid()) continue;
    RecognisedSurface& whole = surfaces[band.whole];
    whole.allowed = std::max(whole.allowed, band.allowed);
    whole.is_remeshed = whole.is_remeshed || band.is_remeshed;
    if (band.elements_per_circle) whole.elements_per_circle = band.elements_per_circle;
    whole.bound = std::max(whole.bound, band.bound);
  }
  std::erase_if(surfaces.items(), [](const RecognisedSurface& s) { return s.whole.is_valid(); });
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
