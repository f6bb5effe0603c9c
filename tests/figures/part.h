/// The part of the pictures as the stages see it.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patches/planar/patches.h"

namespace remesh::figures {

/// A part after the stages up to its patches.
struct Part {
  Surface surface;
  Adjacency adjacency;  ///< looks into the surface's arrays, which stay where they are when the surface is moved
  PatchSet patches;
  double tolerance;  ///< local units
};

Part make_part(const PolygonMesh& mesh, double plane_tolerance, RunControl& control);
Triangle corners_of(const Surface& surface, FaceId f);

}  // namespace remesh::figures
