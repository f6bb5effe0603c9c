#include "core/patches/surface_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kDegrees = 180 / std::numbers::pi;

/// Angles around an axis that facets cover.
class Sweep {
 public:
  Sweep(const AnalyticSurface& shape, double tolerance) : shape_(shape), tolerance_(tolerance) {
    const Vec3& a = shape.axis;
    const double ax = std::fabs(a.x), ay = std::fabs(a.y), az = std::fabs(a.z);
    x_ = normalized(cross(a, ax <= ay && ax <= az ? Vec3{1, 0, 0} : ay <= az ? Vec3{0, 1, 0} : Vec3{0, 0, 1}));
    y_ = cross(a, x_);
  }

  /// Adds the angles between the ends of a side. A side that ends on the axis covers none.
  void add(const Vec3& a, const Vec3& b) {
    if (is_on_axis(a) || is_on_axis(b)) return;
    const double turn = std::remainder(angle(b) - angle(a), kTurn);
    double begin = turn >= 0 ? angle(a) : angle(b);
    begin -= kTurn * std::floor(begin / kTurn);
    const double end = begin + std::fabs(turn);
    covered_.push_back({begin, std::min(end, kTurn)});
    if (end > kTurn) covered_.push_back({0, end - kTurn});
  }

  /// Returns the angle that is covered, in degrees.
  double degrees(RunControl& control) {
    sort_stoppable(covered_.begin(), covered_.end(), control);
    double sum = 0, end = 0;
    for (const auto& [from, to] : covered_) {
      sum += std::max(0.0, to - std::max(from, end));
      end = std::max(end, to);
    }
    // Neighbouring sides meet up to rounding.
    constexpr double kAlmost = 360 - 1e-3;
    return kDegrees * sum > kAlmost ? 360 : kDegrees * sum;
  }

 private:
  bool is_on_axis(const Vec3& p) const {
    const Vec3 q = p - shape_.origin;
    return norm_squared(q - dot(q, shape_.axis) * shape_.axis) <= tolerance_ * tolerance_;
  }
  double angle(const Vec3& p) const { return std::atan2(dot(p - shape_.origin, y_), dot(p - shape_.origin, x_)); }

  const AnalyticSurface& shape_;
  double tolerance_;
  Vec3 x_, y_;
  std::vector<std::pair<double, double>> covered_;
};

/// Returns how far the middle of a side is inside of a surface of revolution. Only sides around the axis tell it.
double ring_height(const AnalyticSurface& shape, const Vec3& a, const Vec3& b, double tolerance) {
  const auto radius = [&](const Vec3& p) {
    const Vec3 q = p - shape.origin;
    return norm(q - dot(q, shape.axis) * shape.axis);
  };
  if (std::fabs(dot(b - a, shape.axis)) > tolerance) return 0;
  return std::fabs(0.5 * (radius(a) + radius(b)) - radius(0.5 * (a + b)));
}

/// Returns the normal of the surface at a corner. That of a surface of revolution stands for its turn around the axis.
Vec3 normal_at(const AnalyticSurface& shape, const Vec3& p) {
  if (shape.kind != SurfaceKind::kRevolution) return shape.normal(p);
  const Vec3 q = p - shape.origin;
  return normalized(q - dot(q, shape.axis) * shape.axis);
}

}  // namespace

FacetMeasures measure_facets(const FacetGraph& graph, const Claim& claim, const AnalyticSurface& shape,
                             double tolerance, RunControl& control) {
  const bool is_revolution = shape.kind == SurfaceKind::kRevolution;
  FacetMeasures result;
  Sweep sweep(shape, tolerance);
  StopCheck check(control);
  double min_cosine = 1;
  for (const PatchId p : claim.facets) {
    check();
    Vec3 sum;
    int count = 0;
    graph.for_each_side(p, [&](const Vec3& a, const Vec3& b, bool is_corner) {
      const Vec3 middle = 0.5 * (a + b);
      const double height = is_revolution ? ring_height(shape, a, b, tolerance) : std::fabs(shape.distance(middle));
      result.chord_height = std::max(result.chord_height, height);
      if (!is_corner && !is_revolution)
        result.chord_height = std::max(result.chord_height, std::fabs(shape.distance(a)));
      if (shape.kind != SurfaceKind::kSphere) sweep.add(a, b);
      const Vec3 n = normal_at(shape, a), m = normal_at(shape, b);
      if (norm_squared(n) > 0 && norm_squared(m) > 0) min_cosine = std::min(min_cosine, dot(n, m));
      sum += a;
      ++count;
    });
    // The middle of a ring is not on it.
    if (graph.may_be_seed(p) && !is_revolution)
      result.chord_height = std::max(result.chord_height, std::fabs(shape.distance((1.0 / count) * sum)));
  }
  result.turn_deg = kDegrees * std::acos(std::clamp(min_cosine, -1.0, 1.0));
  if (shape.kind != SurfaceKind::kSphere) result.sweep_deg = sweep.degrees(control);
  return result;
}

}  // namespace remesh
