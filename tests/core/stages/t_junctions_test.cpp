#include "core/stages/t_junctions.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

struct SplitResult {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

SplitResult split(const PolygonMesh& mesh, double tolerance, Mend mend = Mend::kYes,
                  const std::vector<std::uint8_t>& as_it_is = {}) {
  RunControl control;
  SplitResult result{shapes::surface(mesh), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners);
  result.is_changed = split_t_junctions(result.surface, edges, tolerance / result.surface.unit, as_it_is, mend,
                                        result.diagnostics, control);
  return result;
}

std::size_t open_edges(const Surface& surface) {
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners);
  std::size_t count = 0;
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) count += edges.half_edges(EdgeId(e)).size() == 1;
  return count;
}

std::vector<VertexId> loop_of(const Surface& surface, std::size_t f) {
  const auto loop = surface.face(FaceId(f));
  return {loop.begin(), loop.end()};
}

/// A large triangle below y = 0 along x, and `n` small ones above, whose corners lie on its edge, raised by `off`.
PolygonMesh comb(int n, double off = 0) {
  std::vector<Vec3> points{{0, 0, 0}, {0.5, -1, 0}, {1, 0, 0}};
  std::vector<std::vector<std::uint32_t>> faces{{0, 1, 2}};
  std::vector<std::uint32_t> base{0};
  for (int i = 1; i < n; ++i) {
    base.push_back(static_cast<std::uint32_t>(points.size()));
    points.push_back({static_cast<double>(i) / n, off, 0});
  }
  base.push_back(2);
  for (int i = 0; i < n; ++i) {
    points.push_back({(i + 0.5) / n, 1, 0});
    faces.push_back({base[i], base[i + 1], static_cast<std::uint32_t>(points.size() - 1)});
  }
  return shapes::from_lists(points, faces);
}

TEST(split_t_junctions, vertices_on_an_open_edge_come_into_its_face_in_order) {
  const PolygonMesh mesh = comb(4);
  EXPECT_EQ(open_edges(shapes::surface(mesh)), 3u + 3 * 4);
  const SplitResult result = split(mesh, 1e-9);
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(open_edges(result.surface), 2u + 2 * 4);
  EXPECT_EQ(loop_of(result.surface, 0),
            (std::vector<VertexId>{VertexId(0), VertexId(1), VertexId(2), VertexId(5), VertexId(4), VertexId(3)}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTJunction);
  EXPECT_EQ(result.diagnostics[0].count, 3u);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{5, 4, 3}));
}

TEST(split_t_junctions, only_vertices_within_the_tolerance_do) {
  EXPECT_TRUE(split(comb(3, 1e-4), 2e-4).is_changed);
  EXPECT_TRUE(split(comb(3, -1e-4), 2e-4).is_changed);
  EXPECT_FALSE(split(comb(3, 1e-4), 0.5e-4).is_changed);
}

TEST(split_t_junctions, a_vertex_near_the_end_of_an_edge_is_a_matter_of_welding) {
  const PolygonMesh mesh = shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.001, 0, 0}, {0.5, -1, 0}, {0, -1, 0}}, {{0, 1, 2}, {3, 5, 4}});
  EXPECT_FALSE(split(mesh, 0.01).is_changed);
  EXPECT_TRUE(split(mesh, 0.0001).is_changed);
}

TEST(split_t_junctions, where_nothing_is_to_be_mended_or_a_face_takes_none_it_stays) {
  const SplitResult found = split(comb(4), 1e-9, Mend::kNo);
  EXPECT_FALSE(found.is_changed);
  ASSERT_EQ(found.diagnostics.size(), 1u);
  EXPECT_EQ(found.diagnostics[0].count, 3u);
  EXPECT_EQ(loop_of(found.surface, 0).size(), 3u);
  EXPECT_FALSE(split(comb(4), 1e-9, Mend::kYes, {1, 0, 0, 0, 0}).is_changed);
}

TEST(split_t_junctions, a_closed_surface_and_inner_vertices_are_left_alone) {
  EXPECT_FALSE(split(shapes::box({1, 1, 1}, 3), 0.1).is_changed);
  // A fin that stands on the inner edges of a plate: not the plate's boundary.
  PolygonMesh mesh = shapes::welded(
      shapes::joined(shapes::sheet(4, 4, 4, 4), shapes::from_lists({{1, 2, 0}, {3, 2, 0}, {2, 2, 1}}, {{0, 1, 2}})));
  EXPECT_FALSE(split(mesh, 1e-9).is_changed);
}

/// A wedge along x whose sides are `width` apart at its end, and a triangle that touches its middle line there.
PolygonMesh wedge_and_tip(double width, double at) {
  return shapes::from_lists(
      {{0, 0, 0}, {1, -width / 2, 0}, {1, width / 2, 0}, {at, 0, 0.0001}, {0.5, 0, 1}, {0.6, 0, 1}},
      {{0, 1, 2}, {3, 4, 5}});
}

TEST(split_t_junctions, a_vertex_near_two_edges_of_a_face_is_handed_to_it_once) {
  const SplitResult result = split(wedge_and_tip(0.06, 0.2), 0.01);
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(loop_of(result.surface, 0).size(), 4u);
}

TEST(split_t_junctions, a_face_that_is_as_thin_as_the_tolerance_is_handed_none) {
  EXPECT_FALSE(split(wedge_and_tip(0.01, 0.5), 0.01).is_changed);
}

TEST(split_t_junctions, very_many_long_edges_side_by_side_do_not_take_quadratic_time) {
  PolygonMesh mesh;
  constexpr int kFaces = 100'000;
  for (int i = 0; i < kFaces; ++i) {
    const double y = 1e-3 * i;
    for (const Vec3& p : {Vec3{0, y, 0}, Vec3{1000, y + 1000, 0}, Vec3{1000, y + 1000, 1e-3}})
      mesh.corners.push_back(mesh.positions.push_back(p));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  EXPECT_FALSE(split(mesh, 1e-6).is_changed);
}

}  // namespace
}  // namespace remesh
