/// Finds places of the input near given places.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The triangles of the input, which does not change.
class InputSurface {
 public:
  /// Input:  the triangles, and per half-edge (3 * face + corner) the one on its other side, or kNone. `shares` has the
  ///         share of a tolerance that counts at each face, in (0, 1]; it is empty if all shares are 1.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n log n), in parallel.
  InputSurface(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces,
               std::span<const std::uint32_t> twins, std::span<const float> shares, RunControl& control);

  /// Returns a face that is within its share of the tolerance of p, or an invalid id. The search walks from `start`
  /// over the surface, and asks the tree only if the walk ends in vain. So `start` decides which face it is, but not
  /// whether there is one.
  FaceId near_face(const Vec3& p, FaceId start, double tolerance) const;
  /// Returns the place to which a walk over the surface from `start` leads that comes nearer to p with each step.
  Vec3 near_place(const Vec3& p, FaceId start) const;
  /// Returns the face nearest to p. Cost: O(log n) on most surfaces.
  FaceId nearest_face(const Vec3& p, FaceId start) const;
  double share(FaceId f) const { return shares_.empty() ? 1 : static_cast<double>(shares_[f.value]); }
  Corners3 corners(FaceId f) const {
    const Triangle& t = faces_[f];
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }

 private:
  double squared_distance_to(FaceId f, const Vec3& p) const;
  /// Returns the same in terms of the tolerance: a face's distance counts as its multiple of the face's share.
  double squared_multiple(FaceId f, const Vec3& p) const {
    const double squared = squared_distance_to(f, p);
    return shares_.empty() ? squared : squared / (share(f) * share(f));
  }
  template <class Measure>
  FaceId walk(FaceId start, double enough, const Measure& measure) const;
  template <class Measure>
  FaceId search(const Vec3& p, double squared, FaceId otherwise, const Measure& measure) const;

  const IdVector<VertexId, Vec3>& positions_;
  const IdVector<FaceId, Triangle>& faces_;
  std::span<const std::uint32_t> twins_;
  std::span<const float> shares_;
  BoxTree<NoTag> tree_;
};

}  // namespace remesh
