/// Normals, areas and heights of the faces of a surface.
#pragma once

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The measures of one face, in local units.
struct FaceGeometry {
  Vec3 normal;  ///< unit length; if rounding leaves no direction, some direction across the longest side
  double area = 0;
  /// The smallest height of a triangle. For a polygon, twice its area over its longest extent. If a corner's distance
  /// from a plane is d, the face's angle to that plane is about d over this.
  double height = 0;
};

using FaceGeometries = IdVector<FaceId, FaceGeometry, DefaultInit<FaceGeometry>>;

/// The mean of a face's corners.
inline Vec3 face_centre(const Surface& surface, FaceId f) {
  const auto loop = surface.face(f);
  const Vec3 origin = surface.local[loop[0]];
  Vec3 sum;
  for (const VertexId v : loop) sum += surface.local[v] - origin;
  return origin + (1.0 / static_cast<double>(loop.size())) * sum;
}

/// Six times the volume between a face and a point, in local units.
inline double six_volumes_below(const Surface& surface, FaceId f, const Vec3& from) {
  const auto loop = surface.face(f);
  const Vec3 a = surface.local[loop[0]] - from;
  double sum = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    sum += dot(a, cross(surface.local[loop[i]] - from, surface.local[loop[i + 1]] - from));
  return sum;
}

/// Measures every face.
/// Output:  one entry for each face. A polygon is measured by the sum of the cross products around it.
/// Holds:   the result has the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(corners).
FaceGeometries face_geometry(const Surface& surface, RunControl& control);

}  // namespace remesh
