#include "core/mending/edges/cracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "core/remesh.h"
#include "tests/support/shapes.h"
#include "tests/support/torn.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Report report_of(const PolygonMesh& mesh, double weld_tolerance = 0) {
  RunControl control;
  Options options = unrefined();
  options.weld_tolerance = weld_tolerance;
  return remesh_surface(mesh, options, {}, control).report;
}

/// Returns the message about open edges, or an empty text if there is none.
std::string told_of(const Report& report) {
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kOpenBoundary) return d.message;
  return "";
}

/// Returns the weld tolerance that a message names, or 0 if it names none.
double named_tolerance(const std::string& message) {
  std::smatch match;
  return std::regex_search(message, match, std::regex("weld_tolerance=([-+.e0-9]+)")) ? std::stod(match[1]) : 0;
}

std::vector<double> widths_of(const PolygonMesh& mesh, double tolerance = 1e-9) {
  RunControl control;
  const Surface surface = shapes::surface(mesh);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  return find_cracks(surface, edges, tolerance, control).widths;
}

TEST(cracks, the_weld_tolerance_that_is_named_closes_them) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const double width : {1e-6, 1e-4, 2e-3}) {
      const PolygonMesh mesh =
          torn::in_two(shapes::box({1, 2, 3}, 4), torn::above_a_plane(seed), torn::noise(seed, width));
      const Report open = report_of(mesh);
      ASSERT_FALSE(open.output.closed);
      const double tolerance = named_tolerance(told_of(open));
      ASSERT_GT(tolerance, 0) << told_of(open);
      EXPECT_LE(tolerance, 4 * width);
      EXPECT_TRUE(report_of(mesh, tolerance).output.closed) << told_of(open);
    }
}

TEST(cracks, their_width_is_the_distance_of_their_sides) {
  const PolygonMesh left = shapes::sheet(4, 4, 4, 4), right = shapes::moved(left, {4 + 1.0 / 64, 0, 0});
  const std::vector<double> widths = widths_of(shapes::joined(left, right));
  ASSERT_EQ(widths.size(), 4u);
  for (const double width : widths) EXPECT_NEAR(width, 1.0 / 64, 1e-12);
  const std::string told = told_of(report_of(shapes::joined(left, right)));
  EXPECT_NE(told.find("8 of these edges run beside another open edge, 0.016 to 0.016 apart"), std::string::npos)
      << told;
  EXPECT_NE(told.find("would leave 24 of the 32"), std::string::npos) << told;
}

TEST(cracks, a_boundary_that_nothing_runs_beside_is_none) {
  EXPECT_TRUE(widths_of(shapes::sheet(4, 4, 4, 4)).empty());
  EXPECT_TRUE(widths_of(shapes::box({1, 1, 1}, 2)).empty());
  // A strip's two long sides run in opposite directions, and its face is between them.
  EXPECT_TRUE(widths_of(shapes::sheet(100, 0.5, 1, 1)).empty());
  EXPECT_TRUE(widths_of(shapes::polygon({{0, 0}, {100, 0}, {100, 0.5}, {0, 0.5}})).empty());
}

TEST(cracks, the_two_skins_of_a_thin_wall_are_none) {
  const PolygonMesh sheet = shapes::sheet(4, 4, 4, 4);
  EXPECT_TRUE(widths_of(shapes::joined(sheet, shapes::moved(shapes::turned_over(sheet), {0, 0, -0.01}))).empty());
}

TEST(cracks, a_gap_as_wide_as_edges_are_long_is_none) {
  const PolygonMesh left = shapes::sheet(4, 4, 4, 4);
  EXPECT_TRUE(widths_of(shapes::joined(left, shapes::moved(left, {4.2, 0, 0}))).empty());
  EXPECT_FALSE(widths_of(shapes::joined(left, shapes::moved(left, {4.05, 0, 0}))).empty());
}

TEST(cracks, no_tolerance_is_named_that_would_take_edges_away) {
  // A crack 0.05 wide between long edges, and elsewhere edges of 0.01.
  const PolygonMesh left = shapes::sheet(4, 4, 4, 4), right = shapes::moved(left, {4.05, 0, 0});
  const PolygonMesh fine = shapes::moved(shapes::sheet(0.1, 0.1, 10, 10), {20, 0, 0});
  const std::string told = told_of(report_of(shapes::joined(shapes::joined(left, right), fine)));
  EXPECT_NE(told.find("0.05 apart"), std::string::npos) << told;
  EXPECT_EQ(named_tolerance(told), 0) << told;
}

