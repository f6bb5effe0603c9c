/// The curves of patch boundaries.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// A part of a patch boundary between two vertices that stay. It is a small value. Places on it are parameters from 0
/// to 1, in proportion to the length of the way from its first end.
class BoundaryCurve {
 public:
  static BoundaryCurve line(const Vec3& from, const Vec3& to) { return {from, to}; }

  double length() const { return norm(to_ - from_); }  ///< model units

  /// Returns the position at a parameter. It is computed from the nearer end, so both ends are met exactly.
  Vec3 position(double t) const { return t <= 0.5 ? from_ + t * (to_ - from_) : to_ + (1 - t) * (from_ - to_); }

 private:
  BoundaryCurve(const Vec3& from, const Vec3& to) : from_(from), to_(to) {}

  Vec3 from_, to_;
};

}  // namespace remesh
