#include "core/patches/recognition/surface_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/patches/recognition/explained_height.h"

namespace remesh {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kDegrees = 180 / std::numbers::pi;

/// A place around an axis.
struct Place {
  Vec2 across;       ///< relative to the axis
  double order = 0;  ///< ascends with the angle, from 0 to 4
  bool is_on_axis = false;
};

/// Angles around an axis that facets cover.
class Sweep {
 public:
  Sweep(const AnalyticSurface& shape, double tolerance)
      : shape_(shape), tolerance_(tolerance), x_(unit_across(shape.axis)), y_(cross(shape.axis, x_)) {}

  Place place_of(const Vec3& p) const {
    const Vec3 q = p - shape_.origin;
    const Vec2 at{dot(q, x_), dot(q, y_)};
    const double size = std::fabs(at.x) + std::fabs(at.y);
    if (!(size > tolerance_)) return {at, 0, true};
    const double part = at.x / size;
    return {at, at.y >= 0 ? 1 - part : 3 + part, false};
  }

  /// Adds the angles between the ends of a side. A side that ends on the axis, or that runs along it, covers none.
  void add(const Place& a, const Place& b) {
    if (a.is_on_axis || b.is_on_axis) return;
    const double turn = cross(a.across, b.across);
    if (std::fabs(turn) <= 1e-12 * (dot(a.across, a.across) + dot(b.across, b.across))) return;
    const Place &from = turn > 0 ? a : b, &to = turn > 0 ? b : a;
    covered_.push_back({from.order, to.order});
    if (from.order > to.order) {
      covered_.back().second = kFull;
      covered_.push_back({0, to.order});
    }
  }

  /// Returns the angle that is covered, in degrees.
  double degrees(RunControl& control) {
    sort_stoppable(covered_.begin(), covered_.end(), control);
    double gaps = 0, end = 0;
    const auto add_gap = [&](double to) {
      // Neighbouring sides meet, up to rounding.
      if (to > end + 1e-9) gaps += angle_at(to) - angle_at(end);
    };
    for (const auto& [from, to] : covered_) {
      add_gap(from);
      end = std::max(end, to);
    }
    add_gap(kFull);
    return std::clamp(kDegrees * (kTurn - gaps), 0.0, 360.0);
  }

 private:
  static constexpr double kFull = 4;  ///< the order at the end of a full turn

  static double angle_at(double order) {
    if (order >= kFull) return kTurn;
    const double part = order <= 2 ? 1 - order : order - 3;
    const double angle = std::atan2(1 - std::fabs(part), part);
    return order <= 2 ? angle : kTurn - angle;
  }

  const AnalyticSurface& shape_;
  double tolerance_;
  Vec3 x_, y_;
  std::vector<std::pair<double, double>> covered_;
};

/// Returns how far the middle of a side is inside of a surface of revolution. Only sides that run around the axis have
/// such a distance.
double ring_height(const AnalyticSurface& shape, const Vec3& a, const Vec3& b, double tolerance) {
  const auto radius = [&](const Vec3& p) {
    const Vec3 q = p - shape.origin;
    return norm(q - dot(q, shape.axis) * shape.axis);
  };
  if (std::fabs(dot(b - a, shape.axis)) > tolerance) return 0;
  return std::fabs(0.5 * (radius(a) + radius(b)) - radius(0.5 * (a + b)));
}

/// Returns the normal of the surface at a corner. For a surface of revolution, returns the direction away from the
/// axis, which shows only the turn around the axis.
Vec3 normal_at(const AnalyticSurface& shape, const Vec3& p) {
  if (shape.kind != SurfaceKind::kRevolution) return shape.normal(p);
  const Vec3 q = p - shape.origin;
  return normalized(q - dot(q, shape.axis) * shape.axis);
}

}  // namespace

FacetMeasures measure_facets(const FacetGraph& graph, const SurfaceClaim& claim, const AnalyticSurface& shape,
                             double tolerance, RunControl& control) {
  const bool is_revolution = shape.kind == SurfaceKind::kRevolution;
  FacetMeasures result;
  Sweep sweep(shape, tolerance);
  StopCheck check(control);
  std::vector<Vec3> corners;
  double min_cosine = 1;
  for (const PatchId p : claim.facets) {
    check();
    Vec3 last, last_normal;
    corners.clear();
    Place last_place;
    int count = 0;
    graph.for_each_side(p, [&](const Vec3& a, const Vec3& b, bool is_corner) {
      const double height =
          is_revolution ? ring_height(shape, a, b, tolerance) : std::fabs(shape.distance(0.5 * (a + b)));
      result.chord_height = std::max(result.chord_height, height);
      if (!is_corner && !is_revolution)
        result.chord_height = std::max(result.chord_height, std::fabs(shape.distance(a)));
      // Most sides begin where the one before them ends.
      const bool is_next = count > 0 && a == last;
      const Vec3 n = is_next ? last_normal : normal_at(shape, a), m = normal_at(shape, b);
      if (norm_squared(n) > 0 && norm_squared(m) > 0) min_cosine = std::min(min_cosine, dot(n, m));
      if (shape.kind != SurfaceKind::kSphere) {
        const Place end = sweep.place_of(b);
        sweep.add(is_next ? last_place : sweep.place_of(a), end);
        last_place = end;
      }
      last_normal = m;
      last = b;
      if (is_corner) corners.push_back(a);
      ++count;
    });
    // The middle of a ring does not lie on the ring.
    if (!graph.may_be_seed(p) || is_revolution) continue;
    result.explained = std::max(result.explained, explained_height(graph, shape, p));
    // The sum comes in an order that depends on the corners alone.
    std::sort(corners.begin(), corners.end());
    Vec3 sum;
    for (const Vec3& corner : corners) sum += corner;
    const Vec3 middle = (1.0 / static_cast<double>(corners.size())) * sum;
    result.chord_height = std::max(result.chord_height, std::fabs(shape.distance(middle)));
  }
  result.turn_deg = kDegrees * std::acos(std::clamp(min_cosine, -1.0, 1.0));
  if (shape.kind != SurfaceKind::kSphere) result.sweep_deg = sweep.degrees(control);
  return result;
}

}  // namespace remesh
