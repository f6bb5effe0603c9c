#include "core/refinement/column_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

using Around = SurfaceMap::Around;

/// Steps along a column are this part of two columns at most. With the whole of it, edges along the columns and edges
/// across two of them would be equally long.
constexpr double kStepOfColumns = 0.97;
/// Pieces of the boundary run around the axis if their ends differ by less than this part of a column along it.
constexpr double kAcross = 1e-3;

/// The columns and rows of a patch.
class ColumnLayout {
 public:
  ColumnLayout(const WorkingPatch& patch, RunControl& control)
      : patch_(patch), chart_(*patch.chart.curved()), check_(control) {
    double largest = 0;
    const auto radius = [&](std::uint32_t v) { return chart_.map().radius(patch.in_space[v].position); };
    for (std::uint32_t v = 0; v < patch.mesh.vertex_slots(); ++v) {
      check_();
      if (patch.mesh.is_live_vertex(v)) largest = std::max(largest, radius(v));
    }
    // Towards the apex of a cone, columns come too near to each other.
    constexpr double kNearApex = 0.25;
    bool has_apex = false;
    for (std::uint32_t v = 0; v < patch.mesh.vertex_slots(); ++v) {
      check_();
      if (!patch.mesh.is_live_vertex(v)) continue;
      if (radius(v) < kNearApex * largest) {
        has_apex = chart_.map().shape().kind == SurfaceKind::kCone;
        continue;
      }
      const Around at = chart_.map().around(patch.in_space[v].position);
      if (!std::isfinite(at.way)) continue;
      low_ = {std::min(low_.angle, at.angle), std::min(low_.way, at.way)};
      high_ = {std::max(high_.angle, at.angle), std::max(high_.way, at.way)};
    }
    // No other vertex may be between the rim and the apex. So columns begin where they are far enough apart.
    if (has_apex)
      low_.way = std::min(low_.way, high_.way + std::log(kNearApex) / std::sin(chart_.map().shape().half_angle));
  }

  ColumnPlaces places(std::size_t max_points) {
    ColumnPlaces result;
    if (!(low_.angle < high_.angle && low_.way < high_.way)) return result;
    const double widest = widest_turn();
    fit_to_boundary(widest);
    result.columns = {start_, width_};
    const double step = longest_step();
    // Rows fit between the lowest and the highest place. A column has every second row.
    const double rows = std::max(1.0, std::ceil((high_.way - low_.way) / (step / 2) * (1 - 1e-9)));
    const double row = (high_.way - low_.way) / rows;
    const double first = std::ceil((low_.angle - start_) / width_), last = std::floor((high_.angle - start_) / width_);
    if (!((last - first + 1) * (rows / 2 + 1) <= static_cast<double>(max_points))) return result;
    for (double column = first; column <= last; ++column)
      for (double i = std::fmod(std::fabs(column), 2); i <= rows; i += 2) {
        check_();
        const Vec3 position = chart_.map().point(Around{start_ + column * width_, low_.way + i * row});
        const Vec2 place = patch_.chart.to_plane(position);
        result.places.push_back({place, width_ * chart_.map().radius(position) / patch_.chart.scale(place)});
      }
    return result;
  }

 private:
  bool is_bent(const Around& a, const Around& b) const {
    const SurfaceMap& map = chart_.map();
    return chart_.is_bent(chart_.space_point(map.point(a)), chart_.space_point(map.point(b)));
  }
  /// Returns whether an edge with these steps is bent anywhere that is looked at.
  bool is_bent(double turn, double way) const {
    constexpr int kPlaces = 8;
    for (int i = 0; i <= kPlaces; ++i) {
      const double middle = low_.way + (high_.way - low_.way) * i / kPlaces;
      if (is_bent(Around{-turn / 2, middle - way / 2}, Around{turn / 2, middle + way / 2})) return true;
    }
    return false;
  }
  /// Returns the largest number up to `most` for which `is_too_much` is false, to a small part of it.
  template <class Test>
  static double largest(double most, const Test& is_too_much) {
    if (!is_too_much(most)) return most;
    double good = 0, bad = most;
    for (int i = 0; i < 40; ++i) (is_too_much(0.5 * (good + bad)) ? bad : good) = 0.5 * (good + bad);
    return good;
  }

  double widest_turn() const {
    // Edges from column to column also go half a step along the axis.
    return largest(std::numbers::pi / 2, [&](double turn) {
      return is_bent(turn, 0) || (is_doubly_curved() && is_bent(turn, kStepOfColumns * turn));
    });
  }
  bool is_doubly_curved() const { return chart_.map().shape().kind == SurfaceKind::kTorus; }
  double longest_step() const {
    return largest(2 * kStepOfColumns * width_,
                   [&](double way) { return is_bent(0, way) || is_bent(width_, way / 2); });
  }

  /// Chooses the columns' width and where they start. Pieces of the boundary around the axis decide it.
  void fit_to_boundary(double widest) {
    width_ = widest;
    start_ = low_.angle;
    double longest = 0;
    Vec3 at;
    for (std::uint32_t side = 0; side < patch_.mesh.side_count(); ++side) {
      check_();
      const std::uint32_t h = patch_.mesh.half_edge_of_side(side);
      const Vec3& a = patch_.in_space[patch_.mesh.from(h)].position;
      const Vec3& b = patch_.in_space[patch_.mesh.to(h)].position;
      const Around from = chart_.map().around(a), to = chart_.map().around(b);
      const double turn = std::fabs(to.angle - from.angle);
      if (!(std::fabs(to.way - from.way) < kAcross * turn) || turn > widest * (1 + 1e-9)) continue;
      const Vec3& smaller = std::min(a, b);
      const bool is_longer = turn > longest * (1 + 1e-9), is_alike = !is_longer && turn > longest * (1 - 1e-9);
      if (!is_longer && !(is_alike && smaller < at)) continue;
      longest = std::max(longest, turn);
      at = smaller;
    }
    if (longest == 0) {
      // Columns of equal width fill the patch.
      width_ = (high_.angle - low_.angle) / std::ceil((high_.angle - low_.angle) / widest * (1 - 1e-9));
      return;
    }
    start_ = chart_.map().around(at).angle;
    width_ = longest * std::floor(widest / longest * (1 + 1e-9));
  }

  const WorkingPatch& patch_;
  const CurvedChart& chart_;
  StopCheck check_;
  Around low_{HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL};
  double start_ = 0, width_ = 0;
};

}  // namespace

ColumnPlaces column_places(const WorkingPatch& patch, std::size_t max_points, RunControl& control) {
  if (patch.chart.curved() == nullptr || !patch.chart.curved()->map().has_axis()) return {};
  return ColumnLayout(patch, control).places(max_points);
}

}  // namespace remesh
