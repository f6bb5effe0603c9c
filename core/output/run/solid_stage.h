/// Cuts faces of the surface that intersect along their intersections.
#pragma once

#include <optional>
#include <string>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/report/solid_counts.h"
#include "core/output/run/candidate.h"
#include "core/output/run/replaced.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Tells what became of the faces that intersect.
struct ArrangedFaces {
  bool is_done = false;        ///< the surface was replaced
  double distance = 0;         ///< between the surface before and the one after, in model units
  SolidCounts counts;          ///< those of a surface that was replaced
  std::string union_in_vain;   ///< why no triangle was dropped, if a union was wanted and could not be made
  Diagnostic dropped_faces;    ///< the input's faces of whose patches some triangles were dropped
  Diagnostic faces;            ///< the input's faces that were cut
  Diagnostic shared_faces;     ///< the input's faces that lay on others
  std::string reason_in_vain;  ///< why nothing was done, if that is so; empty if nothing had to be done
};

/// Holds the surface as it is, and how it became so.
struct SolidContext {
  const PolygonMesh* input;  ///< as it was read; null if a stage has replaced the surface that was made of it
  const Surface& surface;
  const PatchSet& patches;
  const FaceLabels& labels;  ///< those of the input
  double plane_tolerance;    ///< model units
  double weld_tolerance;     ///< model units
  bool is_union_wanted;      ///< only the boundary of the union of the solids stays
};

/// Makes the triangles of a surface's patches one conforming surface: those that cross are cut along their curves, and
/// those that lie on each other within the plane tolerance become one (see arrange). Where that moves points too
/// far, or fails its check, smaller distances are tried. If anything has changed, it is proven at last that the
/// triangles were the surface.
/// Input:   a candidate that has been triangulated without failures, and no more. If nothing is done, its
///          triangles stay, unless edges of them were changed for the sake of chords.
/// Output:  nothing, if nothing meets, or nothing was proven; `told` says why. Otherwise the new surface. Its faces
///          have the sources of the faces of which they are pieces.
/// Errors:  kCancelled, kTimeout - through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    that of a check, and of arranging and checking what was arranged up to four times.
std::optional<Replaced> arranged_surface(const SolidContext& context, Candidate& candidate, ArrangedFaces& told,
                                         Stopwatch& watch, RunControl& control);

/// Appends what is told about the arrangement.
void report_arrangement(const ArrangedFaces& told, std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
