#include "core/mending/faces/duplicate_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/mending/faces/winding.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

struct Dropped {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

Dropped drop(const PolygonMesh& mesh, MendMode mend = MendMode::kYes) {
  RunControl control;
  Dropped result{shapes::surface(mesh), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners, control);
  result.is_changed = drop_duplicate_faces(result.surface, edges, mesh.labels, mend, result.diagnostics, control);
  return result;
}

using Faces = std::vector<std::vector<std::uint32_t>>;

/// Makes a tetrahedron and more faces over its vertices.
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
                            // These begin at a corner that is there twice, and run in both directions.
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

TEST(drop_duplicate_faces, a_wall_that_two_bodies_have_one_of_them_mirrored_stays_double) {
  const PolygonMesh mirrored = shapes::moved(shapes::turned_over(shapes::box({1, 1, 1}, 2)), {1, 0, 0});
  const PolygonMesh mesh = shapes::welded(shapes::joined(shapes::box({1, 1, 1}, 2), mirrored));
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Dropped result = drop(shapes::renumbered(mesh, seed));
    EXPECT_FALSE(result.is_changed);
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].count, 8u);
    // Both bodies are still closed, so that the mirrored one is found.
    RunControl control;
    const Surface& surface = result.surface;
    const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
    const InsideOutFaces found = find_inside_out_faces(surface, edges, {}, control);
    EXPECT_EQ(found.first.size(), 1u);
    EXPECT_EQ(std::count(found.is_inside_out.begin(), found.is_inside_out.end(), 1), 48);
  }
}

