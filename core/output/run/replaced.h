/// The surface that a stage puts in the place of another one.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// The result of a stage that puts another surface in the place of the last one. All steps after it take the surface,
/// whoever made it. Its faces know which input faces they cover, so that marks and reasons go through them to the
/// input.
struct Replaced {
  Surface surface;
  std::vector<FaceId> without_area;  ///< the surface's faces without area, which stay as they are
  double distance = 0;               ///< how far all faces may be from the surface before, both ways, in model units
  double plane_tolerance = 0;        ///< the one that counts on this surface, in model units
  double volume = 0;                 ///< by how much the volume has changed at most, in cubed model units
};

/// Adds up what stages have spent.
struct SpentOnStages {
  int stages = 0;
  double distance = 0, volume = 0;

  void add(const Replaced& replaced) {
    ++stages;
    distance += replaced.distance;
    volume += replaced.volume;
  }
};

/// Returns whether no two places are equal.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
bool are_different(std::vector<Vec3> places, const RunControl& control);

/// Returns the input faces that new faces cover which a stage made of the patches of a surface. The first new face of a
/// patch covers all input faces that the patch covered; any other covers its source.
/// Input: `patch` is the patch of each new face, and `source` its source.
CoveredFaces covers_of_new_faces(const Surface& before, const PatchSet& patches, const IdVector<FaceId, PatchId>& patch,
                                 const FilledIdVector<FaceId, FaceId>& source);

}  // namespace remesh
