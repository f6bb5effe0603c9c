// Facets with sharp corners where a size is asked for: few triangles, and all that the bound on angles can have.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "core/refinement/segment_table.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Options with(double angle, double length) {
  Options options = with_angle(angle);
  options.max_edge_length = length;
  return options;
}

/// A triangle with that corner at the origin; its sides there are of length 1 and `second`.
PolygonMesh needle(double degrees, double second = 1) {
  return shapes::polygon(
      {{0, 0}, {1, 0}, {second * std::cos(degrees * kDegree), second * std::sin(degrees * kDegree)}});
}

/// A cone over a regular polygon, the apex high above it.
PolygonMesh cone(int sides, double height) {
  std::vector<Vec3> positions{{0, 0, height}};
  std::vector<std::vector<std::uint32_t>> faces(1);
  for (int i = 0; i < sides; ++i) {
    const double turn = 2 * std::numbers::pi * i / sides;
    positions.push_back({std::cos(turn), std::sin(turn), 0});
    const auto k = static_cast<std::uint32_t>(i);
    faces.push_back({0, k + 1, (k + 1) % static_cast<std::uint32_t>(sides) + 1});
    faces[0].push_back(static_cast<std::uint32_t>(sides) - k);
  }
  return shapes::from_lists(positions, faces);
}

/// Triangles in a row between the sides of a corner, from the first size to where there is room for equilateral ones.
/// Beyond, up to the distance 1, half as many again as equilateral ones would be.
double triangles_in_needle(double degrees, double bound, double size) {
  const double angle = degrees * kDegree, tangent = std::tan(bound * kDegree);
  // From here on pieces are as long as the size.
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
        const PolygonMesh mesh = needle(degrees);
        const Options options = with(bound, size);
        const Result result = refined(mesh, options);
        expect_promises(mesh, options, result);
        // But for the corner itself.
        EXPECT_LE(listed(result.report), 1u) << degrees << ' ' << bound << ' ' << size;
        EXPECT_LE(static_cast<double>(result.mesh.faces.size()), 1.15 * triangles_in_needle(degrees, bound, size) + 6)
            << degrees << ' ' << bound << ' ' << size;
      }
}

TEST(sharp_corners, around_a_vertex_facets_take_turns) {
  const double size = 0.5;
  for (const int sides : {64, 65}) {
    const PolygonMesh mesh = cone(sides, 10);
    const Options options = with(25, size);
    const Result result = refined(mesh, options);
    if (sides == 64) expect_promises(mesh, options, result);
    const auto corners = static_cast<std::uint64_t>(sides);
    EXPECT_EQ(listed(result.report, UnrefinedReason::kInputAngle), corners);
    const double angle = 2 * std::sin(std::numbers::pi / sides) / std::hypot(10, 1) / kDegree;
    const double of_facet = triangles_in_needle(angle, 25, size / std::hypot(10, 1));
    // In an odd ring there is one facet whose sides are cut alike.
    const std::uint64_t across = listed(result.report) - corners;
    EXPECT_LE(static_cast<double>(across), sides % 2 == 0 ? 0 : 1.15 * of_facet + 6);
    const double of_base = std::numbers::pi / (std::numbers::sqrt3 / 4 * size * size);
    EXPECT_LE(static_cast<double>(result.mesh.faces.size()), sides * (1.15 * of_facet + 6) + 2 * of_base) << sides;
  }
}

/// Facets around the origin, folded along the edges between them.
PolygonMesh fan(const std::vector<double>& degrees) {
  std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0.02}};
  std::vector<std::vector<std::uint32_t>> faces;
  double turn = 0;
  for (const double angle : degrees) {
    turn += angle * kDegree;
    const auto k = static_cast<std::uint32_t>(positions.size());
    positions.push_back({std::cos(turn), std::sin(turn), k % 2 == 0 ? -0.02 : 0.02});
    faces.push_back({0, k - 1, k});
  }
  return shapes::from_lists(positions, faces);
}

TEST(sharp_corners, one_sliver_in_a_fan_does_not_make_all_of_it_finer) {
  std::vector<double> degrees(21, 8);
  const std::size_t even = refined(fan(degrees), with(25, 0.05)).mesh.faces.size();
  degrees[10] = 0.4;
  const Result result = refined(fan(degrees), with(25, 0.05));
  expect_promises(fan(degrees), with(25, 0.05), result);
  EXPECT_LE(static_cast<double>(result.mesh.faces.size()), 1.02 * static_cast<double>(even));
}

