// Tests which edges with more than two faces a volume mesher takes: those where all faces bound closed cells.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/solids/solid_rows.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

std::vector<DiagnosticCode> obstacles_of(const PolygonMesh& mesh, bool is_arranged = true) {
  Options options = unrefined();
  options.repair.self_intersections = is_arranged;
  const Result result = remeshed(mesh, options);
  std::vector<DiagnosticCode> codes;
  for (const VolumeObstacle& obstacle : result.report.volume_obstacles) codes.push_back(obstacle.code);
  return codes;
}

using Codes = std::vector<DiagnosticCode>;

TEST(volume_ready, solids_that_touch_and_walls_between_cells_are_taken) {
  for (const SolidRow& row : solid_rows()) {
    if (row.is_large) continue;
    // Without labels, a shell inside another one that it does not touch is a cavity.
    const bool is_cavity_turned_over = row.number == 10;
    EXPECT_EQ(obstacles_of(as_one(row.parts)), is_cavity_turned_over ? Codes{DiagnosticCode::kInsideOut} : Codes{})
        << row.name;
  }
}

TEST(volume_ready, a_sheet_that_divides_a_solid_is_taken_and_one_that_ends_inside_is_not) {
  const PolygonMesh box = shapes::box({1, 1, 1});
  const auto sheet = [](double from, double to) {
    return shapes::from_lists({{from, from, .5}, {to, from, .5}, {to, to, .5}, {from, to, .5}}, {{0, 1, 2, 3}});
  };
  EXPECT_EQ(obstacles_of(shapes::joined(box, sheet(0, 1))), Codes{});
  // It has a rim inside the box, where it ends.
  EXPECT_EQ(obstacles_of(shapes::joined(box, sheet(0, .5))),
            (Codes{DiagnosticCode::kOpenBoundary, DiagnosticCode::kNonManifoldEdge}));
  // Its rim is outside.
  EXPECT_EQ(obstacles_of(shapes::joined(box, sheet(-.5, 1.5))),
            (Codes{DiagnosticCode::kOpenBoundary, DiagnosticCode::kNonManifoldEdge}));
}

TEST(volume_ready, solids_that_touch_along_an_edge_and_face_inwards_are_told) {
  const SolidRow row = solid_rows()[5];
  EXPECT_EQ(obstacles_of(shapes::turned_over(as_one(row.parts))), Codes{DiagnosticCode::kInsideOut});
}

TEST(volume_ready, where_faces_intersect_no_edge_with_more_faces_is_taken) {
  // Two cubes that touch along an edge, and one that crosses both.
  const SolidRow row = solid_rows()[5];
  const PolygonMesh touching = shapes::welded(as_one(row.parts));
  EXPECT_EQ(obstacles_of(touching, false), Codes{});
  const PolygonMesh crossing = shapes::moved(shapes::box({1, 1, 1}), {.5, .5, .5});
  const Codes codes = obstacles_of(shapes::joined(touching, crossing), false);
  EXPECT_NE(std::find(codes.begin(), codes.end(), DiagnosticCode::kNonManifoldEdge), codes.end());
}

}  // namespace
}  // namespace remesh
