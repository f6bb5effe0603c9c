/// Volume and area of a piece of a curved surface, from its boundary alone.
#pragma once

#include <array>

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// Sums up the boundary of a piece of a surface. By the theorems of Gauss and Green, the volume between the piece and a
/// point, and the area of the piece, are integrals along its boundary. Their integrands have closed formulas:
/// let o be the point, n the normal and dA an element of area. The volume is the integral of (x - o) n dA / 3. With o
/// on the axis of a cylinder or in the centre of a sphere, (x - o) n is the radius. With o in the apex of a cone, it
/// is 0. For a torus it depends on the angle around the tube alone.
///
/// The boundary is given as curves. Each of them also has a straight chord between its ends. The fan of straight lines
/// from the middle of the chord to the curve counts to the piece, so that the volume ends at the chords. If a plane
/// cuts the surface in the curve, the fan lies in that plane. If two surfaces meet in it, both get the same fan.
class SurfaceIntegral {
 public:
  static constexpr int kPoints = 17;
  using Curve = std::array<Vec3, kPoints>;
  /// The parameters, from 0 to 1, at which the points of a curve are given. Any smooth parameter will do.
  static const std::array<double, kPoints>& places();

  /// Input: a cylinder, cone, sphere, or a torus that does not touch its axis, in model units; `middle` is a point of
  ///        the surface in the middle of the piece, or any point near a cylinder. The piece reaches neither around the
  ///        whole tube of a torus nor to the point opposite the middle of a sphere, and its boundary does not wind
  ///        around the axis. `unit` is the unit of all results.
  SurfaceIntegral(const AnalyticSurface& shape, const Vec3& middle, double unit);

  /// Adds a part of the boundary. Seen from the side where distances from the surface are positive, the piece is on its
  /// left. If it is on its right, volume and area are negative.
  /// Holds: the error is about 1e-12 of the result for curves that turn by 60 degrees.
  void add(const Curve& curve);

  /// Returns the volume between the point, the piece and the fans at its boundary.
  double volume() const { return volume_; }
  double area() const { return area_; }
  /// Returns the point from which volumes are measured.
  const Vec3& centre() const { return centre_; }

 private:
  double volume_form(const Vec3& p) const;
  double area_form(const Vec3& p) const;
  double tube_angle(const Vec3& p) const;

  AnalyticSurface shape_;
  double unit_;
  Vec3 centre_;
  Vec3 x_, y_, z_;
  double middle_angle_ = 0;  ///< around the tube of a torus
  double volume_ = 0, area_ = 0;
};

}  // namespace remesh
