#include "core/mending/faces/input_defects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/mending/weld/weld.h"
#include "core/mesh/pinched_vertices.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

std::map<DiagnosticCode, Diagnostic> defects_of(const PolygonMesh& mesh) {
  RunControl control;
  std::vector<Diagnostic> diagnostics;
  const Surface surface = weld(mesh, {}, diagnostics, control);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  diagnostics.clear();
  find_defects(surface, edges, pinched_vertices(surface, edges, control), diagnostics, control);
  std::map<DiagnosticCode, Diagnostic> found;
  for (const Diagnostic& d : diagnostics) found[d.code] = d;
  return found;
}

TEST(find_defects, a_sound_box_has_none) { EXPECT_TRUE(defects_of(shapes::box({1, 2, 3}, 2)).empty()); }

TEST(find_defects, open_edges_are_counted_with_their_faces) {
  const auto found = defects_of(shapes::sheet(1, 1, 1, 1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 4u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).elements, (std::vector<std::uint64_t>{0, 0, 1, 1}));
}

TEST(find_defects, edges_of_three_faces_are_counted) {
  const auto found = defects_of(shapes::three_pages());
  EXPECT_EQ(found.at(DiagnosticCode::kNonManifoldEdge).count, 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 9u);
  EXPECT_FALSE(found.count(DiagnosticCode::kInconsistentWinding));
}

TEST(find_defects, a_vertex_that_joins_what_no_edge_joins_is_counted) {
  // Two squares that touch; two cones tip to tip; and a sheet of which a corner is used twice.
  EXPECT_EQ(defects_of(shapes::two_squares_touching_at_a_vertex(3)).at(DiagnosticCode::kNonManifoldVertex).count, 1u);
  const PolygonMesh tips =
      shapes::welded(shapes::joined(shapes::sphere(1), shapes::moved(shapes::sphere(1), {2, 0, 0})));
  const auto found = defects_of(tips);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kNonManifoldVertex).count, 1u);
  const std::uint64_t v = found.at(DiagnosticCode::kNonManifoldVertex).elements.at(0);
  EXPECT_EQ(tips.positions[VertexId(static_cast<std::size_t>(v))], (Vec3{1, 0, 0}));
}

TEST(find_defects, neither_edges_of_many_faces_nor_odd_winding_make_a_pinched_vertex) {
  EXPECT_FALSE(defects_of(shapes::three_pages(3)).count(DiagnosticCode::kNonManifoldVertex));
  PolygonMesh mesh = shapes::sheet(4, 4, 4, 4);
  for (std::size_t f = 0; f < mesh.face_count(); f += 3) std::swap(mesh.corners[3 * f], mesh.corners[3 * f + 1]);
  EXPECT_FALSE(defects_of(mesh).count(DiagnosticCode::kNonManifoldVertex));
}

TEST(find_defects, the_first_hundred_elements_are_listed_and_all_are_counted) {
  const auto found = defects_of(shapes::sheet(1, 1, 100, 1));
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).count, 202u);
  EXPECT_EQ(found.at(DiagnosticCode::kOpenBoundary).elements.size(), Diagnostic::kMaxElements);
}

TEST(find_defects, those_listed_are_the_first_of_the_input_whatever_the_order_of_edges) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh mesh = shapes::renumbered(shapes::sheet(1, 1, 100, 2), seed);
    std::map<std::set<VertexId>, std::vector<std::uint64_t>> faces_of_edge;
    for (std::uint32_t h = 0; h < mesh.corners.size(); ++h)
      faces_of_edge[{mesh.corners[h], mesh.corners[h % 3 == 2 ? h - 2 : h + 1]}].push_back(h / 3);
    std::vector<std::uint64_t> open;
    for (const auto& [edge, faces] : faces_of_edge)
      if (faces.size() == 1) open.push_back(faces[0]);
    std::sort(open.begin(), open.end());
    open.resize(Diagnostic::kMaxElements);
    EXPECT_EQ(defects_of(mesh).at(DiagnosticCode::kOpenBoundary).elements, open) << seed;
  }
}

}  // namespace
}  // namespace remesh
