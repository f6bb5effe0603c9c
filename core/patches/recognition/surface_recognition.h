/// Finds the surfaces from which the facets of a mesh were made.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facets.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Recognises planes, cylinders, cones, spheres, tori and surfaces of revolution. All other facets are free.
/// Output:  every patch belongs to one surface. Equal surfaces are one.
/// Holds:   the result depends on geometry alone, not on the order of faces and vertices or on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n), about a microsecond a face.
RecognisedSurfaces recognise_surfaces(const Facets& facets, const RecognitionRules& rules, RunControl& control);

}  // namespace remesh
