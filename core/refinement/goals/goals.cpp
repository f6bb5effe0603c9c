#include "core/refinement/goals/goals.h"

#include <cmath>
#include <numbers>

namespace remesh {

Goals goals_of(const Options& options, double diagonal) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  constexpr double kDefaultDegrees = 25;
  constexpr double kDefaultGradation = 1.5;
  Goals goals;
  goals.max_edge_length = kUnbounded;
  goals.max_area = kUnbounded;
  goals.max_faces = options.max_output_faces.value_or(std::numeric_limits<std::uint64_t>::max());
  if (!options.refine) return goals;
  goals.min_angle_deg = options.min_angle_deg.value_or(kDefaultDegrees);
  if (options.max_radius_edge_ratio) {
    const double sine = 1 / (2 * *options.max_radius_edge_ratio);
    goals.min_angle_deg = std::min(Goals::kMaxDegrees, std::asin(std::min(1.0, sine)) * 180 / std::numbers::pi);
  }
  goals.max_edge_length = options.max_edge_length.value_or(
      options.max_edge_fraction ? *options.max_edge_fraction * diagonal : goals.max_edge_length);
  goals.max_area = options.max_area.value_or(goals.max_area);
  goals.target_faces = options.target_faces.value_or(0);
  goals.target_edge_length = options.target_edge_length.value_or(0);
  goals.min_edge_length = options.min_edge_length.value_or(0);
  goals.proximity = options.proximity;
  goals.feature_angle_deg = options.feature_angle_deg;
  goals.min_gap = options.defeature_size.value_or(0);
  goals.gradation = options.gradation.value_or(options.proximity > 0 ? kDefaultGradation : 0);
  goals.split_boundaries = options.split_boundaries;
  return goals;
}

void keep_in_proportion(Goals& goals, const Options& options, double diagonal, std::uint64_t triangles) {
  // Each small angle of the input needs some faces, and in an input of few faces they may need hundreds. Without
  // details, there are fewer such angles. Gaps need more faces.
  constexpr std::uint64_t kPerTriangle = 20, kPerTriangleWithGaps = 40, kDetails = 4;
  constexpr std::uint64_t kAlways = 1000, kAlwaysWithGaps = 20000, kAlwaysWithGapsAndCircles = 5000;
  // See experiments.md, Floor of a default answer.
  constexpr double kLowestMinEdge = 0x1p-20;
  if (options.min_edge_length || !options.refine) return;
  goals.min_edge_length = min_edge_of_details(options, goals);
  if (std::isfinite(goals.max_edge_length) || std::isfinite(goals.max_area) || goals.has_target()) return;
  const bool are_details_removed = options.defeature_size.value_or(0) > 0;
  const std::uint64_t per_triangle =
      (goals.proximity > 0 ? kPerTriangleWithGaps : kPerTriangle) / (are_details_removed ? kDetails : 1);
  const std::uint64_t always = !(goals.proximity > 0)                ? kAlways
                               : is_curved_resolution_given(options) ? kAlwaysWithGapsAndCircles
                                                                     : kAlwaysWithGaps;
  goals.faces_without_min_edge = per_triangle * triangles + always;
  goals.lowest_min_edge = std::max(kLowestMinEdge * diagonal, goals.min_edge_length);
}

void keep_apart_in_storage(Goals& goals, const Options& options, double step) {
  // Rounding moves a vertex against the opposite side by up to sqrt(3) steps. A triangle with edges of kSteps steps and
  // an angle of 20 degrees is half as high again, so rounding does not turn the triangle over.
  constexpr double kSteps = 8;
  const double floor = kSteps * step;
  if (options.min_edge_length || !options.refine || !(floor > goals.min_edge_length)) return;
  if (!(2 * floor <= goals.max_edge_length)) return;
  goals.min_edge_length = floor;
  goals.min_edge_of_storage = floor;
  goals.lowest_min_edge = std::max(goals.lowest_min_edge, floor);
}

double min_edge_of_details(const Options& options, const Goals& goals) {
  constexpr double kShareOfDetails = 1.0 / 3;
  if (options.min_edge_length || !options.refine) return 0;
  const double floor = kShareOfDetails * options.defeature_size.value_or(0);
  return 2 * floor <= goals.max_edge_length ? floor : 0;
}

double equilateral_area(double edge) { return std::numbers::sqrt3 / 4 * edge * edge; }
double equilateral_edge(double area) { return std::sqrt(4 / std::numbers::sqrt3 * area); }

}  // namespace remesh
