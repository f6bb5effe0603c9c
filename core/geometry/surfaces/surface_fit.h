/// Fits surfaces of the kinds with a closed formula to points.
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// A place of a facet: its middle, and its unit normal.
struct FacetPlace {
  Vec3 middle;
  Vec3 normal;
};

/// The number of free parameters of a kind.
int parameter_count(SurfaceKind kind);

/// The following functions make a first guess, with which `fit_from` begins. Each returns nothing if the points or
/// normals do not determine a surface of the kind.
std::optional<AnalyticSurface> guess_sphere(std::span<const Vec3> points);
/// Input: the direction of the axis.
std::optional<AnalyticSurface> guess_cylinder(std::span<const Vec3> points, const Vec3& axis);
std::optional<AnalyticSurface> guess_cylinder(std::span<const Vec3> points, std::span<const FacetPlace> facets);
/// Holds: the planes of a cone's facets meet in its apex.
std::optional<AnalyticSurface> guess_cone(std::span<const Vec3> points, std::span<const FacetPlace> facets);
/// Input: the axis.
std::optional<AnalyticSurface> guess_torus(std::span<const Vec3> points, const Vec3& origin, const Vec3& axis);
/// Holds: the normals of a surface of revolution meet its axis.
std::optional<AnalyticSurface> guess_torus(std::span<const Vec3> points, std::span<const FacetPlace> facets);

/// The root of the mean of the squares of the points' distances at which a fit may end early.
struct FitGoal {
  double good = 0;             ///< the fit is as good as it need be
  double hopeless = HUGE_VAL;  ///< a fit that remains above this is of no use
  int max_steps = 30;
  double settled = 1e-6;  ///< the fit ends where a step changes the sum of the squares by this part or less
  /// Begin near `start`, at rounded parameters. Then starts that differ by rounding have the same result, bit for bit.
  bool is_canonical = false;
  const RunControl* control = nullptr;  ///< stops the fit, unless it is null
};

/// Improves a surface until the sum of the squares of the points' distances from it is a minimum.
/// Output: nothing if the fit ends in no valid surface, for example with an infinite radius, or stays above `hopeless`.
/// Holds:  the result depends on the order of the points only by rounding.
/// Errors: kCancelled, kTimeout - asked to stop through the goal's control.
/// Cost:   some passes over the points.
/// Source: the method of D. Marquardt, An Algorithm for Least-Squares Estimation of Nonlinear Parameters, 1963.
std::optional<AnalyticSurface> fit_from(const AnalyticSurface& start, std::span<const Vec3> points,
                                        const FitGoal& goal = {});

}  // namespace remesh
