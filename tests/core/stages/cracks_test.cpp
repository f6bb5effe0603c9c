#include "core/stages/cracks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/remesh.h"
#include "tests/support/shapes.h"
#include "tests/support/torn.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Report remeshed(const PolygonMesh& mesh, double weld_tolerance = 0) {
  RunControl control;
  Options options = unrefined();
  options.weld_tolerance = weld_tolerance;
  return remesh_surface(mesh, options, {}, control).report;
}

/// What is told of open edges; empty if there are none.
std::string told_of(const Report& report) {
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kOpenBoundary) return d.message;
  return "";
}

/// The weld tolerance that a message names; 0 if it names none.
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
      const Report open = remeshed(mesh);
      ASSERT_FALSE(open.output.closed);
      const double tolerance = named_tolerance(told_of(open));
      ASSERT_GT(tolerance, 0) << told_of(open);
      EXPECT_LE(tolerance, 4 * width);
      EXPECT_TRUE(remeshed(mesh, tolerance).output.closed) << told_of(open);
    }
}

TEST(cracks, their_width_is_the_distance_of_their_sides) {
  const PolygonMesh left = shapes::sheet(4, 4, 4, 4), right = shapes::moved(left, {4 + 1.0 / 64, 0, 0});
  const std::vector<double> widths = widths_of(shapes::joined(left, right));
  ASSERT_EQ(widths.size(), 4u);
  for (const double width : widths) EXPECT_NEAR(width, 1.0 / 64, 1e-12);
  const std::string told = told_of(remeshed(shapes::joined(left, right)));
  EXPECT_NE(told.find("8 run beside another one, 0.016 to 0.016 apart"), std::string::npos) << told;
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
  const std::string told = told_of(remeshed(shapes::joined(shapes::joined(left, right), fine)));
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
  const std::string told = told_of(remeshed(mesh));
  const double tolerance = named_tolerance(told);
  EXPECT_GT(tolerance, 0.001) << told;
  EXPECT_LT(tolerance, 0.01) << told;
}

}  // namespace
}  // namespace remesh
