/// Maps a piece of a curved surface into the plane and back.
#pragma once

#include "core/base/vec.h"
#include "core/geometry/planes/frame.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// The piece of a surface that a map is made for.
struct MappedPiece {
  /// A point of the surface in the middle of the piece. The map is cut open on the other side of the axis.
  Vec3 middle;
  /// The facets' outside is where the distances from the surface are negative, as in a hole.
  bool is_concave = false;
};

/// A map between a surface and a plane that keeps angles. It is a small value. A cylinder and a cone are unrolled, so
/// that lengths stay, too. A sphere is projected from the point opposite to the middle of the piece (stereographic
/// projection). A torus is laid out in the angle around its axis and in the integral of ds / rho along its tube, where
/// rho is the distance from the axis. A curve that is counter-clockwise in the plane is counter-clockwise on the
/// surface, seen from the facets' outside.
/// Source: M. do Carmo, Differential Geometry of Curves and Surfaces, 1976, sections 4-2 and 4-3.
class SurfaceMap {
 public:
  SurfaceMap() = default;
  /// Input: a cylinder, cone, sphere, or a torus. The piece does not touch the axis of a torus. All lengths have the
  /// same unit.
  SurfaceMap(const AnalyticSurface& shape, const MappedPiece& piece);

  /// Returns this map with the plane of a cylinder or a cone squeezed along the rulings, which makes them short. It
  /// does not keep angles. A Delaunay triangulation there joins points that are nearest around the axis, so its edges
  /// run along the rulings, and the surface turns little along them. A cone is laid out in the angle around its axis
  /// and in the distance from its apex. The maps of other surfaces do not change.
  SurfaceMap squeezed() const;
  /// Returns whether lengths along rulings are squeezed. `squeezed` does not do this for all surfaces.
  bool is_squeezed() const { return squeeze_ != 1; }

  /// Returns whether there is a map for that surface.
  static bool can_map(const AnalyticSurface& shape);

  /// Returns the place in the plane of the surface's point that is nearest to `p`.
  Vec2 flat(const Vec3& p) const;
  /// Returns the point of the surface at a place of the plane.
  Vec3 point(Vec2 q) const;
  /// Returns the unit normal at a place, on the facets' outside.
  Vec3 normal(Vec2 q) const;
  /// Returns the length on the surface of a short way at a place, per length of that way in the plane. In a squeezed
  /// map, it is that of a way around the axis.
  double stretch(Vec2 q) const;

  /// The coordinates of a place around the axis.
  struct Around {
    double angle;  ///< around the axis, 0 at the middle of the piece, in radians
    /// The integral of ds / rho along the surface, away from the middle. A step of it is as long on the surface as the
    /// same step of the angle there.
    double way;
  };
  /// Returns whether the surface has an axis, so that the next two functions have a meaning.
  bool has_axis() const { return shape_.kind != SurfaceKind::kSphere; }
  Around around(const Vec3& p) const;
  /// Returns the distance of a point from the axis.
  double radius(const Vec3& p) const;
  Vec3 point(const Around& place) const;

  const AnalyticSurface& shape() const { return shape_; }
  /// Returns three axes: the direction of the middle from the axis, and the axis itself as the last one. For a sphere
  /// the last one is the direction of the middle.
  const Axes& axes() const { return axes_; }
  double side() const { return side_; }

 private:
  double tube_way(double angle) const;
  double tube_angle(double way) const;

  AnalyticSurface shape_;
  Axes axes_;
  double side_ = 1;          ///< 1 if the facets' outside is where distances are positive, otherwise -1
  double sine_ = 0;          ///< cone: of the half angle
  double cosine_ = 1;        ///< cone: of the half angle
  double middle_way_ = 0;    ///< torus: tube_way of the middle
  double middle_angle_ = 0;  ///< torus: the angle of the middle around the tube, 0 where the tube is farthest out
  double unit_ = 1;          ///< torus, squeezed cone: the distance of the middle from the axis
  double squeeze_ = 1;       ///< lengths along rulings are multiplied by this
};

}  // namespace remesh
