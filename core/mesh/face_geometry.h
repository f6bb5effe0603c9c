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
  Vec3 centre;  ///< mean of the corners
  double area = 0;
  /// The least height of a triangle; of a polygon, twice its area over its longest extent. What distance from a plane
  /// says about the face's angle is that distance over this.
  double height = 0;
};

IdVector<FaceId, FaceGeometry> face_geometry(const Surface& surface, RunControl& control);

}  // namespace remesh