TEST(cracks, where_the_widest_is_no_crack_a_smaller_tolerance_is_named) {
  // Two sheets 0.001 apart, two others 0.05 apart, and edges of 0.01.
  const auto pair = [](double gap) {
    const PolygonMesh left = shapes::sheet(4, 4, 4, 4);
    return shapes::joined(left, shapes::moved(left, {4 + gap, 0, 0}));
  };
  const PolygonMesh fine = shapes::moved(shapes::sheet(0.1, 0.1, 10, 10), {20, 0, 0});
  const PolygonMesh mesh = shapes::joined(shapes::joined(pair(0.001), shapes::moved(pair(0.05), {0, 10, 0})), fine);
  const std::string told = told_of(report_of(mesh));
  const double tolerance = named_tolerance(told);
  EXPECT_GT(tolerance, 0.001) << told;
  EXPECT_LT(tolerance, 0.01) << told;
}

/// Makes a box of which one wall is moved outwards and cut into other columns than the rest.
PolygonMesh box_with_a_wall_off(std::uint32_t columns, double gap) {
  const PolygonMesh box = shapes::quad_box({1, 1, 1}, 3);
  const PolygonMesh open = torn::only(box, [&](FaceId f) {
    const auto loop = box.face(f);
    return std::any_of(loop.begin(), loop.end(), [&](VertexId v) { return box.positions[v].z < 1; });
  });
  const int n = static_cast<int>(columns);
  return shapes::joined(open, shapes::moved(shapes::sheet(1, 1, n, n), {0, 0, 1 + gap}));
}

TEST(cracks, sides_that_are_subdivided_differently_close_with_the_tolerance_that_is_named) {
  for (const std::uint32_t columns : {1u, 2u, 4u, 5u})
    for (const double gap : {1e-4, 2e-3}) {
      const PolygonMesh mesh = box_with_a_wall_off(columns, gap);
      const std::string told = told_of(report_of(mesh));
      const double tolerance = named_tolerance(told);
      ASSERT_GT(tolerance, gap) << told;
      EXPECT_LT(tolerance, 2 * gap);
      EXPECT_NE(told.find("would leave 0 of the"), std::string::npos) << told;
      const Report closed = report_of(mesh, tolerance);
      EXPECT_TRUE(closed.output.closed) << columns << " " << gap;
      EXPECT_TRUE(closed.verified.all_true());
      EXPECT_NEAR(closed.output.volume.value_or(0), 1, 2 * gap);
    }
}

TEST(cracks, a_weld_tolerance_does_not_keep_thin_faces_from_what_mends_them_without_one) {
  // A thin strip between two sheets, with a vertex of one of them on its edge.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 0.1, 0}, {0, 0.1, 0}, {1, 0.1, 0}, {2, 1, 0}, {0, 1, 0}},
                         {{0, 1, 2, 3}, {3, 4, 5, 6}, {4, 2, 5}});
  for (const double tolerance : {0.0, 0.07}) {
    const Report report = report_of(mesh, tolerance);
    EXPECT_NEAR(report.output.area, 2, 1e-12);
    EXPECT_EQ(report.patches.size(), 1u) << tolerance;
  }
}

TEST(cracks, sides_that_look_opposite_ways_are_told_and_close) {
  PolygonMesh mesh = shapes::quad_box({1, 1, 1}, 3);
  const PolygonMesh whole = mesh;
  const auto is_top = [&](FaceId f) {
    const auto loop = whole.face(f);
    return std::all_of(loop.begin(), loop.end(), [&](VertexId v) { return whole.positions[v].z == 1; });
  };
  const PolygonMesh top = torn::only(whole, is_top);
  const PolygonMesh rest = torn::only(whole, [&](FaceId f) { return !is_top(f); });
  const PolygonMesh torn = shapes::joined(rest, shapes::moved(shapes::turned_over(top), {0, 0, 1e-4}));
  const std::string told = told_of(report_of(torn));
  const double tolerance = named_tolerance(told);
  ASSERT_GT(tolerance, 1e-4) << told;
  EXPECT_TRUE(report_of(torn, tolerance).output.closed);
}

TEST(cracks, an_edge_that_only_points_at_another_one_is_no_side_of_a_crack) {
  // A sheet that stands on another one's edge, with its corner a little above it.
  const PolygonMesh sheet = shapes::sheet(4, 4, 2, 2);
  const PolygonMesh across = shapes::moved(shapes::rotated(sheet, {0, 0, 1}, 45), {4.01, 2.3, 0});
  EXPECT_TRUE(widths_of(shapes::joined(sheet, across)).empty());
}

}  // namespace
}  // namespace remesh
