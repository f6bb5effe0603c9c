/// The faces of a surface as triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The faces of a surface as triangles. Polygons are split by split_polygon, without their spikes. If the surface has
/// only triangles, this refers to them and does not copy them.
class Triangulated {
 public:
  /// The tolerance is in local units. A mended surface has no spikes, and needs no tolerance.
  explicit Triangulated(const Surface& surface, RunControl& control, double tolerance = 0);

  /// Returns whether the surface has polygons other than triangles.
  bool are_split() const { return are_split_; }
  std::size_t size() const { return corners().size() / 3; }
  /// The corners of the triangles, three each.
  std::span<const VertexId> corners() const { return are_split() ? std::span(corners_) : surface_->corners.items(); }
  Triangle triangle(std::size_t t) const { return {corners()[3 * t], corners()[3 * t + 1], corners()[3 * t + 2]}; }
  /// The face to which a triangle belongs. It never decreases with `t`.
  FaceId face(std::size_t t) const { return are_split() ? face_[t] : FaceId(t); }
  /// The first triangle of a face.
  std::size_t first_of(FaceId f) const;
  /// The area of the triangles minus the area of the faces, in local units. A flat polygon that crosses itself has the
  /// area around which its outline winds, counted with its sign (Newell), while the fan that stands for it covers more.
  /// The area of a polygon that is not flat is the area of its triangles.
  double excess_area() const { return excess_area_; }

 private:
  const Surface* surface_;
  bool are_split_;
  std::vector<VertexId> corners_;
  std::vector<FaceId> face_;
  double excess_area_ = 0;
};

}  // namespace remesh
