#include "core/stages/findings.h"

#include <gtest/gtest.h>

#include <map>

#include "core/quality.h"
#include "core/stages/weld.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

std::map<DiagnosticCode, Diagnostic> defects_of(const PolygonMesh& mesh) {
  RunControl control;
  std::vector<Diagnostic> diagnostics;
  const Surface surface = weld(mesh, {}, diagnostics, control);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners);
  const MeshStatistics statistics =
      measure_surface(surface.positions.items(), surface.face_begin, surface.corners, edges, control);
  diagnostics.clear();
  find_defects(surface, edges, statistics, diagnostics);
  std::map<DiagnosticCode, Diagnostic> found;
  for (const Diagnostic& d : diagnostics) found[d.code] = d;
  return found;
}

TEST(find_defects, a_sound_box_has_none) { EXPECT_TRUE(defects_of(shapes::box({1, 2, 3}, 2)).empty()); }

TEST(find_defects, open_edges_are_counted_with_their_faces) {
  const auto found = defects_of(shapes::sheet(1, 1, 1, 1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 4u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).elements, (std::vector<std::uint64_t>{0, 1, 0, 1}));
}

TEST(find_defects, edges_of_three_faces_are_counted) {
  const auto found = defects_of(shapes::three_pages());
  EXPECT_EQ(found.at(DiagnosticCode::kNonManifoldEdge).count, 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 9u);
  EXPECT_FALSE(found.count(DiagnosticCode::kInconsistentWinding));
}

TEST(find_defects, neighbours_that_look_opposite_ways_are_counted) {
  const auto found =
      defects_of(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(found.at(DiagnosticCode::kInconsistentWinding).count, 1u);
  EXPECT_FALSE(found.count(DiagnosticCode::kNonManifoldEdge));
}

TEST(find_defects, a_closed_surface_turned_over_is_inside_out) {
  const auto found = defects_of(shapes::turned_over(shapes::box({1, 1, 1}, 2)));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kInsideOut).count, 1u);
}

TEST(find_defects, the_first_hundred_elements_are_listed_and_all_are_counted) {
  const auto found = defects_of(shapes::sheet(1, 1, 100, 1));
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 202u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).elements.size(), Diagnostic::kMaxElements);
}

TEST(triangulated, polygons_come_as_triangles_of_their_area) {
  RunControl control;
  const PolygonMesh mesh = shapes::prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, 2);
  const Surface surface = mended(mesh);
  const auto triangles = triangulated(surface, control).triangles;
  EXPECT_EQ(triangles.size(), 2u * 4 + 6 * 2);
  double area = 0, volume = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 p = surface.positions[a], q = surface.positions[b], r = surface.positions[c];
    area += norm(cross(q - p, r - p)) / 2;
    volume += dot(p, cross(q, r)) / 6;
  }
  EXPECT_DOUBLE_EQ(area, 2 * 5 + 2 * 12);
  EXPECT_DOUBLE_EQ(volume, 10);
}

}  // namespace
}  // namespace remesh
