#include "core/stages/duplicate_faces.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

struct Dropped {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

Dropped drop(const PolygonMesh& mesh, Mend mend = Mend::kYes) {
  RunControl control;
  Dropped result{shapes::surface(mesh), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners, control);
  result.is_changed = drop_duplicate_faces(result.surface, edges, mesh.labels, mend, result.diagnostics, control);
  return result;
}

using Faces = std::vector<std::vector<std::uint32_t>>;

/// A tetrahedron and more faces over its vertices.
PolygonMesh tetrahedron_and(const Faces& more) {
  Faces faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  faces.insert(faces.end(), more.begin(), more.end());
  return shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, faces);
}

TEST(drop_duplicate_faces, a_sound_surface_is_left_alone) {
  const Dropped result = drop(shapes::quad_box({1, 2, 3}, 3));
  EXPECT_FALSE(result.is_changed);
  EXPECT_TRUE(result.diagnostics.empty());
}

TEST(drop_duplicate_faces, repeats_from_any_corner_on_go_and_the_first_stays) {
  const Dropped result = drop(tetrahedron_and({{1, 3, 0}, {3, 0, 1}, {2, 3, 1}}));
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(result.surface.face_count(), 4u);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kDuplicateFace);
  EXPECT_EQ(result.diagnostics[0].count, 3u);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{4, 5, 6}));
}

TEST(drop_duplicate_faces, a_repeat_seen_from_behind_goes_where_each_of_its_edges_has_two_faces_then) {
  EXPECT_EQ(drop(tetrahedron_and({{1, 0, 3}})).surface.face_count(), 4u);
  EXPECT_EQ(drop(tetrahedron_and({{1, 0, 3}, {2, 1, 3}})).surface.face_count(), 4u);  // side by side
  EXPECT_EQ(drop(tetrahedron_and({{1, 0, 3}, {3, 1, 0}, {0, 1, 3}})).surface.face_count(), 4u);
}

TEST(drop_duplicate_faces, both_sides_of_a_sheet_stay_and_are_counted) {
  const PolygonMesh mesh = shapes::double_sheet(3);
  const Dropped result = drop(mesh);
  EXPECT_FALSE(result.is_changed);
  EXPECT_EQ(result.surface.face_count(), mesh.face_count());
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, mesh.face_count() / 2);
}

TEST(drop_duplicate_faces, two_faces_alone_are_found_whichever_way_they_run) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  for (const Faces& back : {Faces{{0, 1, 2}, {0, 2, 1}}, Faces{{0, 1, 2}, {2, 1, 0}}, Faces{{0, 1, 3, 2}, {1, 0, 2, 3}},
                            // From a corner that is there twice, in both directions.
                            Faces{{2, 2, 0, 1}, {2, 2, 1, 0}}, Faces{{2, 2, 0, 1}, {0, 2, 2, 1}}}) {
    const Dropped result = drop(shapes::from_lists(points, back));
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kDuplicateFace);
    EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{1}));
  }
}

TEST(drop_duplicate_faces, the_wall_between_two_solids_stays_double) {
  const PolygonMesh mesh =
      shapes::welded(shapes::joined(shapes::box({1, 1, 1}, 2), shapes::moved(shapes::box({1, 1, 1}, 2), {1, 0, 0})));
  const Dropped result = drop(mesh);
  EXPECT_FALSE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 8u);
}

TEST(drop_duplicate_faces, where_nothing_is_to_be_mended_they_are_counted_only) {
  const Dropped result = drop(tetrahedron_and({{1, 3, 0}, {1, 0, 3}}), Mend::kNo);
  EXPECT_FALSE(result.is_changed);
  EXPECT_EQ(result.surface.face_count(), 6u);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 2u);
}

TEST(drop_duplicate_faces, polygons_are_compared_as_loops) {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  EXPECT_EQ(drop(shapes::from_lists(square, {{0, 1, 2, 3}, {2, 3, 0, 1}})).surface.face_count(), 1u);
  EXPECT_EQ(drop(shapes::from_lists(square, {{0, 1, 2, 3}, {0, 2, 1, 3}})).surface.face_count(), 2u);
  EXPECT_EQ(drop(shapes::from_lists(square, {{0, 1, 2, 3}, {0, 1, 2}})).surface.face_count(), 2u);
}

TEST(drop_duplicate_faces, an_edge_of_very_many_faces_costs_no_more_than_sorting) {
  PolygonMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) mesh.positions.push_back(p);
  for (int i = 0; i < 300'000; ++i) {
    for (std::uint32_t v = 0; v < 3; ++v) mesh.corners.push_back(VertexId(v));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  EXPECT_EQ(drop(mesh).surface.face_count(), 1u);
}

}  // namespace
}  // namespace remesh
