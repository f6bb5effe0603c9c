#include "core/refinement/sizes/criteria.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace remesh {
namespace {

/// Refinement aims at angles that are larger than the bound by this number of degrees, because angles are measured in
/// space in the end, on rounded coordinates.
constexpr double kAngleMargin = 0.01;
/// An off-centre lies at kOffCentre times the height at which the new triangle just meets the bound on angles. Lower
/// heights are tried as well, because results then have fewer faces than with the best single height, kOnlyOffCentre.
/// Where sizes vary, only that single height is used: several heights leave more angles near the bound, and the
/// tetrahedra inside thin walls would be worse. See experiments.md, Off-centres.
constexpr double kOffCentre = 0.97;
constexpr double kOnlyOffCentre = 0.85;

SizeGoal size_goal_of(const Goals& goals, const SizeField& sizes) {
  if (!sizes.is_uniform()) return SizeGoal::kVarying;
  const bool is_any = std::isfinite(sizes.largest()) || std::isfinite(goals.max_area);
  return is_any ? SizeGoal::kUniform : SizeGoal::kNone;
}

}  // namespace

Criteria::Criteria(const Goals& goals, const SizeField& field)
    : size_goal(size_goal_of(goals, field)),
      are_lower_places_tried(size_goal != SizeGoal::kVarying),
      are_long_sides_cut_first(size_goal != SizeGoal::kVarying),
      max_area(goals.max_area),
      min_angle_deg(goals.min_angle_deg),
      min_edge_length(goals.min_edge_length),
      sizes(field) {
  // The length for filling is a little smaller, because not all triangles are equilateral.
  area_edge = equilateral_edge(goals.max_area);
  even_size = std::min(field.largest(), 0.95 * area_edge);
  const double bound = goals.min_angle_deg > 0 ? (goals.min_angle_deg + kAngleMargin) * std::numbers::pi / 180 : 0;
  // Without a bound on angles, sizes alone must not make slivers either.
  constexpr double kUsualBound = 20 * std::numbers::pi / 180;
  const double shape = bound > 0 ? bound : kUsualBound;
  tangent = std::tan(bound);
  lens = std::cos(2 * shape) * std::cos(2 * shape);
  off_centre = (are_lower_places_tried ? kOffCentre : kOnlyOffCentre) / (2 * std::tan(shape / 2));
}

}  // namespace remesh
