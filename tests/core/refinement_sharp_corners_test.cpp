// Facets with sharp corners where a size is asked for: few triangles, and all that the bound on angles can have.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Options with(double angle, double length) {
  Options options = with_angle(angle);
  options.max_edge_length = length;
  return options;
}

/// Returns how many triangles a corner takes whose sides have length 1. From the first size to where there is room for
/// equilateral triangles, they are in a row between the sides. Beyond, up to the distance 1, there are 50 % more than
/// equilateral triangles would be.
double triangles_in_needle(double degrees, double bound, double size) {
  const double angle = degrees * kDegree, tangent = std::tan(bound * kDegree);
  // From this distance on, pieces are as long as the size.
  const double even = std::min(1.0, std::max(size, tangent * size / 2 / angle));
  const double growing = std::log(even / size) / (2 * std::log1p(angle / tangent));
  const double wide = std::min(1.0, size * std::numbers::sqrt3 / 2 / angle);
  const double in_rows = 2 * (growing + std::max(0.0, wide - even) / size);
  return 1 + in_rows + 1.5 * angle / 2 * (1 - wide * wide) / (std::numbers::sqrt3 / 4 * size * size);
}

TEST(sharp_corners, a_needle_takes_hardly_more_triangles_than_a_row_of_them_with_the_angle) {
  for (const double degrees : {0.7, 1.0, 2.0, 3.5, 5.0, 8.0})
    for (const double bound : {20.0, 25.0, 30.0})
      for (const double size : {0.3, 0.1, 0.04}) {
        const PolygonMesh mesh = shapes::triangle(degrees, 1, 1);
        const Options options = with(bound, size);
        const Result result = refined(mesh, options);
        expect_promises(mesh, options, result);
        // Only the corner itself may be listed.
        EXPECT_LE(listed(result.report), 1u) << degrees << ' ' << bound << ' ' << size;
        EXPECT_LE(static_cast<double>(result.mesh.faces.size()), 1.15 * triangles_in_needle(degrees, bound, size) + 6)
            << degrees << ' ' << bound << ' ' << size;
      }
}

TEST(sharp_corners, around_a_vertex_facets_take_turns) {
  for (const int sides : {64, 65})
    for (const double bound : {20.0, 25.0, 30.0})
      for (const double size : {0.9, 0.5, 0.3}) {
        SCOPED_TRACE(::testing::Message() << sides << ' ' << bound << ' ' << size);
        const PolygonMesh mesh = solids::cone(sides, 10);
        const Options options = with(bound, size);
        const Result result = refined(mesh, options);
        expect_promises(mesh, options, result);
        const auto corners = static_cast<std::uint64_t>(sides);
        EXPECT_EQ(listed(result.report, UnrefinedReason::kInputAngle), corners);
        const double angle = 2 * std::sin(std::numbers::pi / sides) / std::hypot(10, 1) / kDegree;
        const double of_facet = triangles_in_needle(angle, bound, size / std::hypot(10, 1));
        // In an odd ring there is one facet whose sides are cut alike.
        const std::uint64_t across = listed(result.report) - corners;
        EXPECT_LE(static_cast<double>(across), sides % 2 == 0 ? 0 : 1.15 * of_facet + 6);
        const double of_base = std::numbers::pi / (std::numbers::sqrt3 / 4 * size * size);
        EXPECT_LE(static_cast<double>(result.mesh.faces.size()), sides * (1.15 * of_facet + 6) + 2 * of_base);
      }
}

TEST(sharp_corners, one_sliver_in_a_fan_does_not_make_all_of_it_finer) {
  std::vector<double> degrees(21, 8);
  const Options options = with(25, 0.05);
  const std::size_t even = refined(solids::needle_fan(degrees), options).mesh.faces.size();
  degrees[10] = 0.4;
  const PolygonMesh mesh = solids::needle_fan(degrees);
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  // Cut like the sliver all over, it would be a third more.
  EXPECT_LE(static_cast<double>(result.mesh.faces.size()), 1.1 * static_cast<double>(even));
}

TEST(sharp_corners, what_is_too_sharp_for_the_angle_is_excused_and_stays_coarse) {
  for (const double degrees : {1e-2, 1e-4, 1e-6}) {
    const PolygonMesh mesh = shapes::triangle(degrees, 1, 1);
    const Options options = with(25, 0.05);
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_EQ(listed(result.report, UnrefinedReason::kSizeFloor), 0u) << degrees;
    EXPECT_LE(result.mesh.faces.size(), 45u) << degrees;
  }
}

TEST(sharp_corners, sides_of_different_lengths_end_where_they_end) {
  for (const double second : {0.07, 0.1, 0.33, 0.73, 0.99, 0.999})
    for (const double degrees : {2.0, 6.0}) {
      const PolygonMesh mesh = shapes::triangle(degrees, 1, second);
      const Options options = with(20, 0.1);
      const Result result = refined(mesh, options);
      expect_promises(mesh, options, result);
      EXPECT_LE(longest_edge(result.mesh), 0.1 * (1 + 1e-9));
    }
}

TEST(sharp_corners, the_shortest_edge_goes_before_them) {
  for (const double least : {0.01, 0.03, 0.06}) {
    const PolygonMesh mesh = shapes::triangle(4, 1, 1);
    Options options = with(25, 0.1);
    options.min_edge_length = least;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_GE(shortest_edge(result.mesh), least * (1 - 1e-9));
  }
}

TEST(sharp_corners, where_sizes_vary_the_shortest_edge_leaves_no_long_ones) {
  // Two sheets far away, so that sizes vary. The corner's own triangle cannot be as small as elsewhere.
  const PolygonMesh sheet = shapes::moved(shapes::sheet(1, 1, 1, 1), {9, 0, 0});
  const PolygonMesh sheets = shapes::joined(sheet, shapes::moved(sheet, {0, 0, 0.05}));
  for (const double degrees : {11.5, 13.0})
    for (const double least : {0.0115, 0.012}) {
      const PolygonMesh mesh = shapes::joined(shapes::triangle(degrees, 1, 0.9), sheets);
      Options options = with(25, 0.1);
      options.proximity = 1;
      options.min_edge_length = least;
      const Result result = refined(mesh, options);
      expect_promises(mesh, options, result);
      EXPECT_LE(longest_edge(result.mesh), 0.1 * (1 + 1e-9)) << degrees << ' ' << least;
    }
}

STAGE(sharp_corners, test::kScale) {
  const PolygonMesh mesh = trial.of(solids::cone(24, 10));
  trial.mesh(refined(mesh, with(20, 0.5 * trial.scale)).mesh);
}

}  // namespace
}  // namespace remesh