/// A box of quads with vertices 8 and 9 above its upper edge, and 10 and 11 beside that edge.
PolygonMesh quads_and(const Faces& more) {
  Faces faces{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  faces.insert(faces.end(), more.begin(), more.end());
  return shapes::from_lists({{0, 0, 0},
                             {3, 0, 0},
                             {0, 2, 0},
                             {3, 2, 0},
                             {0, 0, 1},
                             {3, 0, 1},
                             {0, 2, 1},
                             {3, 2, 1},
                             {0, 0, 2},
                             {3, 0, 2},
                             {0, -1, 1},
                             {3, -1, 1}},
                            faces);
}

TEST(drop_duplicate_faces, both_sides_of_a_fin_on_a_closed_surface_go_and_are_told_apart) {
  const Faces up{{4, 5, 9}, {9, 5, 4}, {4, 9, 8}, {8, 9, 4}}, out{{4, 5, 11, 10}, {10, 11, 5, 4}}, wall{{6, 7, 5, 4}};
  Faces all = up;
  all.insert(all.end(), out.begin(), out.end());
  all.insert(all.end(), wall.begin(), wall.end());
  for (unsigned seed = 0; seed < 8; ++seed) {
    const PolygonMesh mesh = quads_and(all);
    const Dropped result = drop(seed == 0 ? mesh : shapes::renumbered(mesh, seed));
    EXPECT_EQ(result.surface.face_count(), 6u);
    EXPECT_EQ(result.surface.vertex_count(), 8u);
    ASSERT_EQ(result.diagnostics.size(), 2u);
    EXPECT_EQ(result.diagnostics[0].count, 1u);
    EXPECT_EQ(result.diagnostics[1].count, 6u);
  }
}

TEST(drop_duplicate_faces, a_fin_on_an_open_surface_or_alone_stays) {
  Faces open{{4, 5, 9, 8}, {8, 9, 5, 4}};
  PolygonMesh mesh = quads_and(open);
  mesh.corners.erase(mesh.corners.begin(), mesh.corners.begin() + 4);  // the box has no bottom
  mesh.face_begin.pop_back();
  EXPECT_EQ(drop(mesh).surface.face_count(), 7u);
  EXPECT_EQ(drop(quads_and({{8, 9, 11, 10}, {10, 11, 9, 8}})).surface.face_count(), 8u);
}

TEST(drop_duplicate_faces, a_wall_between_solids_stays_where_a_fin_goes_on_from_it) {
  // Two cubes with a common face, and a fin on one of that face's edges.
  PolygonMesh mesh =
      shapes::welded(shapes::joined(shapes::box({1, 1, 1}, 1), shapes::moved(shapes::box({1, 1, 1}, 1), {1, 0, 0})));
  const std::size_t faces = mesh.face_count();
  std::vector<VertexId> edge;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.positions[VertexId(v)].x == 1 && mesh.positions[VertexId(v)].z == 1) edge.push_back(VertexId(v));
  ASSERT_EQ(edge.size(), 2u);
  const VertexId top(mesh.vertex_count());
  mesh.positions.push_back({1, 0.5, 2});
  for (const auto& loop : {std::array{edge[0], edge[1], top}, std::array{top, edge[1], edge[0]}}) {
    mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  EXPECT_EQ(drop(mesh).surface.face_count(), faces);
}

TEST(drop_duplicate_faces, where_nothing_is_to_be_mended_they_are_counted_only) {
  const Dropped result = drop(tetrahedron_and({{1, 3, 0}, {1, 0, 3}}), MendMode::kNo);
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

TEST(drop_duplicate_faces, of_a_back_what_looks_as_its_neighbours_do_stays_whichever_comes_first) {
  for (const Faces& faces : {Faces{{1, 0, 3}, {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                             Faces{{1, 0, 3}, {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {2, 1, 3}},
                             Faces{{0, 2, 1}, {2, 1, 3}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 3}}}) {
    const Dropped result = drop(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, faces));
    ASSERT_EQ(result.surface.face_count(), 4u);
    RunControl control;
    const Adjacency edges(4, result.surface.face_begin, result.surface.corners, control);
    for (std::uint32_t h = 0; h < 12; ++h) EXPECT_NE(edges.twin(h), kNone);
  }
}

/// Makes a cube about the origin with a label. It is cut into squares of two triangles.
PolygonMesh cube(double size, bool is_out, std::uint32_t label) {
  PolygonMesh mesh = shapes::moved(shapes::box({size, size, size}, 2), {-size / 2, -size / 2, -size / 2});
  if (!is_out) mesh = shapes::turned_over(mesh);
  mesh.labels.group.names = {"a", "b", "c", "d", "e"};
  mesh.labels.group.of_face.assign(mesh.face_count(), label);
  return mesh;
}

PolygonMesh all(const std::vector<PolygonMesh>& meshes) {
  PolygonMesh joined = meshes[0];
  for (std::size_t i = 1; i < meshes.size(); ++i) joined = shapes::joined(joined, meshes[i]);
  joined.labels = meshes[0].labels;
  for (std::size_t i = 1; i < meshes.size(); ++i)
    for (const std::uint32_t label : meshes[i].labels.group.of_face) joined.labels.group.of_face.push_back(label);
  return shapes::welded(joined);
}

/// The labels, the number of faces and the volume of the cubes of one half width, as far as they are left.
struct Left {
  std::set<std::string> labels;
  std::size_t faces = 0;
  double volume = 0;
};
std::map<double, Left> cubes_left(const PolygonMesh& mesh) {
  const Dropped result = drop(mesh);
  RunControl control;
  const Surface& surface = result.surface;
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  EXPECT_TRUE(edges.odd_edges().empty());
  EXPECT_TRUE(find_inside_out_faces(surface, edges, mesh.labels, control).first.empty());
  std::map<double, Left> left;
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    const auto t = surface.face(FaceId(i));
    double width = 0;
    for (const VertexId v : t)
      for (int axis = 0; axis < 3; ++axis) width = std::max(width, std::abs(mesh.positions[v][axis]));
    Left& of_cube = left[width];
    ++of_cube.faces;
    of_cube.volume += dot(mesh.positions[t[0]], cross(mesh.positions[t[1]], mesh.positions[t[2]])) / 6;
    of_cube.labels.insert(mesh.labels.group.names[mesh.labels.group.of_face[surface.face_source[FaceId(i)]]]);
  }
  return left;
}

TEST(drop_duplicate_faces, of_bodies_in_one_another_with_touching_walls_each_keeps_the_wall_around_it) {
  // The cavity of each body is filled by the next one, and the cavity of the last one is empty.
  for (unsigned depth = 2; depth <= 5; ++depth) {
    std::vector<PolygonMesh> walls;
    for (unsigned i = 0; i < depth; ++i) {
      walls.push_back(cube(2 * (6 - i), true, i));
      walls.push_back(cube(2 * (5 - i), false, i));
    }
    for (unsigned seed = 0; seed < 12; ++seed) {
      const double scale = seed % 2 == 0 ? 1 : 1e-4;
      PolygonMesh mesh = all(walls);
      if (seed == 1) {
        std::reverse(walls.begin(), walls.end());
        mesh = all(walls);
        std::reverse(walls.begin(), walls.end());
      } else if (seed > 1) {
        mesh = shapes::renumbered(mesh, seed);
      }
      const std::map<double, Left> left = cubes_left(shapes::scaled(mesh, scale));
      ASSERT_EQ(left.size(), depth + 1);
      for (unsigned i = 0; i <= depth; ++i) {
        const double width = scale * (6 - i), volume = 8 * width * width * width;
        const Left& found = left.at(width);
        EXPECT_EQ(found.faces, 48u);
        EXPECT_EQ(found.labels, std::set{std::string(1, static_cast<char>('a' + std::min(i, depth - 1)))});
        EXPECT_NEAR(found.volume, i < depth ? volume : -volume, 1e-12 * volume) << depth << " " << seed << " " << i;
      }
    }
  }
}

TEST(drop_duplicate_faces, of_a_surface_with_two_sides_the_right_one_stays_in_any_order) {
  // A hollow body, and one in its cavity, each face there from both sides.
  std::vector<PolygonMesh> sides;
  for (const double size : {10.0, 8.0, 6.0})
    for (const bool is_out : {false, true}) sides.push_back(cube(size, is_out, 0));
  for (unsigned seed = 0; seed < 12; ++seed) {
    const PolygonMesh mesh = all(sides);
    const std::map<double, Left> left = cubes_left(seed == 0 ? mesh : shapes::renumbered(mesh, seed));
    ASSERT_EQ(left.size(), 3u);
    EXPECT_NEAR(left.at(5).volume, 1000, 1e-9);
    EXPECT_NEAR(left.at(4).volume, -512, 1e-9);
    EXPECT_NEAR(left.at(3).volume, 216, 1e-9);
  }
}

TEST(drop_duplicate_faces, a_wall_that_two_bodies_have_is_the_smaller_ones) {
  const std::vector<PolygonMesh> bodies{cube(8, true, 1), cube(4, true, 1), cube(4, true, 0)};
  for (unsigned seed = 0; seed < 6; ++seed)
    EXPECT_EQ(cubes_left(shapes::renumbered(all(bodies), seed)).at(2).labels, std::set<std::string>{"a"});
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
