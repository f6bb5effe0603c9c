/// Measures how far a place is from planes, as one number.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// The sum of the squared distances of a place from planes, each with a weight.
/// Source: Garland, Heckbert, Surface simplification using quadric error metrics, 1997.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, constant = 0;

  /// Adds the plane through `p` with the unit vector `normal`.
  void add_plane(const Vec3& normal, const Vec3& p, double plane_weight) {
    const double d = -dot(normal, p);
    const Vec3 n = plane_weight * normal;
    xx += n.x * normal.x, xy += n.x * normal.y, xz += n.x * normal.z;
    yy += n.y * normal.y, yz += n.y * normal.z, zz += n.z * normal.z;
    x += n.x * d, y += n.y * d, z += n.z * d;
    constant += plane_weight * d * d;
  }
  void add(const Quadric& q) {
    xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
    x += q.x, y += q.y, z += q.z, constant += q.constant;
  }
  /// Returns the sum of the weights.
  double weight() const { return xx + yy + zz; }
  double at(const Vec3& p) const {
    return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
           p.z * (zz * p.z + 2 * z) + constant;
  }
  /// Returns the place of the smallest value. Where planes leave it open, the place is near `middle`.
  Vec3 optimum(const Vec3& middle) const {
    constexpr double kPull = 1e-3;  // the weight of a plane across each axis through the middle
    const double pull = kPull * weight();
    const double a = xx + pull, d = yy + pull, f = zz + pull;
    // The equations are about the way from the middle, which is short, so that little is lost by rounding.
    const Vec3 right{-(xx * middle.x + xy * middle.y + xz * middle.z + x),
                     -(xy * middle.x + yy * middle.y + yz * middle.z + y),
                     -(xz * middle.x + yz * middle.y + zz * middle.z + z)};
    const Vec3 r0{a, xy, xz}, r1{xy, d, yz}, r2{xz, yz, f};
    const Vec3 c0 = cross(r1, r2);
    const double determinant = dot(r0, c0);
    if (!(determinant > 0)) return middle;
    const Vec3 way = right.x * c0 + right.y * cross(r2, r0) + right.z * cross(r0, r1);
    return middle + (1 / determinant) * way;
  }
};

}  // namespace remesh
