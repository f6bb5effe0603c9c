/// The whole pipeline as one call, for tests that have nothing to stop and nothing to watch.
#pragma once

#include "core/base/options.h"
#include "core/mesh/mesh.h"
#include "core/remesh.h"
#include "tests/support/unrefined_options.h"

namespace remesh {

inline Result remeshed(const PolygonMesh& mesh, const Options& options = unrefined(),
                       const RunSettings& settings = {}) {
  RunControl control;
  return remesh_surface(mesh, options, settings, control);
}

}  // namespace remesh
