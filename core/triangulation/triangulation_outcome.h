/// The way in which the triangulation of one patch ended. It is an ordinary value and not an exception, because a patch
/// that fails goes down the ladder.
#pragma once

namespace remesh {

enum class TriangulationOutcome {
  kDone,
  kCrossingConstraints,  ///< two loop edges cross, or a vertex lies inside a loop edge
  kInconsistentLoops,    ///< a region would be inside by one loop edge and outside by another
  kDegenerate,           ///< all points lie on one line
};

}  // namespace remesh
