/// What the rule of coplanarity says of faces, of neighbours and of faces and planes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/tolerance.h"
#include "core/patches/coplanar_regions.h"

namespace remesh {

/// Faces are held within this part of the tolerance on either side of the plane, so that input and output, both in that
/// band, are never further apart than the tolerance. While the plane is still being fitted all of it is allowed.
inline constexpr double kBand = 0.5;

/// What may be rounding of a fitted plane's root mean square distance, in local units.
inline constexpr double kFitRounding = 1e-7;

/// Lengths are in local units.
class Coplanarity {
 public:
  Coplanarity(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
              const CoplanarityRule& rule, RunControl& control);

  double tolerance(FaceId f) const { return tolerance_at_[(*rule_.rung)[f]]; }
  bool is_thin(FaceId f) const { return geometry_[f].height < kThinFace * tolerance(f); }
  /// Has the ladder put it alone?
  bool is_single(FaceId f) const { return (*rule_.rung)[f] == kSingleFace; }

  bool are_in_one_zone(FaceId f, FaceId g) const { return rule_.zone->empty() || (*rule_.zone)[f] == (*rule_.zone)[g]; }

  /// May a region grow from one to the other over their edge, of which h is a half-edge with a twin?
  bool may_be_joined(std::uint32_t h, FaceId f, FaceId g) const {
    return are_in_one_zone(f, g) && (*rule_.rung)[g] == (*rule_.rung)[f] &&
           (are_flat(f, g) || (!are_apart(f, g) && !is_bend(h)));
  }

  /// Whether the two triangles at an edge bend by more than kUnquestionedBend and than printing can do: then no four
  /// corners that are printed as theirs lie in one plane. (To first order the volume of the four changes by the faces'
  /// areas along each axis.)
  bool is_bend(std::uint32_t h) const;

  double height(FaceId f) const { return geometry_[f].height; }

  /// Of a face's farthest corner from a plane.
  double distance(FaceId f, const Plane& plane) const {
    double farthest = 0;
    for (const VertexId v : surface_.face(f))
      farthest = std::max(farthest, std::fabs(plane.distance(surface_.local[v])));
    return farthest;
  }

  /// Does a face look along a plane's normal, as far as the tolerance explains what it turns against it?
  bool has_normal(FaceId f, const Vec3& normal, double tol) const {
    if (is_thin(f)) return true;
    const double cosine = dot(geometry_[f].normal, normal);
    return cosine > 0 && 1 - cosine * cosine <= squared_sine(f, tol);
  }
  /// By how much at least the unit normal that a face looks along may change and the face still does.
  double normal_to_spare(FaceId f, const Vec3& normal, double tol) const {
    if (is_thin(f)) return HUGE_VAL;
    constexpr double kRounding = 1e-15;  // of the square of a sine
    const double cosine = dot(geometry_[f].normal, normal);
    return std::sqrt(std::min(1.0, squared_sine(f, tol))) - std::sqrt(std::max(0.0, 1 - cosine * cosine) + kRounding);
  }

  /// Is a face in a plane, to a tolerance?
  bool fits(FaceId f, const Plane& plane, double tol) const {
    double deviation = 0;
    return fits(f, plane, tol, deviation);
  }
  /// The same, and raises `deviation` to the distance of its farthest corner, if it is.
  bool fits(FaceId f, const Plane& plane, double tol, double& deviation) const {
    // The normal first: it is one test, where a large polygon with many neighbours has many corners.
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
  /// Neighbours whose normals have more than this cosine, as most have, are not apart: no need to look closer.
  static constexpr double kNearlyFlat = 0.9999;

  /// The square of the sine of the angle that a face may have to its plane: what the distance explains; the floor is
  /// per component of the normal.
  double squared_sine(FaceId f, double tol) const {
    const double sine = std::max(rule_.normal_tolerance, kThinFace * tol / geometry_[f].height);
    return 3 * sine * sine;
  }

  /// Whether neighbours whose normals have this cosine turn so little that no bend is looked for; the floor, per
  /// component of the normal, is granted in any case.
  bool is_unquestioned(double cosine) const {
    return 1 - cosine <= std::max(kUnquestionedBend, 1.5 * rule_.normal_tolerance * rule_.normal_tolerance);
  }

  /// Whether two neighbours look the same way, as most do: then they are neither apart nor is there a bend.
  bool are_flat(FaceId f, FaceId g) const {
    const double cosine = dot(geometry_[f].normal, geometry_[g].normal);
    return cosine > kNearlyFlat && is_unquestioned(cosine);
  }

  /// Whether two neighbours turn so far against each other that no plane fits both.
  bool are_apart(FaceId f, FaceId g) const;

  const Surface& surface_;
  const Adjacency& adjacency_;
  const FaceGeometries& geometry_;
  const CoplanarityRule& rule_;
  std::array<double, kSingleFace + 1> tolerance_at_{};  ///< each rung
};

}  // namespace remesh
