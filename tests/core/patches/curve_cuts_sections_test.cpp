// Tests curves in which surfaces of several kinds meet.

#include "core/patches/chains/curve_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/cut_parts.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using namespace cut_parts;

TEST(curve_cuts, an_oblique_cut_has_pieces_of_equal_angles_on_the_surface_and_in_the_plane) {
  for (const double half_angle : {0.0, 0.2})
    for (const double slope : {0.1, 0.7, 1.5})
      for (const int n : {12, 16, 25, 90}) {
        const Part input = cut_off(60, slope, half_angle);
        const Asked asked{5, 2 * kPi / n};
        const CutPart part(input, asked);
        SCOPED_TRACE(slope);
        SCOPED_TRACE(n);
        expect_conforming(part);
        expect_near(part, asked.tolerance);
        const std::vector<Vec3> points = part.points(part.first_loop(kTop));
        ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
        std::vector<double> angles;
        for (const Vec3& p : points) {
          EXPECT_NEAR(std::hypot(p.x, p.y), 5 + p.z * std::tan(half_angle), 4 * 0x1p-48);
          EXPECT_NEAR(p.z, 12 + slope * p.x, 4 * 0x1p-48);
          angles.push_back(std::atan2(p.y, p.x));
        }
        std::sort(angles.begin(), angles.end());
        for (std::size_t i = 1; i < angles.size(); ++i) EXPECT_NEAR(angles[i] - angles[i - 1], 2 * kPi / n, 1e-12);
      }
}

TEST(curve_cuts, the_pieces_of_an_ellipse_are_within_the_tolerance_with_hardly_one_too_many) {
  const double slope = 1.5;
  for (const double tolerance : {0.03, 0.1, 0.3}) {
    const CutPart part(cut_off(120, slope, 0), {tolerance, kPi});
    expect_near(part, tolerance);
    // The highest arc is that at the end of the long axis. Its height is that of a circle of this radius.
    const double long_axis = 5 * std::hypot(1, slope);
    int fewest = 6;
    while (height(long_axis, fewest) > tolerance) ++fewest;
    const auto count = static_cast<int>(part.points(part.first_loop(kTop)).size());
    EXPECT_LE(count, fewest);
    EXPECT_GE(count, fewest - 2);
  }
}

/// Returns how far a chord of the oblique section of the cylinder leaves the section along the surface.
double way_along_surface(const Vec3& from, const Vec3& to, double slope) {
  constexpr int kSteps = 200;
  double farthest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const Vec3 p = from + part * (to - from);
    const double angle = std::atan2(p.y, p.x);
    double nearest = HUGE_VAL;
    // In the unrolled cylinder, the section is a wave.
    for (int k = -kSteps; k <= kSteps; ++k) {
      const double turn = 0.3 * k / kSteps;
      nearest = std::min(nearest, std::hypot(5 * turn, 12 + slope * 5 * std::cos(angle + turn) - p.z));
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

TEST(curve_cuts, an_oblique_cut_leaves_its_section_along_the_surface_by_no_more_than_is_allowed) {
  const double tolerance = 0.2;
  for (const double slope : {0.5, 1.0, 1.5})
    for (const double along : {0.01, 0.03}) {
      SCOPED_TRACE(slope);
      SCOPED_TRACE(along);
      const Part input = cut_off(360, slope, 0);
      const CutPart part(input, {tolerance, kPi, HUGE_VAL, HUGE_VAL, along}), free(input, {tolerance, kPi});
      const std::vector<Vec3> points = part.points(part.first_loop(kTop));
      double farthest = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        farthest = std::max(farthest, way_along_surface(points[i], points[(i + 1) % points.size()], slope));
      EXPECT_LE(farthest, 1.05 * along);
      // There are not many pieces too many: the way grows with the square of their length.
      EXPECT_GE(farthest, 0.7 * along);
      EXPECT_GT(points.size(), free.points(free.first_loop(kTop)).size());
      // Chords of the circle around the axis leave it in depth only.
      EXPECT_EQ(part.points(part.first_loop(kBottom)), free.points(free.first_loop(kBottom)));
    }
}

TEST(curve_cuts, the_equator_between_two_halves_of_a_globe_is_a_circle) {
  for (const int n : {7, 12, 16}) {
    const Asked asked = elements(n, 3, height(3, 40));
    const CutPart part(with_halves(part_of(primitives::globe(40, 20, 3)), 0, [](const Vec3& p) { return p.z < 0; }),
                       asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    const std::vector<Vec3> points = part.points(0);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(3, n), 1e-14);
    for (const Vec3& p : points) EXPECT_NEAR(norm(p), 3, 4 * 0x1p-51);
  }
}

TEST(curve_cuts, the_circles_of_a_torus_are_cut_around_its_axis_and_around_its_tube) {
  const primitives::Model model = primitives::torus(64, 16, 40, 6, 2);  // a quarter, which is open at both ends
  const Part halves = with_halves(part_of(model), 0, [](const Vec3& p) { return p.z < 0; });
  for (const int n : {8, 12, 20}) {
    const Asked asked{1, 2 * kPi / n};
    const CutPart part(halves, asked);
    SCOPED_TRACE(n);
    expect_near(part, asked.tolerance);
    for (std::uint32_t patch = 0; patch < 2; ++patch) {
      // Half of the tube's circle at both ends, a quarter of the outer and of the inner circle.
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), static_cast<std::size_t>(2 * (n / 2) + 2 * (n / 4)));
      for (const Vec3& p : points) EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 6, p.z), 2, 4 * 0x1p-50);
      std::map<int, int> long_edges;
      for (const double l : lengths(points))
        for (const double radius : {2.0, 4.0, 8.0})
          if (std::fabs(l - chord(radius, n)) < 1e-12) ++long_edges[static_cast<int>(radius)];
      EXPECT_EQ(long_edges[2], n);
      EXPECT_EQ(long_edges[4], n / 4);
      EXPECT_EQ(long_edges[8], n / 4);
    }
  }
}

