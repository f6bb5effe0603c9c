#include "core/refinement/segments/column_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/bisection.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

using Around = SurfaceMap::Around;

/// The max step along a column, as a part of two column widths. With the factor 1, edges along the columns and edges
/// across two of them would be equally long.
constexpr double kStepOfColumns = 0.97;
/// Pieces of the boundary run around the axis if their ends differ along the axis by less than this part of a column.
constexpr double kAcross = 1e-3;
/// Rounding must not decide whether a column is on the border of the patch.
constexpr double kColumnRounding = 1e-9;

/// Finds the columns and rows of a patch.
class ColumnLayout {
 public:
  ColumnLayout(const CurvedChart& chart, std::span<const Vec3> vertices, RunControl& control)
      : chart_(chart), check_(control) {
    double largest = 0;
    for (const Vec3& v : vertices) {
      check_();
      largest = std::max(largest, chart_.map().radius(v));
    }
    // Near the apex of a cone, columns are too close to each other.
    constexpr double kNearApex = 0.25;
    bool has_apex = false;
    for (const Vec3& v : vertices) {
      check_();
      if (chart_.map().radius(v) < kNearApex * largest) {
        has_apex = chart_.map().shape().kind == SurfaceKind::kCone;
        continue;
      }
      const Around at = chart_.map().around(v);
      if (!std::isfinite(at.way)) continue;
      low_ = {std::min(low_.angle, at.angle), std::min(low_.way, at.way)};
      high_ = {std::max(high_.angle, at.angle), std::max(high_.way, at.way)};
    }
    // No other vertex may be between the rim and the apex. So columns begin where they are far enough apart.
    if (has_apex)
      low_.way = std::min(low_.way, high_.way + std::log(kNearApex) / std::sin(chart_.map().shape().half_angle));
  }

  ColumnGrid grid(std::span<const std::array<Vec3, 2>> sides) {
    ColumnGrid result;
    if (!(low_.angle < high_.angle && low_.way < high_.way)) return result;
    const double widest = widest_turn();
    fit_to_boundary(widest, sides);
    const double step = longest_step();
    result.start = start_;
    result.width = width_;
    result.first = std::ceil((low_.angle - start_) / width_ - kColumnRounding);
    result.last = std::floor((high_.angle - start_) / width_ + kColumnRounding);
    // Rows fit between the lowest and the highest place. A column has every second row.
    result.rows = std::max(1.0, std::ceil((high_.way - low_.way) / (step / 2) * (1 - 1e-9)));
    result.row = (high_.way - low_.way) / result.rows;
    result.low = low_.way;
    return result;
  }

 private:
  bool is_bent(const Around& a, const Around& b) const {
    const SurfaceMap& map = chart_.map();
    return chart_.is_bent(chart_.space_point(map.point(a)), chart_.space_point(map.point(b)));
  }
  /// Returns whether an edge with these steps is bent at any of the tested places.
  bool is_bent(double turn, double way) const {
    constexpr int kPlaces = 8;
    for (int i = 0; i <= kPlaces; ++i) {
      const double middle = low_.way + (high_.way - low_.way) * i / kPlaces;
      if (is_bent(Around{-turn / 2, middle - way / 2}, Around{turn / 2, middle + way / 2})) return true;
    }
    return false;
  }
  double widest_turn() const {
    // Edges from one column to the next also go half a step along the axis.
    return largest_allowed(std::numbers::pi / 2, [&](double turn) {
      return is_bent(turn, 0) || (is_doubly_curved() && is_bent(turn, kStepOfColumns * turn));
    });
  }
  bool is_doubly_curved() const { return chart_.map().shape().kind == SurfaceKind::kTorus; }
  double longest_step() const {
    return largest_allowed(2 * kStepOfColumns * width_,
                           [&](double way) { return is_bent(0, way) || is_bent(width_, way / 2); });
  }

  /// Chooses the columns' width and where they start. Pieces of the boundary around the axis decide it.
  void fit_to_boundary(double widest, std::span<const std::array<Vec3, 2>> sides) {
    width_ = widest;
    start_ = low_.angle;
    double longest = 0;
    Vec3 at;
    for (const auto& [a, b] : sides) {
      check_();
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
    width_ = longest * std::floor(widest / longest * (1 + 1e-9));
    // If their number is even, the columns at both borders of a closed tube's half have the same parity. So the two
    // halves agree on the rows of the points there.
    start_ = chart_.map().around(at).angle;
    start_ += std::ceil((low_.angle - start_) / width_ - kColumnRounding) * width_;
  }

  const CurvedChart& chart_;
  StopCheck check_;
  Around low_{HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL};
  double start_ = 0, width_ = 0;
};

}  // namespace

ColumnGrid column_grid(const CurvedChart& chart, std::span<const Vec3> vertices,
                       std::span<const std::array<Vec3, 2>> sides, RunControl& control) {
  return chart.map().has_axis() ? ColumnLayout(chart, vertices, control).grid(sides) : ColumnGrid{};
}

}  // namespace remesh
