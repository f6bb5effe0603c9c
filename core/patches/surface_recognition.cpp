#include "core/patches/surface_recognition.h"

namespace remesh {

RecognisedSurfaces recognise_surfaces(const Facets& facets, const RecognitionRules& rules, RunControl& control) {
  RecognisedSurfaces result;
  for (const PatchSummary& patch : facets.summaries) {
    control.check();
    RecognisedSurface plane;
    plane.shape = {SurfaceKind::kPlane, patch.offset * patch.normal, patch.normal};
    plane.patches = 1;
    plane.faces = patch.input_faces;
    plane.area = patch.area;
    plane.tolerance = rules.rounding_step;
    result.of_patch.push_back(result.surfaces.push_back(plane));
  }
  return result;
}

}  // namespace remesh
