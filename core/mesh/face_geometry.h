/// Normals, areas and heights of the faces of a surface.
#pragma once

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"

namespace remesh {

/// In local units.
struct FaceGeometry {
  Vec3 normal;  ///< unit; where rounding leaves no direction, some direction across the longest side
  double area = 0;
  /// The least height of a triangle; of a polygon, twice its area over its longest extent. What distance from a plane
  /// says about the face's angle is that distance over this.
  double height = 0;
};

using FaceGeometries = IdVector<FaceId, FaceGeometry, LeftUnset<FaceGeometry>>;

/// The mean of a face's corners.
inline Vec3 face_centre(const Surface& surface, FaceId f) {
  const auto loop = surface.face(f);
  const Vec3 origin = surface.local[loop[0]];
  Vec3 sum;
  for (const VertexId v : loop) sum += surface.local[v] - origin;
  return origin + (1.0 / static_cast<double>(loop.size())) * sum;
}

/// Measures every face.
/// Output:  one for each face; of a polygon, by the sum of the cross products around it.
/// Holds:   the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(corners).
FaceGeometries face_geometry(const Surface& surface, RunControl& control);

}  // namespace remesh
