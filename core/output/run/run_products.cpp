#include "core/output/run/run_products.h"

#include <vector>

#include "core/base/diagnostic.h"
#include "core/mending/polygons/triangulated.h"

namespace remesh {

void RunProducts::find_input_intersections(const Triangulated& faces) {
  watch.enter(Stage::kVerify);
  // Intersections that are found after a stage has replaced the surface have been told before.
  std::vector<Diagnostic> told_before;
  std::vector<Diagnostic>& diagnostics = spent.stages > 0 ? told_before : report.diagnostics;
  input_intersections = find_intersections(surface(), faces, partition.patches,
                                           find_simple_patches(partition, candidate.triangulated.meshes),
                                           report.plane_tolerance, diagnostics, control);
  if (spent.stages == 0) report.input.intersecting_pairs = input_intersections->pairs.size();
}

}  // namespace remesh
