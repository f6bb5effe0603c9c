#include "core/patches/charts/boundary_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/curved_place.h"
#include "tests/support/invariance.h"

namespace remesh {
namespace {

using test::CurvedPlace;

const CurvedPlace kShaft{SurfaceKind::kCylinder, 2};

AnalyticSurface plane(const Vec3& origin, const Vec3& normal) {
  return {SurfaceKind::kPlane, origin, normalized(normal), 0, 0, 0};
}

/// Two surfaces and two points of the curve where they meet.
struct CurveCase {
  std::string name;
  AnalyticSurface curved;
  std::optional<AnalyticSurface> other;
  Vec3 from, to;
  /// The plane in which the place beside a point of the straight line lies: across the line, or through the axis.
  bool is_circle = false;

  CurveTrace trace() const { return CurveTrace::choose(from, to, curved, other).value(); }
};

std::vector<CurveCase> curve_cases() {
  std::vector<CurveCase> all;
  const AnalyticSurface shaft = kShaft.shape();
  all.push_back({"circle", shaft, plane({0, 0, 3}, {0, 0, 1}), kShaft.point(0.2, 3), kShaft.point(1.3, 3), true});
  // The plane z = x / 2 cuts an ellipse.
  const auto on_ellipse = [](double u) { return kShaft.point(u, 0.5 * 2 * std::cos(u)); };
  all.push_back({"ellipse", shaft, plane({}, {-0.5, 0, 1}), on_ellipse(0.9), on_ellipse(1.9)});
  // A pipe along x with radius 4 is met by the shaft from above.
  const CurvedPlace pipe{SurfaceKind::kCylinder, 4, 0, 0, {}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  const auto on_both = [](double u) {
    const Vec3 flat = kShaft.point(u, 0);
    return Vec3{flat.x, flat.y, std::sqrt(16 - flat.y * flat.y)};
  };
  all.push_back({"two cylinders", shaft, pipe.shape(), on_both(-0.4), on_both(0.8)});
  const CurvedPlace cone{SurfaceKind::kCone, 0, 0, 0.6}, ball{SurfaceKind::kSphere, 3};
  // On the cone, the distance from the apex is 3.
  const double height = 3 * std::cos(0.6);
  all.push_back({"cone in a ball", cone.shape(), ball.shape(), cone.point(1, height), cone.point(2, height), true});
  const CurvedPlace ring{SurfaceKind::kTorus, 5, 1};
  all.push_back({"cut through a torus", ring.shape(), plane({}, {0, 1, 0}), ring.point(0, 0.3), ring.point(0, 1.2)});
  all.push_back({"edge of a torus", ring.shape(), plane({0, 0, 1}, {0, 0, 1}), ring.point(0, std::numbers::pi / 2),
                 ring.point(0.8, std::numbers::pi / 2), true});
  // A hole and the torus of its rounded edge touch each other.
  const CurvedPlace hole{SurfaceKind::kCylinder, 4};
  all.push_back({"rounded edge", hole.shape(), ring.shape(), ring.point(0.1, std::numbers::pi),
                 ring.point(0.7, std::numbers::pi), true});
  all.push_back({"open border of a ball", ball.shape(), {}, ball.point(0.1, -0.2), ball.point(0.9, 0.4)});
  return all;
}

TEST(boundary_curve, a_line_is_straight_and_has_its_ends_exactly) {
  const Vec3 a{0.1, 0.2, 0.3}, b{7.3, -1e-3, 5.0 / 3};
  const BoundaryCurve line = BoundaryCurve::line(a, b);
  EXPECT_EQ(line.position(0), a);
  EXPECT_EQ(line.position(1), b);
  EXPECT_EQ(line.length(), norm(b - a));
  EXPECT_LT(norm(line.position(0.25) - (a + 0.25 * (b - a))), 1e-15);
  EXPECT_LT(norm(line.position(0.75) - (a + 0.75 * (b - a))), 1e-15);
}

TEST(boundary_curve, the_ends_of_a_traced_curve_are_exact_even_if_they_lie_off_the_surfaces) {
  for (const CurveCase& c : curve_cases()) {
    const Vec3 from = c.from + Vec3{1e-6, 2e-6, -1e-6}, to = c.to + Vec3{-3e-6, 0, 1e-6};
    const auto trace = CurveTrace::choose(from, to, c.curved, c.other);
    ASSERT_TRUE(trace.has_value()) << c.name;
    const BoundaryCurve curve = BoundaryCurve::traced(from, to, *trace);
    EXPECT_EQ(curve.position(0), from) << c.name;
    EXPECT_EQ(curve.position(1), to) << c.name;
    EXPECT_LT(std::fabs(c.curved.distance(curve.position(0.5))), 1e-5) << c.name;
  }
}

TEST(boundary_curve, traced_places_lie_on_both_surfaces_beside_their_line) {
  for (const CurveCase& c : curve_cases()) {
    SCOPED_TRACE(c.name);
    const CurveTrace trace = c.trace();
    const BoundaryCurve curve = BoundaryCurve::traced(c.from, c.to, trace);
    const Vec3 direction = normalized(c.to - c.from);
    double farthest = 0;
    for (int i = 1; i < 16; ++i) {
      const double t = i / 16.0;
      const Vec3 p = curve.position(t), on_line = c.from + t * (c.to - c.from);
      EXPECT_LT(std::fabs(c.curved.distance(p)), 1e-14);
      if (c.other) {
        EXPECT_LT(std::fabs(c.other->distance(p)), 1e-14);
      }
      if (c.is_circle) {
        // All axes of circles here are the z axis. Places are at the same angle and height.
        EXPECT_NEAR(cross(Vec2{p.x, p.y}, Vec2{on_line.x, on_line.y}), 0, 1e-14);
        EXPECT_NEAR(p.z, on_line.z, 1e-14);
      } else {
        EXPECT_NEAR(dot(p - on_line, direction), 0, 1e-14);
      }
      farthest = std::max(farthest, norm(p - on_line));
    }
    // None of these curves is straight.
    EXPECT_GT(farthest, 0.05 * curve.length());
    EXPECT_LT(farthest, 0.5 * curve.length());
  }
}

TEST(boundary_curve, the_middle_of_an_arc_has_half_its_angle) {
  const Vec3 from = kShaft.point(0.2, 3), to = kShaft.point(1.3, 3);
  const CurveTrace trace = CurveTrace::choose(from, to, kShaft.shape(), plane({0, 0, 3}, {0, 0, 1})).value();
  const BoundaryCurve arc = BoundaryCurve::traced(from, to, trace);
  EXPECT_LT(norm(arc.position(0.5) - kShaft.point(0.75, 3)), 1e-14);
  // The point at a quarter of the chord is at this angle from the middle.
  const double angle = std::atan(0.5 * std::tan(0.55));
  EXPECT_LT(norm(arc.position(0.25) - kShaft.point(0.75 - angle, 3)), 1e-14);
}

TEST(boundary_curve, a_straight_line_on_the_surfaces_is_not_traced) {
  // It is a ruling between a fillet and the plane beside it, or a seam.
  const Vec3 low = kShaft.point(0, 0), high = kShaft.point(0, 5);
  const auto is_traced = [&](const std::optional<AnalyticSurface>& other) {
    return CurveTrace::choose(low, high, kShaft.shape(), other).has_value();
  };
  EXPECT_FALSE(is_traced(plane({2, 0, 0}, {1, 0, 0})));
  EXPECT_FALSE(is_traced(plane({2, 0, 0}, {1, 1, 0})));
  EXPECT_FALSE(is_traced(CurvedPlace{SurfaceKind::kCylinder, 1, 0, 0, {1, 0, 0}}.shape()));
  EXPECT_FALSE(is_traced(kShaft.shape()));
  EXPECT_FALSE(is_traced(std::nullopt));
}

TEST(boundary_curve, a_curve_that_leaves_the_other_surface_is_not_a_circle) {
  // The ends are on a circle of the shaft, but the plane that is claimed is another one through them.
  const Vec3 from = kShaft.point(0.2, 3), to = kShaft.point(1.3, 3);
  const Vec3 tilted = normalized(cross(to - from, Vec3{0.6, 0.6, 1}));
  const auto trace = CurveTrace::choose(from, to, kShaft.shape(), plane(from, tilted));
  ASSERT_TRUE(trace.has_value());
  const Vec3 p = BoundaryCurve::traced(from, to, *trace).position(0.4);
  EXPECT_LT(std::fabs(kShaft.shape().distance(p)), 1e-14);
  EXPECT_LT(std::fabs(dot(p - from, tilted)), 1e-14);
  EXPECT_GT(std::fabs(p.z - 3), 0.01);
}

STAGE(boundary_curve, test::kScale, test::kExtremeScale) {
  for (CurveCase c : curve_cases()) {
    c.curved = test::scaled(c.curved, trial.scale);
    if (c.other) c.other = test::scaled(*c.other, trial.scale);
    c.from = trial.scale * c.from;
    c.to = trial.scale * c.to;
    trial.same(trial.length(BoundaryCurve::traced(c.from, c.to, c.trace()).position(0.3)));
  }
}

}  // namespace
}  // namespace remesh