TEST(curve_cuts, a_circle_along_which_a_torus_touches_a_plane_is_cut_as_its_vertices_lie) {
  // The torus r = 6 +- 2 from its highest circle outwards and down to the middle, with a disc above and one below.
  const int n = 60, rows = 6;
  std::vector<Vec3> places;
  std::vector<std::vector<std::uint32_t>> faces(2);
  std::vector<std::uint32_t> groups{1, 2};
  for (int k = 0; k <= rows; ++k)
    for (int i = 0; i < n; ++i) {
      const double tilt = k == 0 ? kPi / 2 : kPi / 2 * (rows - k) / rows, turn = 2 * kPi * i / n;
      const double r = k == 0 ? 6 : 6 + 2 * std::cos(tilt);
      places.push_back({r * std::cos(turn), r * std::sin(turn), 2 * std::sin(tilt)});
    }
  const auto at = [&](int k, int i) { return static_cast<std::uint32_t>(k * n + (i + n) % n); };
  for (int i = 0; i < n; ++i) {
    faces[0].push_back(at(0, i));
    faces[1].push_back(at(rows, -i));
    for (int k = 0; k < rows; ++k) {
      faces.push_back({at(k, i), at(k + 1, i), at(k + 1, i + 1), at(k, i + 1)});
      groups.push_back(0);
    }
  }
  const AnalyticSurface torus{SurfaceKind::kTorus, {}, {0, 0, 1}, 6, 2, 0}, plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  const CutPart part({with_groups(shapes::from_lists(places, faces), groups), {torus, plane, plane}},
                     elements(16, 8, height(8, n)));
  expect_conforming(part);
  const std::vector<Vec3> upper = part.points(part.first_loop(1)), lower = part.points(part.first_loop(2));
  ASSERT_EQ(upper.size(), 16u);
  ASSERT_EQ(lower.size(), 16u);
  for (const Vec3& p : upper) {
    EXPECT_EQ(p.z, 2);
    EXPECT_NEAR(std::hypot(p.x, p.y), 6, 4 * 0x1p-50);
  }
  for (const Vec3& p : lower) EXPECT_NEAR(std::hypot(p.x, p.y), 8, 4 * 0x1p-49);
}

/// Expects of a polyline that was thinned out that its vertices are those of the input, that those dropped are near,
/// and that normals turn by no more than was asked for where vertices were dropped.
void expect_thinned(const CutPart& part, std::uint32_t l, const std::vector<AnalyticSurface>& shapes,
                    const Asked& asked) {
  const std::vector<Vec3> before = part.points_before(l), now = part.points(l);
  ASSERT_FALSE(now.empty());
  std::size_t i = 0;
  while (before[i] != now[0]) ++i;
  for (std::size_t j = 0; j < now.size(); ++j) {
    const Vec3 a = now[j], b = now[(j + 1) % now.size()];
    std::vector<Vec3> dropped;
    for (i = (i + 1) % before.size(); before[i] != b; i = (i + 1) % before.size()) dropped.push_back(before[i]);
    for (const Vec3& p : dropped) {
      EXPECT_LE(to_segment(p, a, b), asked.tolerance * (1 + 1e-6));
      for (const AnalyticSurface& s : shapes)
        EXPECT_LE(std::acos(std::clamp(dot(s.normal(a), s.normal(p)), -1.0, 1.0)), asked.max_turn * (1 + 1e-6));
    }
    if (dropped.empty()) continue;
    for (const AnalyticSurface& s : shapes)
      EXPECT_LE(std::acos(std::clamp(dot(s.normal(a), s.normal(b)), -1.0, 1.0)), asked.max_turn * (1 + 1e-6));
  }
}

TEST(curve_cuts, where_two_cylinders_meet_vertices_of_the_input_are_left_out) {
  for (const int facets : {48, 96})
    for (const int n : {6, 8, 12, 16, 24}) {
      const primitives::Model model = primitives::tee(facets);
      const Part input = part_of(model);
      const Asked asked = elements(n, 4, height(4, facets));
      const CutPart part(input, asked);
      SCOPED_TRACE(n);
      // The branch is the second surface. One of its loops is its open end, and the other one is the cut.
      bool is_found = false;
      for (std::uint32_t l = part.loops.patch_begin[1]; l < part.loops.patch_begin[2]; ++l) {
        const std::vector<Vec3> points = part.points(l);
        if (points.front().z == 7) {
          EXPECT_EQ(points.size(), static_cast<std::size_t>(n));
          continue;
        }
        is_found = true;
        expect_thinned(part, l, {input.shapes[0], input.shapes[1]}, asked);
        // On the branch, which is narrower, at most n pieces would be asked for if vertices were anywhere. The input's
        // vertices leave gaps of up to a facet.
        const double turn = 2 * kPi / n, facet = 2 * kPi / facets;
        EXPECT_LE(static_cast<double>(points.size()), std::ceil(2 * kPi / (turn - facet) + 1));
        EXPECT_GE(static_cast<double>(points.size()), n);
      }
      EXPECT_TRUE(is_found);
    }
}

TEST(curve_cuts, nothing_is_dropped_where_two_cylinders_meet_if_the_tolerance_is_tiny) {
  const CutPart part(part_of(primitives::tee(48)), {1e-6, kPi});
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
  EXPECT_TRUE(part.cuts.positions.empty());
}

}  // namespace
}  // namespace remesh
