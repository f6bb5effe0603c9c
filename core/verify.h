/// The independent check of the promises. It shares no decision with the stages: it has its own edges, its own exact
/// arithmetic and its own distances, and takes from the pipeline only what is claimed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/frame.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/report.h"

namespace remesh {

/// What the pipeline says it has done.
struct Claim {
  const Surface& surface;                          ///< what was remeshed
  const IdVector<FaceId, PatchId>& surface_patch;  ///< patch of each face of `surface`
  const IdVector<PatchId, Frame>& frames;
  std::span<const Vec3> positions;      ///< output vertices
  std::span<const Triangle> faces;      ///< output faces
  std::span<const PatchId> face_patch;  ///< patch of each output face
  std::span<const Vec2> corner_uv;      ///< stored plane coordinates, 3 per output face
  double plane_tolerance = 0;           ///< model units
};

/// Tests promises 1 to 3.
/// Output:  a verdict; `failed_patches` names every patch on which a test failed.
///  surface:    every output vertex is a surface vertex bit for bit; input and output lie within plane_tolerance of
///  each
///              other, both ways, patch by patch; every patch keeps its boundary loops (each output loop is the input
///              loop less vertices within tolerance of the chord that replaces them); Euler number, closedness, area
///              and volume are kept within what the deviations explain.
///  conforming: every output edge has the faces, and the directions, that the input's edges under it have; no zero-area
///              or inverted triangle but for the input's own, no repeated face, no new non-manifold edge, no
///              T-junction.
///  delaunay:   the stored plane coordinates are the projections of the vertices; every edge inside a patch is locally
///              Delaunay in them by exact arithmetic - or the edge that would replace it exists elsewhere in the output
///              (the chord rule).
/// Holds:   the same verdict for any number of threads.
/// Cost:    O(n log n).
Verdict verify(const Claim& claim, RunControl& control);

}  // namespace remesh