TEST(sharp_corners, what_is_too_sharp_for_the_angle_is_excused_and_stays_coarse) {
  for (const double degrees : {1e-2, 1e-4, 1e-6}) {
    const PolygonMesh mesh = needle(degrees);
    const Options options = with(25, 0.05);
    const Result result = refined(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(listed(result.report, UnrefinedReason::kSizeFloor), 0u) << degrees;
    EXPECT_LE(result.mesh.faces.size(), 45u) << degrees;
  }
}

TEST(sharp_corners, sides_of_different_lengths_end_where_they_end) {
  for (const double second : {0.07, 0.1, 0.33, 0.73, 0.99, 0.999})
    for (const double degrees : {2.0, 6.0}) {
      const PolygonMesh mesh = needle(degrees, second);
      const Options options = with(20, 0.1);
      const Result result = refined(mesh, options);
      expect_promises(mesh, options, result);
      EXPECT_LE(longest_edge(result.mesh), 0.1 * (1 + 1e-9));
    }
}

TEST(sharp_corners, the_shortest_edge_goes_before_them) {
  for (const double least : {0.01, 0.03, 0.06}) {
    const PolygonMesh mesh = needle(4);
    Options options = with(25, 0.1);
    options.min_edge_length = least;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_GE(shortest_edge(result.mesh), least * (1 - 1e-9));
  }
}

TEST(sharp_corners, scaling_by_powers_of_two_scales_the_cuts) {
  const PolygonMesh mesh = cone(24, 10);
  const Result once = refined(mesh, with(20, 0.5));
  PolygonMesh large = mesh;
  for (Vec3& p : large.positions) p = 1024.0 * p;
  const Result scaled = refined(large, with(20, 512));
  ASSERT_EQ(scaled.mesh.positions.size(), once.mesh.positions.size());
  for (std::size_t v = 0; v < once.mesh.positions.size(); ++v)
    EXPECT_EQ(scaled.mesh.positions[VertexId(v)], 1024.0 * once.mesh.positions[VertexId(v)]);
}

// What the table says.

/// Distances from the corner at the origin, of a side's cuts.
std::vector<double> distances(const StageChain& chain, const SegmentTable& table, const SizeField& sizes,
                              const Vec3& end) {
  for (std::uint32_t s = 0; s < table.size(); ++s) {
    const BoundarySegment& segment = table[SegmentId(s)];
    const std::set<VertexId> ends{segment.from, segment.to};
    if (ends != std::set<VertexId>{chain.at({0, 0, 0}), chain.at(end)}) continue;
    std::vector<double> found;
    for (const double t : table.size_cuts(SegmentId(s), sizes)) found.push_back(norm(table.position(SegmentId(s), t)));
    std::sort(found.begin(), found.end());
    return found;
  }
  ADD_FAILURE() << "no such side";
  return {};
}

TEST(corner_shells, the_sides_of_a_corner_are_cut_by_turns_in_pieces_that_grow) {
  const double angle = 3, size = 0.1, bound = 25, tangent = std::tan(bound * kDegree);
  const double width = 2 * std::sin(angle * kDegree / 2);
  StageChain chain(needle(angle));
  const SizeField sizes(size);
  const Goals goals = goals_of(with(bound, size), 1);
  const SegmentTable table(chain.surface, chain.meshes, std::vector<std::uint8_t>(1, 0), sizes, goals, chain.control);
  std::vector<double> a = distances(chain, table, sizes, {1, 0, 0}),
                      b = distances(chain, table, sizes, {std::cos(angle * kDegree), std::sin(angle * kDegree), 0});
  ASSERT_GT(std::min(a.size(), b.size()), 10u);
  EXPECT_EQ(a[0], size);
  EXPECT_NEAR(b[0], size, 1e-12);
  if (a[1] < b[1]) std::swap(a, b);
  // Behind the last shells the sides are cut each on its own.
  const double near = 0.8 * size / width;
  for (std::size_t i = 1; i < std::min(a.size(), b.size()) && a[i] < near; ++i) {
    EXPECT_LT(a[i - 1], b[i]);
    EXPECT_LT(b[i], a[i]);
    EXPECT_LE(a[i] - a[i - 1], size * (1 + 1e-9));
    // The angles at the base of a triangle whose top is on the other side.
    EXPECT_GE(width * b[i] / (a[i] - b[i]), tangent) << i;
    EXPECT_GE(width * b[i] / (b[i] - a[i - 1]), tangent) << i;
    if (i > 1) {
      EXPECT_GE(width * a[i - 1] / (b[i] - a[i - 1]), tangent) << i;
      EXPECT_GE(width * a[i - 1] / (a[i - 1] - b[i - 1]), tangent) << i;
    }
  }
}

TEST(corner_shells, without_a_size_or_a_bound_on_angles_there_are_none) {
  StageChain chain(needle(3));
  for (const auto& [bound, size] : {std::pair(25.0, HUGE_VAL), std::pair(0.0, 0.1)}) {
    Options options = with_angle(bound);
    const Goals goals = goals_of(options, 1);
    const SizeField sizes(size);
    const SegmentTable table(chain.surface, chain.meshes, std::vector<std::uint8_t>(1, 0), sizes, goals, chain.control);
    const std::vector<double> cuts = distances(chain, table, sizes, {1, 0, 0});
    ASSERT_EQ(cuts.size(), std::isfinite(size) ? 9u : 0u);
    for (std::size_t i = 0; i < cuts.size(); ++i) EXPECT_NEAR(cuts[i], 0.1 * static_cast<double>(i + 1), 1e-12);
  }
}

}  // namespace
}  // namespace remesh
