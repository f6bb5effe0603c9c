#include "core/mending/edges/double_walls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/shapes.h"

namespace remesh {
namespace {

struct Parted {
  Surface surface;
  std::size_t edges_of_four = 0;
  double length_of_four = 0;
};

Parted part(const PolygonMesh& mesh, const std::vector<std::uint8_t>& keep_verbatim = {}) {
  RunControl control;
  Parted result{shapes::surface(mesh)};
  Surface& surface = result.surface;
  const Adjacency before(surface.vertex_count(), surface.face_begin, surface.corners, control);
  part_double_walls(surface, before, mesh.labels, 1e-9, keep_verbatim, control);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  for (const EdgeId e : edges.odd_edges()) {
    const auto around = edges.half_edges(e);
    if (around.size() != 4) continue;
    ++result.edges_of_four;
    result.length_of_four += norm(surface.positions[edges.from(around[0])] - surface.positions[edges.to(around[0])]);
  }
  return result;
}

PolygonMesh two_cubes(int cuts) {
  return shapes::welded(
      shapes::joined(shapes::box({1, 1, 1}, cuts), shapes::moved(shapes::box({1, 1, 1}, cuts), {1, 0, 0})));
}

TEST(part_double_walls, only_the_outline_of_a_wall_keeps_edges_with_four_faces) {
  for (const int cuts : {1, 2, 5})
    for (int seed = 0; seed < 6; ++seed) {
      PolygonMesh mesh = two_cubes(cuts);
      if (seed > 0) mesh = shapes::rotated(shapes::renumbered(mesh, static_cast<unsigned>(seed)), {1, 2, 3}, 40 * seed);
      const Parted result = part(mesh);
      EXPECT_EQ(result.edges_of_four, 4u * static_cast<unsigned>(cuts));
      EXPECT_NEAR(result.length_of_four, 4, 1e-9);
      // One polygon stands for two triangles in each square.
      EXPECT_EQ(result.surface.face_count(), mesh.face_count() - 2u * static_cast<unsigned>(cuts * cuts) + 1);
    }
}

TEST(part_double_walls, an_edge_that_both_sides_have_is_enough) {
  // Each side has a diagonal of its own in both squares of a wall, and the line between the squares is an edge of both.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
                         {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 1, 0}, {3, 4, 1}, {4, 2, 1}, {4, 5, 2}});
  const Parted result = part(mesh);
  EXPECT_EQ(result.edges_of_four, 0u);
  EXPECT_EQ(result.surface.face_count(), 7u);
}

TEST(part_double_walls, walls_with_other_labels_and_faces_that_must_stay_triangles_are_left) {
  PolygonMesh mesh = two_cubes(1);
  EXPECT_EQ(part(mesh, std::vector<std::uint8_t>(mesh.face_count(), 1)).surface.face_count(), mesh.face_count());
  mesh.labels.group.names = {"a", "b", "c"};
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) mesh.labels.group.of_face.push_back(f % 2);
  const Parted result = part(mesh);
  EXPECT_EQ(result.surface.face_count(), mesh.face_count());
}

TEST(part_double_walls, a_surface_without_walls_stays_as_it_is) {
  const PolygonMesh mesh = shapes::box({1, 2, 3}, 3);
  EXPECT_EQ(part(mesh).surface.face_count(), mesh.face_count());
}

}  // namespace
}  // namespace remesh
