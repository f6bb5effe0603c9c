/// Measures a face against a torus. Its distance has no closed formula over a face, so it is bounded piece by piece.
#pragma once

#include <span>

#include "core/base/vec.h"
#include "core/verify/model/curved_face.h"

namespace remesh::verification {

/// A torus about the z axis, with its centre at the origin.
struct CentredTorus {
  /// Radius of the circle in the middle of the tube. It is negative if the middle of the tube lies beyond the axis,
  /// seen from the tube's surface.
  double radius = 0;
  double minor_radius = 0;  ///< radius of the tube
  double noise = 0;         ///< a bound on the rounding of a distance
};

/// Measures a flat polygon against a torus.
/// Input:  `normal` - the unit normal of the polygon; `known` - distances of other faces. The polygon is measured no
///         finer than these require.
/// Output: all of CurvedFace but `snapped`. `distance` may exceed both `known` and the true range by a 64th of their
///         width.
/// Cost:   a triangle is cut into no more than 1,024 pieces.
CurvedFace read_torus_face(const CentredTorus& torus, std::span<const Vec3> corners, const Vec3& normal,
                           const Range& known);

}  // namespace remesh::verification
