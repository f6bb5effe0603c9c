/// The faces of a surface as triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A surface's faces as triangles, polygons split by split_polygon, less their spikes. Looks into the surface: where
/// that has nothing but triangles, they are its own.
class Triangulated {
 public:
  /// The tolerance is in local units. A surface that has been mended has no spikes, and needs none.
  explicit Triangulated(const Surface& surface, RunControl& control, double tolerance = 0);

  /// Has the surface other polygons?
  bool are_split() const { return are_split_; }
  std::size_t size() const { return corners().size() / 3; }
  /// Three a triangle.
  std::span<const VertexId> corners() const { return are_split() ? std::span(corners_) : surface_->corners.items(); }
  Triangle triangle(std::size_t t) const { return {corners()[3 * t], corners()[3 * t + 1], corners()[3 * t + 2]}; }
  /// The face that a triangle is of; ascending.
  FaceId face(std::size_t t) const { return are_split() ? face_[t] : FaceId(t); }
  /// The first triangle of a face.
  std::size_t first_of(FaceId f) const;
  /// By how much the triangles' area is more than the faces'. A flat polygon that crosses itself has the area that its
  /// outline winds around, counted with its sign (Newell); the fan that stands for it covers more. One that is not flat
  /// has no other area than its triangles have. In local units.
  double excess_area() const { return excess_area_; }

 private:
  const Surface* surface_;
  bool are_split_;
  std::vector<VertexId> corners_;
  std::vector<FaceId> face_;
  double excess_area_ = 0;
};

}  // namespace remesh
