/// Makes a surface coarser within a tolerance.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/free_form.h"
#include "core/mesh/mesh.h"

namespace remesh {

struct CoarseningGoals {
  double tolerance;             ///< in local units
  double min_angle_deg;         ///< no angle below this is made, except where the input's own angles are smaller
  bool is_volume_kept = false;  ///< closed components get their volume back, to rounding, if the tolerance allows it
};

/// The surface that coarsen makes.
struct Coarsened {
  IdVector<VertexId, Vec3> positions;
  IdVector<VertexId, VertexId> source;  ///< the input's vertex that is still there; invalid for a vertex that moved
  IdVector<FaceId, Triangle> faces;
  IdVector<FaceId, FaceId> nearest;    ///< the input's face nearest to the centroid of each face
  IdVector<FaceId, FaceId> origin;     ///< per face: one of the input from which no border divides it
  IdVector<FaceId, FaceId> answers;    ///< per face of the input: a face that has to be near some of its samples
  std::uint64_t dropped_features = 0;  ///< edges of features that say nothing about the shape
};

/// The places where a coarser surface is not good enough.
struct CoarseningFaults {
  std::vector<FaceId> far_faces;        ///< of the coarser surface: they are too far from the input
  std::vector<FaceId> far_input_faces;  ///< of the input: they are too far from the coarser surface
  std::vector<FaceId> crossing_faces;   ///< of the coarser surface: they meet others
};

/// A surface that was made coarser, and can be made finer again where a proof fails.
class CoarseSheet {
 public:
  /// Joins vertices, flips edges and moves vertices of a surface, as long as samples of the old surface are within the
  /// tolerance of the new one, and samples of the new one are within the tolerance of the old one. A proof of the
  /// distance, which may be a little larger, is up to the caller.
  /// Holds:   the topology stays. Edges that stay, and edges that have not exactly two faces, lead through some of the
  ///          vertices through which they led before, and all of their vertices with other than two such edges are
  ///          still there. The result is the same for any number of threads and any numbering of the input, up to its
  ///          own numbering, and scales with the input by powers of two.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
  /// Cost:    O(n log n) on most surfaces; in parallel.
  /// Source:  Hu, Yan, Bao, Alliez, Benes, Error-bounded and feature preserving surface remeshing with minimal angle
  ///          improvement, 2017, for the operators; blocks, witnesses and the step across the surface are our own.
  CoarseSheet(const FreeForm& input, const CoarseningGoals& goals, RunControl& control);
  ~CoarseSheet();

  const Coarsened& result() const { return result_; }
  Coarsened take_result() { return std::move(result_); }
  /// Makes the result finer where it is not good enough: faces are split at places of the input. Vertices of crossing
  /// faces move to the input, and those of far faces if `are_all_moved`.
  /// Holds:  as above, but for the tolerance; edges of the input may get new vertices in their middle.
  /// Output: whether anything has changed.
  /// Errors: as above.
  bool refine(const CoarseningFaults& faults, bool are_all_moved, RunControl& control);

 private:
  struct State;
  std::unique_ptr<State> state_;
  Coarsened result_;
};

}  // namespace remesh
