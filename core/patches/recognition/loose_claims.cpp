#include "core/patches/recognition/loose_claims.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/surfaces/surface_fit.h"

namespace remesh {
namespace {

constexpr std::size_t kMinFacets = 8, kMinCornersPerParameter = 2;
constexpr double kMinRise = 8, kMuchNearer = 0.5;
/// The min cosine of the angle between a facet's normal and the surface's normal in its middle.
constexpr double kMinCosine = 0.8;

/// The places of a claim's facets and corners on its surface.
class LooseClaim {
 public:
  LooseClaim(const FacetGraph& graph, const SurfaceClaim& claim, RunControl& control)
      : graph_(graph), claim_(claim), shape_(claim.shape), control_(control) {
    Vec3 sum;
    for (const PatchId p : claim.facets) {
      Vec3 corners;
      double count = 0;
      graph.for_each_corner(p, [&](const Vec3& q) {
        points_.push_back(q);
        corners += q;
        ++count;
      });
      places_.push_back({(1 / count) * corners, graph.normal(p)});
    }
    sort_unique(points_, control);
    for (const Vec3& p : points_) sum += normalized(p - shape_.origin);
    // A sphere has no axis. The middle of the claim takes its place.
    axis_ = shape_.kind == SurfaceKind::kSphere ? normalized(sum) : shape_.axis;
    if (norm_squared(axis_) == 0) axis_ = {0, 0, 1};
    x_ = normalized(cross(axis_, std::fabs(axis_.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    y_ = cross(axis_, x_);
  }

  bool is_proven() {
    const auto parameters = static_cast<std::size_t>(parameter_count(shape_.kind));
    return claim_.facets.size() >= kMinFacets && points_.size() >= kMinCornersPerParameter * parameters && rises() &&
           !is_another_kind_nearer() && fits_by_halves();
  }

 private:
  double deviation_from(const AnalyticSurface& s) const {
    double deviation = 0;
    for (const Vec3& p : points_) deviation = std::max(deviation, std::fabs(s.distance(p)));
    return deviation;
  }

  double angle_around(const Vec3& p) const {
    const Vec3 q = p - shape_.origin;
    return std::atan2(dot(q, y_), dot(q, x_));
  }
  double angle_of_tube(const Vec3& p) const {
    const Vec3 q = p - shape_.origin;
    const double z = dot(q, axis_);
    return std::atan2(z, norm(q - z * axis_) - shape_.radius);
  }

  /// Returns the largest gap between some angles, as a part of a full turn, and where the gap ends.
  std::pair<double, double> largest_gap(std::vector<double> angles) const {
    sort_stoppable(angles.begin(), angles.end(), control_);
    double gap = angles.front() + 2 * std::numbers::pi - angles.back(), end = angles.front();
    for (std::size_t i = 1; i < angles.size(); ++i)
      if (angles[i] - angles[i - 1] > gap) {
        gap = angles[i] - angles[i - 1];
        end = angles[i];
      }
    return {gap, end};
  }

  template <class Angle>
  double sweep(const Angle& angle) const {
    std::vector<double> angles;
    for (const Vec3& p : points_) angles.push_back(angle(p));
    return 2 * std::numbers::pi - largest_gap(std::move(angles)).first;
  }

  /// Returns whether the claim rises far enough in each direction in which its surface bends, so that the bend is
  /// certain.
  bool rises() const {
    const double min_rise = kMinRise * claim_.deviation;
    const auto rise = [](double radius, double sweep) {
      return radius * (1 - std::cos(std::min(sweep, 2 * std::numbers::pi) / 2));
    };
    if (shape_.kind == SurfaceKind::kSphere) {
      double cosine = 1;
      for (const Vec3& p : points_) cosine = std::min(cosine, dot(normalized(p - shape_.origin), axis_));
      return shape_.radius * (1 - cosine) >= min_rise;
    }
    const double around = sweep([&](const Vec3& p) { return angle_around(p); });
    double radius = 0;
    for (const Vec3& p : points_) {
      const Vec3 q = p - shape_.origin;
      radius = std::max(radius, norm(q - dot(q, axis_) * axis_));
    }
    if (!(std::cos(shape_.half_angle) * rise(radius, around) >= min_rise)) return false;
    return shape_.kind != SurfaceKind::kTorus ||
           rise(shape_.minor_radius, sweep([&](const Vec3& p) { return angle_of_tube(p); })) >= min_rise;
  }

  /// Returns whether all facets look as a surface does in their middles. A torus whose tube is highest at the corners
  /// of a ring is near to all corners, however badly it fits, but its normals differ.
  bool faces_as(const AnalyticSurface& s) const {
    bool faces = true;
    for (const FacetPlace& place : places_) {
      const Vec3 normal = s.normal(place.middle);
      faces = faces && std::fabs(dot(normal, place.normal)) >= kMinCosine;
    }
    return faces;
  }

  /// Returns whether a kind with more parameters is much nearer to all corners.
  bool is_another_kind_nearer() const {
    const auto is_nearer = [&](const std::optional<AnalyticSurface>& guess) {
      if (!guess || parameter_count(guess->kind) <= parameter_count(shape_.kind)) return false;
      const auto fitted = fit_from(*guess, points_, {.control = &control_});
      return fitted && faces_as(*fitted) && deviation_from(*fitted) < kMuchNearer * claim_.deviation;
    };
    if (shape_.kind == SurfaceKind::kTorus) return false;
    return is_nearer(guess_cylinder(points_, places_)) || is_nearer(guess_cone(points_, places_)) ||
           is_nearer(guess_torus(points_, places_)) ||
           (shape_.kind != SurfaceKind::kSphere && is_nearer(guess_torus(points_, shape_.origin, shape_.axis)));
  }

  /// Returns whether both halves of the claim, in each direction, have the surface of the whole.
  bool fits_by_halves() const {
    std::vector<double> around, along;
    for (const FacetPlace& place : places_) {
      around.push_back(angle_around(place.middle));
      along.push_back(shape_.kind == SurfaceKind::kTorus ? angle_of_tube(place.middle)
                                                         : dot(place.middle - shape_.origin, axis_));
    }
    unroll(around);
    if (shape_.kind == SurfaceKind::kTorus) unroll(along);
    return fits_by_halves(around) && fits_by_halves(along);
  }

  /// Lets angles ascend from the end of their largest gap.
  void unroll(std::vector<double>& angles) const {
    const double end = largest_gap(angles).second;
    for (double& a : angles)
      if (a < end) a += 2 * std::numbers::pi;
  }

  bool fits_by_halves(const std::vector<double>& places) const {
    const auto [low, high] = std::minmax_element(places.begin(), places.end());
    const double middle = (*low + *high) / 2;
    for (const bool is_upper : {false, true}) {
      std::vector<Vec3> half;
      for (std::size_t i = 0; i < places.size(); ++i)
        if ((places[i] > middle) == is_upper)
          graph_.for_each_corner(claim_.facets[i], [&](const Vec3& q) { half.push_back(q); });
      // A claim of one band has no halves along it.
      if (half.size() < kMinCornersPerParameter * static_cast<std::size_t>(parameter_count(shape_.kind))) continue;
      sort_unique(half, control_);
      const auto fitted = fit_from(shape_, half, {.control = &control_});
      if (!fitted || !(deviation_from(*fitted) <= claim_.tolerance)) return false;
    }
    return true;
  }

  const FacetGraph& graph_;
  const SurfaceClaim& claim_;
  const AnalyticSurface& shape_;
  RunControl& control_;
  std::vector<Vec3> points_;        ///< the corners, each once, in order
  std::vector<FacetPlace> places_;  ///< one per facet
  Vec3 axis_, x_, y_;
};

}  // namespace

bool is_loose_claim_proven(const FacetGraph& graph, const SurfaceClaim& claim, RunControl& control) {
  return LooseClaim(graph, claim, control).is_proven();
}

}  // namespace remesh
