// Tests sizes that depend on gaps at curved surfaces which are remeshed as a whole. The walls of tubes, and how far
// bores are from planes, are known in closed form.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/refinement/goals/goals.h"
#include "core/remesh.h"
#include "tests/support/primitives.h"
#include "tests/support/refined_checks.h"

namespace remesh {
namespace {

constexpr double kRelativeSlack = 1 + 1e-6;

Options with_circles(double elements, double proximity) {
  Options options;
  options.elements_per_circle = elements;
  options.proximity = proximity;
  return options;
}

/// Returns the number of patches on surfaces that are not planes.
std::size_t curved_patch_count(const Report& report) {
  std::size_t count = 0;
  for (const SurfaceId s : report.surfaces.of_patch)
    count += report.surfaces.surfaces[s].shape.kind != SurfaceKind::kPlane ? 1 : 0;
  return count;
}

double radius(const Vec3& p) { return std::hypot(p.x, p.y); }

/// Calls visit(a, b) for the ends of each edge of each face.
template <class Visit>
void for_edges(const TriangleMesh& mesh, const Visit& visit) {
  for (const Triangle& t : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) visit(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]]);
}

TEST(curved_proximity, no_edge_of_a_tube_is_longer_than_its_wall_is_thick) {
  const int n = 32;
  const double wall = 0.1;
  const PolygonMesh mesh = primitives::tube(n, 1, wall, 0.5).mesh;
  const Result result = refined(mesh, with_circles(16, 1));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(curved_patch_count(result.report), 4u);
  EXPECT_EQ(listed(result.report), 0u) << listed_in_words(result.report);
  // The middle of a facet may be as much farther from the other wall as it lies deep below its circle.
  const double gap = wall + (1 - std::cos(std::numbers::pi / n));
  EXPECT_LE(longest_edge(result.mesh), Goals::kSizeSlack * gap * kRelativeSlack);
  // Without proximity, edges are as long as a 16th of the circle.
  EXPECT_GT(longest_edge(refined(mesh, with_circles(16, 0)).mesh), 3 * wall);
}

TEST(curved_proximity, a_bore_near_a_plane_has_edges_as_long_as_it_is_near) {
  // The bore of a square nut has the radius 3, and its sides are apothem away from the axis.
  const int n = 32;
  const double bore = 3, apothem = 5 / std::numbers::sqrt2, clear_angle = 25 * std::numbers::pi / 180;
  const double chord = bore * (1 - std::cos(std::numbers::pi / n));
  const PolygonMesh mesh = primitives::nut(4, n).mesh;
  const Result result = refined(mesh, with_circles(16, 1));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(curved_patch_count(result.report), 2u);
  EXPECT_EQ(listed(result.report), 0u) << listed_in_words(result.report);
  std::size_t on_bore = 0, on_sides = 0;
  for_edges(result.mesh, [&](const Vec3& a, const Vec3& b) {
    const Vec3 middle = 0.5 * (a + b);
    // The normals of the sides are 45, 135, 225 and 315 degrees from the x axis.
    const double angle =
        std::fabs(std::remainder(std::atan2(middle.y, middle.x) - std::numbers::pi / 4, std::numbers::pi / 2));
    if (angle > clear_angle) return;
    const auto is_on_bore = [&](const Vec3& p) { return radius(p) < bore * kRelativeSlack; };
    const auto from_side = [&](const Vec3& p) {
      return apothem - std::max(std::fabs(p.x + p.y), std::fabs(p.x - p.y)) / std::numbers::sqrt2;
    };
    std::optional<double> gap;
    if (is_on_bore(a) && is_on_bore(b)) {
      ++on_bore;
      gap = from_side(middle);
    } else if (std::max(from_side(a), from_side(b)) < 1e-6 && from_side(middle) < 1e-6) {
      ++on_sides;
      gap = radius(middle) - bore + chord;
    }
    if (gap) {
      EXPECT_LE(norm(b - a), Goals::kSizeSlack * *gap * kRelativeSlack);
    }
  });
  EXPECT_GT(on_bore, 100u);
  EXPECT_GT(on_sides, 100u);
  // The wall is thinnest in the middle of a side. At the corners, edges may be much longer.
  EXPECT_GT(longest_edge(result.mesh), 2 * (apothem - bore));
}

TEST(curved_proximity, an_analysis_measures_the_gap_between_facets_with_and_without_proximity) {
  const PolygonMesh mesh = primitives::tube(32, 1, 0.1, 0.5).mesh;
  RunControl control;
  const auto smallest = [&](double elements, double proximity) {
    Options options;
    if (elements > 0) options.elements_per_circle = elements;
    options.proximity = proximity;
    return analyze_surface(mesh, options, {}, control, {}).smallest_gap;
  };
  const std::optional<double> of_facets = smallest(0, 0);
  ASSERT_TRUE(of_facets.has_value());
  EXPECT_NEAR(*of_facets, 0.1 * std::cos(std::numbers::pi / 32), 1e-9);
  // The facets are triangulated in another way, so the last digits may differ.
  EXPECT_NEAR(smallest(16, 0).value_or(0), *of_facets, 1e-9);
  EXPECT_NEAR(smallest(16, 1).value_or(0), *of_facets, 1e-9);
}

TEST(curved_proximity, a_size_that_matters_nowhere_lets_no_edge_turn_farther) {
  // Points that no size needs are removed in the end, but not those that a curved surface needs.
  const PolygonMesh mesh = primitives::cylinder(64, 1, 4).mesh;
  Options options = with_circles(16, 0);
  options.max_edge_length = 3;
  const Result result = refined(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(curved_patch_count(result.report), 2u);
  for_edges(result.mesh, [&](const Vec3& a, const Vec3& b) {
    const bool is_on_side = radius(a) > 1 - 1e-6 && radius(b) > 1 - 1e-6;
    const double z = 0.5 * (a.z + b.z);
    if (!is_on_side || z < 1e-6 || z > 4 - 1e-6) return;
    const double turn = std::fabs(std::remainder(std::atan2(a.y, a.x) - std::atan2(b.y, b.x), 2 * std::numbers::pi));
    EXPECT_LE(turn, 2 * std::numbers::pi / 16 * kRelativeSlack);
  });
}

}  // namespace
}  // namespace remesh
