/// Proves that coarser surfaces are near the surface from which they were made.
#pragma once

#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/coarsen.h"
#include "core/free_form/free_form.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Proves distances of surfaces that follow each other. What was proven for one of them still counts for the next one,
/// where this has the same faces.
class CoarseningProof {
 public:
  CoarseningProof(const FreeForm& input, double tolerance, RunControl& control)
      : input_(input), tolerance_(tolerance), control_(control) {}

  /// Finds the faces of the surface and of the input that are not proven to be within the tolerance of the other one.
  /// Output: `crossing_faces` stays empty.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
  /// Cost:   that of distance_between for the first surface; for others, that of the faces that have changed, and
  ///         O(n log n).
  CoarseningFaults check(const Coarsened& made);

 private:
  std::vector<FaceId> input_faces_to_check(const std::vector<Corners3>& now) const;
  std::vector<FaceId> far_faces(std::span<const Vec3> positions, const IdVector<FaceId, Triangle>& faces,
                                const std::vector<FaceId>& asked, std::span<const Vec3> others,
                                const IdVector<FaceId, Triangle>& other_faces) const;

  const FreeForm& input_;
  const double tolerance_;
  RunControl& control_;
  bool is_first_ = true;
  std::vector<Corners3> all_, near_;  ///< the faces of the last surface, and those that were near, ascending
  std::vector<FaceId> far_input_;     ///< the input's faces that were far
};

}  // namespace remesh
