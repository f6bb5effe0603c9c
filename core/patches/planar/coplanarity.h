/// The tests of coplanarity for single faces, for neighbours, and for faces and planes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/run_control.h"
#include "core/base/tolerance.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"
#include "core/patches/planar/regions.h"

namespace remesh {

/// The corners of a region are within this fraction of the tolerance on either side of the plane. So input and output,
/// which are both in this slab, are never further apart than the tolerance. While the plane is still being fitted, the
/// whole tolerance is allowed.
inline constexpr double kHalfSlab = 0.5;

/// The part of the root mean square distance from a fitted plane that may be rounding, in local units.
inline constexpr double kFitRounding = 1e-7;

/// The plane tolerance on a rung of the ladder, in the units of `tolerance`. `floor` is kToleranceFloor in these units.
double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor);

/// The rule of coplanarity, applied to the faces of one surface. Lengths are in local units.
class Coplanarity {
 public:
  Coplanarity(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
              const CoplanarityRule& rule, RunControl& control);

  double tolerance(FaceId f) const { return tolerance_at_[(*rule_.rung)[f]]; }
  bool is_thin(FaceId f) const { return geometry_[f].height < kThinFace * tolerance(f); }
  /// Returns whether the ladder has made the face a patch of its own.
  bool is_single(FaceId f) const { return (*rule_.rung)[f] == kSingleFace; }

  bool are_in_one_zone(FaceId f, FaceId g) const { return rule_.zone->empty() || (*rule_.zone)[f] == (*rule_.zone)[g]; }

  /// Returns whether a region may grow from one face to the other over their edge. h is a half-edge of that edge, and
  /// has a twin.
  bool may_be_joined(std::uint32_t h, FaceId f, FaceId g) const {
    return are_in_one_zone(f, g) && (*rule_.rung)[g] == (*rule_.rung)[f] &&
           (are_flat(f, g) || (!are_apart(f, g) && !is_bend(h)));
  }

  /// Returns whether the two triangles at an edge bend by more than kUnquestionedBend and by more than printing can
  /// explain. If they do, no four points of one plane would be printed as their corners. (To first order, a move of a
  /// corner along an axis changes the volume of the four corners by the area of the opposite face along that axis.)
  bool is_bend(std::uint32_t h) const;

  double height(FaceId f) const { return geometry_[f].height; }

  /// The distance of a face's farthest corner from a plane.
  double distance(FaceId f, const Plane& plane) const {
    double farthest = 0;
    for (const VertexId v : surface_.face(f))
      farthest = std::max(farthest, std::fabs(plane.distance(surface_.local[v])));
    return farthest;
  }

  /// Returns whether the normal of a face agrees with a plane's normal, up to the angle that the tolerance explains.
  bool has_normal(FaceId f, const Vec3& normal, double tol) const {
    if (is_thin(f)) return true;
    const double cosine = dot(geometry_[f].normal, normal);
    return cosine > 0 && 1 - cosine * cosine <= squared_sine(f, tol);
  }
  /// A lower bound on how far the unit normal may move before has_normal becomes false for a face.
  double normal_to_spare(FaceId f, const Vec3& normal, double tol) const {
    if (is_thin(f)) return HUGE_VAL;
    constexpr double kRounding = 1e-15;  // rounding error of a squared sine
    const double cosine = dot(geometry_[f].normal, normal);
    return std::sqrt(std::min(1.0, squared_sine(f, tol))) - std::sqrt(std::max(0.0, 1 - cosine * cosine) + kRounding);
  }

  /// Returns whether a face lies in a plane, within a tolerance.
  bool fits(FaceId f, const Plane& plane, double tol) const {
    double deviation = 0;
    return fits(f, plane, tol, deviation);
  }
  /// Returns whether a face lies in a plane, as above. If it does, raises `deviation` to at least the distance of the
  /// face's farthest corner.
  bool fits(FaceId f, const Plane& plane, double tol, double& deviation) const {
    // The normal is tested first, because that is one test, while a large polygon with many neighbours has many
    // corners.
    if (!has_normal(f, plane.normal, tol)) return false;
    double farthest = deviation;
    for (const VertexId v : surface_.face(f)) {
      const double distance = std::fabs(plane.distance(surface_.local[v]));
      if (distance > tol) return false;
      farthest = std::max(farthest, distance);
    }
    deviation = farthest;
    return true;
  }

 private:
  /// Neighbours are not apart if the cosine of the angle between their normals is above this, as it is in most cases.
  static constexpr double kNearlyFlat = 0.9999;

  /// The square of the sine of the max angle between a face and its plane. The angle is the one that the distance
  /// explains, and at least the one that the normal tolerance per component allows.
  double squared_sine(FaceId f, double tol) const {
    const double sine = std::max(rule_.normal_tolerance, kThinFace * tol / geometry_[f].height);
    return 3 * sine * sine;
  }

  /// Returns whether the normals of neighbours, given the cosine of their angle, differ so little that no test for a
  /// bend is needed. The normal tolerance per component is allowed in any case.
  bool is_unquestioned(double cosine) const {
    return 1 - cosine <= std::max(kUnquestionedBend, 1.5 * rule_.normal_tolerance * rule_.normal_tolerance);
  }

  /// Returns whether two neighbours have nearly the same normal, as most neighbours do. Then they are not apart, and
  /// there is no bend.
  bool are_flat(FaceId f, FaceId g) const {
    const double cosine = dot(geometry_[f].normal, geometry_[g].normal);
    return cosine > kNearlyFlat && is_unquestioned(cosine);
  }

  /// Returns whether two neighbours turn so far against each other that no plane fits both.
  bool are_apart(FaceId f, FaceId g) const;

  const Surface& surface_;
  const Adjacency& adjacency_;
  const FaceGeometries& geometry_;
  const CoplanarityRule& rule_;
  std::array<double, kSingleFace + 1> tolerance_at_{};  ///< by rung
};

}  // namespace remesh
