#include "core/mending/polygons/polygon_cuts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/mending/polygons/mend_faces.h"
#include "core/mending/weld/weld.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

constexpr double kTolerance = 1e-9;

Surface surface_of(const PolygonMesh& mesh) {
  std::vector<Diagnostic> diagnostics;
  RunControl control;
  Surface surface = weld(mesh, {}, diagnostics, control);
  surface.detach();
  return surface;
}

void mend(Surface& surface) {
  std::vector<Diagnostic> diagnostics;
  RunControl control;
  mend_faces(surface, kTolerance, {}, MendMode::kYes, diagnostics, control);
}

/// Returns how many sides of faces lie on each edge. Vertices are named by their places, since mending renumbers them.
std::map<std::set<Vec3>, int> sides_of_edges(const Surface& surface) {
  std::map<std::set<Vec3>, int> sides;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i)
      ++sides[{surface.positions[loop[i]], surface.positions[loop[(i + 1) % loop.size()]]}];
  }
  return sides;
}

void expect_no_edge_is_joined(const Surface& before, const Surface& after) {
  const auto sides_before = sides_of_edges(before), sides_after = sides_of_edges(after);
  for (const auto& [edge, count] : sides_after) {
    const auto known = sides_before.find(edge);
    EXPECT_EQ(count, known == sides_before.end() ? 2 : known->second);
  }
  for (const auto& [edge, count] : sides_before) EXPECT_TRUE(sides_after.contains(edge));
}

double signed_volume(const Surface& surface) {
  double six = 0;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      six += dot(surface.positions[loop[0]], cross(surface.positions[loop[i]], surface.positions[loop[i + 1]]));
  }
  return six / 6;
}

/// The corners of a tetrahedron.
const std::vector<Vec3> kTetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(polygon_cuts, a_bent_quadrilateral_beside_triangles_takes_the_cut_that_none_of_them_has) {
  // Whichever of the two cuts is the shape's own choice, the two triangles have the other one or this one.
  for (const auto& faces : {std::vector<std::vector<std::uint32_t>>{{0, 1, 3, 2}, {0, 2, 1}, {1, 2, 3}},
                            std::vector<std::vector<std::uint32_t>>{{0, 1, 3, 2}, {0, 3, 1}, {0, 2, 3}}}) {
    const Surface before = surface_of(shapes::from_lists(kTetrahedron, faces));
    Surface after = before;
    mend(after);
    EXPECT_EQ(after.face_count(), 4u);
    EXPECT_EQ(after.vertex_count(), 4u);
    expect_no_edge_is_joined(before, after);
    EXPECT_NEAR(std::fabs(signed_volume(after)), 1.0 / 6, 1e-15);
  }
}

STAGE(polygon_cuts, test::kStop) {
  Surface surface = surface_of(shapes::from_lists(kTetrahedron, {{0, 1, 3, 2}, {0, 2, 1}, {1, 2, 3}}));
  PolygonCuts(surface, trial.control);
}

TEST(polygon_cuts, where_every_cut_is_an_edge_already_it_gets_a_vertex) {
  // Three quadrilaterals around the same four corners: their sides are all six edges, each twice.
  const Surface before = surface_of(shapes::from_lists(kTetrahedron, {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}}));
  Surface after = before;
  mend(after);
  EXPECT_EQ(after.face_count(), 12u);
  EXPECT_EQ(after.vertex_count(), 7u);
  expect_no_edge_is_joined(before, after);
}

TEST(polygon_cuts, vertices_on_one_cut_are_in_different_places) {
  // Bent quadrilaterals about the edge 0-1 that a pair of triangles has; their other cuts are edges, too.
  std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}};
  std::vector<std::vector<std::uint32_t>> faces{{0, 1, 2}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const auto a = static_cast<std::uint32_t>(points.size());
    points.push_back({0.5, 1 + 0.1 * i, 0.2 * i});
    points.push_back({0.5, -1 - 0.1 * i, 1 + 0.3 * i});
    faces.push_back({0, a, 1, a + 1});
    faces.push_back({a, a + 1, 0});
  }
  const Surface before = surface_of(shapes::from_lists(points, faces));
  Surface after = before;
  mend(after);
  EXPECT_EQ(after.vertex_count(), before.vertex_count() + 5);
  std::set<Vec3> places(after.positions.begin(), after.positions.end());
  EXPECT_EQ(places.size(), after.vertex_count());
  expect_no_edge_is_joined(before, after);
}

TEST(polygon_cuts, no_edge_is_joined_in_random_polygons_over_few_vertices) {
  Random random(4);
  for (int round = 0; round < 500; ++round) {
    const auto count = static_cast<std::uint32_t>(random.integer(4, 8));
    std::vector<Vec3> points;
    for (std::uint32_t v = 0; v < count; ++v) points.push_back({random.unit(), random.unit(), random.unit()});
    std::vector<std::vector<std::uint32_t>> faces;
    for (int f = 0; f < 6; ++f) {
      std::vector<std::uint32_t> loop(count);
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto at = static_cast<std::uint32_t>(random.below(static_cast<int>(i) + 1));
        loop[i] = loop[at];
        loop[at] = i;
      }
      loop.resize(static_cast<std::size_t>(random.integer(3, static_cast<int>(count))));
      faces.push_back(loop);
    }
    const Surface before = surface_of(shapes::from_lists(points, faces));
    Surface after = before;
    mend(after);
    SCOPED_TRACE(round);
    expect_no_edge_is_joined(before, after);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace remesh
