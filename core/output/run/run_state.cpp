#include "core/output/run/run_state.h"

#include <vector>

#include "core/base/diagnostic.h"
#include "core/patches/meshing/patch_meshing.h"

namespace remesh {

void RunState::find_input_intersections(const Triangulated& faces) {
  watch.enter(Stage::kVerify);
  // Intersections that are found after details were removed have been told before.
  std::vector<Diagnostic> told_before;
  std::vector<Diagnostic>& diagnostics = details.is_any_removed() ? told_before : report.diagnostics;
  input_intersections = find_intersections(surface(), faces, partition.patches,
                                           find_simple_patches(partition, candidate.triangulated.meshes),
                                           report.plane_tolerance, diagnostics, control);
  if (!details.is_any_removed()) report.input.intersecting_pairs = input_intersections->pairs.size();
}

}  // namespace remesh
