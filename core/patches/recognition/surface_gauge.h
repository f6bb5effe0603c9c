/// Measures how facets lie on a surface.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"

namespace remesh {

/// A surface whose distances can be computed fast.
class SurfaceGauge {
 public:
  explicit SurfaceGauge(const AnalyticSurface& s)
      : kind_(s.kind),
        origin_(s.origin),
        axis_(s.axis),
        radius_(s.radius),
        minor_radius_(s.minor_radius),
        cosine_(std::cos(s.half_angle)),
        sine_(std::sin(s.half_angle)) {}

  double distance(const Vec3& p) const {
    const Vec3 q = p - origin_;
    if (kind_ == SurfaceKind::kSphere) return std::sqrt(norm_squared(q)) - radius_;
    const double z = dot(q, axis_);
    const double r = std::sqrt(norm_squared(q - z * axis_));
    if (kind_ == SurfaceKind::kCylinder) return r - radius_;
    if (kind_ == SurfaceKind::kCone) return r * cosine_ - z * sine_;
    const double u = r - radius_;
    return std::sqrt(u * u + z * z) - minor_radius_;
  }

  struct Measures {
    double distance;
    double facing;
  };
  /// Returns the distance of a point, and the cosine of the angle between a direction and the surface's normal there.
  /// Within `tolerance` of an axis, where there is no normal, the cosine is 1.
  Measures measure(const Vec3& p, const Vec3& direction, double tolerance) const {
    const Vec3 q = p - origin_;
    if (kind_ == SurfaceKind::kSphere) {
      const double r = std::sqrt(norm_squared(q));
      return {r - radius_, dot(q, direction) / r};
    }
    const double z = dot(q, axis_);
    const Vec3 w = q - z * axis_;
    const double r = std::sqrt(norm_squared(w));
    const bool is_on_axis = !(r > 4 * tolerance);
    const double outwards = dot(w, direction) / r;
    if (kind_ == SurfaceKind::kCylinder) return {r - radius_, is_on_axis ? 1 : outwards};
    const double along = dot(axis_, direction);
    if (kind_ == SurfaceKind::kCone)
      return {r * cosine_ - z * sine_, is_on_axis ? 1 : outwards * cosine_ - along * sine_};
    const double u = r - radius_, g = std::sqrt(u * u + z * z);
    return {g - minor_radius_, is_on_axis ? 1 : (u * outwards + z * along) / g};
  }

  /// Returns the normal of the surface at a place near it. It is null within `tolerance` of an axis.
  Vec3 normal(const Vec3& p, double tolerance) const {
    const Vec3 q = p - origin_;
    if (kind_ == SurfaceKind::kSphere) return normalized(q);
    const double z = dot(q, axis_);
    const Vec3 w = q - z * axis_;
    const double r = std::sqrt(norm_squared(w));
    if (!(r > 4 * tolerance)) return {};
    const Vec3 outwards = (1 / r) * w;
    if (kind_ == SurfaceKind::kCylinder) return outwards;
    if (kind_ == SurfaceKind::kCone) return cosine_ * outwards - sine_ * axis_;
    return normalized((r - radius_) * outwards + z * axis_);
  }

 private:
  SurfaceKind kind_;
  Vec3 origin_, axis_;
  double radius_, minor_radius_, cosine_, sine_;
};

/// A few facets determine a surface badly. So corners that are far from these facets may be off by this many tolerances
/// until more facets are found.
inline constexpr double kFirstSlack = 20;

/// Returns the slack with which a growth begins, in tolerances. Where facets are so small that they are hardly off
/// their surface, any smooth surface would fit with much slack. So the slack is a part of that distance.
/// Input: the distance of the first facet from the surface.
double first_slack(double chord_height, double tolerance);

/// The min number of facets of a claim that is believed.
inline constexpr std::size_t kMinFacets = 4, kMinFacetsOfTorus = 6;
constexpr std::size_t min_facets(SurfaceKind kind) {
  return kind == SurfaceKind::kTorus ? kMinFacetsOfTorus : kMinFacets;
}

/// Returns whether the corners of a facet are within a distance of a surface, and the facet faces as the surface does.
/// Input: `side` as of side_of. Within some `tolerance` of its axis, a surface has no normal.
bool is_on(const FacetGraph& graph, const SurfaceGauge& gauge, PatchId p, double allowed, double tolerance, int side);

/// Returns the side of a surface to which the normals of facets point, 1 or -1.
int side_of(const FacetGraph& graph, const SurfaceGauge& gauge, std::span<const PatchId> facets);

/// Returns the largest distance of a facet from a surface in its middle and the middles of its sides.
double chord_height(const FacetGraph& graph, const SurfaceGauge& gauge, PatchId p);

}  // namespace remesh
