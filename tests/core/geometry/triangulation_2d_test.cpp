#include "core/triangulation/triangulation_2d.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace remesh {
namespace {

/// The square 0 1 2 3, counter-clockwise, with the diagonal 0-2. Half-edge 2 runs from 2 to 0, half-edge 3 from 0 to 2.
Triangulation2d square() {
  Triangulation2d mesh;
  mesh.add_triangle(0, 1, 2);
  mesh.add_triangle(0, 2, 3);
  mesh.join(2, 3);
  return mesh;
}

std::set<std::set<std::uint32_t>> triangles(const Triangulation2d& mesh) {
  std::set<std::set<std::uint32_t>> result;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    result.insert({mesh.from(h), mesh.from(h + 1), mesh.from(h + 2)});
  return result;
}

void expect_twins_agree(const Triangulation2d& mesh) {
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const std::uint32_t g = mesh.twin(h);
    if (g == kNoHalfEdge) continue;
    EXPECT_EQ(mesh.twin(g), h);
    EXPECT_EQ(mesh.from(g), mesh.to(h));
    EXPECT_EQ(mesh.to(g), mesh.from(h));
    EXPECT_EQ(mesh.is_constrained(g), mesh.is_constrained(h));
  }
}

TEST(triangulation_2d, a_flip_exchanges_the_diagonals_and_keeps_the_sides_with_their_constraints) {
  Triangulation2d mesh = square();
  mesh.constrain(0);  // 0-1
  mesh.constrain(4);  // 2-3
  mesh.flip(2);
  EXPECT_EQ(triangles(mesh), (std::set<std::set<std::uint32_t>>{{0, 1, 3}, {1, 2, 3}}));
  expect_twins_agree(mesh);
  int constrained = 0;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    if (!mesh.is_constrained(h)) continue;
    ++constrained;
    const std::set<std::uint32_t> ends{mesh.from(h), mesh.to(h)};
    EXPECT_TRUE(ends == (std::set<std::uint32_t>{0, 1}) || ends == (std::set<std::uint32_t>{2, 3}));
  }
  EXPECT_EQ(constrained, 2);
}

TEST(triangulation_2d, after_a_flip_its_half_edge_is_the_new_diagonal) {
  Triangulation2d mesh = square();
  mesh.flip(2);  // a = 2, b = 0, c = 1, d = 3
  EXPECT_EQ(mesh.from(2), 3u);
  EXPECT_EQ(mesh.to(2), 1u);
  EXPECT_EQ(mesh.twin(2), 3u);
}

TEST(triangulation_2d, the_index_of_points_survives_flips) {
  Triangulation2d mesh = square();
  mesh.index_points(5);
  EXPECT_EQ(mesh.edge_at(4), kNoHalfEdge);
  for (int i = 0; i < 3; ++i) {
    mesh.flip(2);
    for (std::uint32_t p = 0; p < 4; ++p) EXPECT_EQ(mesh.from(mesh.edge_at(p)), p);
  }
}

TEST(triangulation_2d, compacting_keeps_order_and_constraints_and_opens_what_is_lost) {
  Triangulation2d mesh = square();
  mesh.constrain(2);
  mesh.compact({0, 1});
  ASSERT_EQ(mesh.triangle_count(), 1u);
  EXPECT_EQ(triangles(mesh), (std::set<std::set<std::uint32_t>>{{0, 2, 3}}));
  EXPECT_EQ(mesh.twin(0), kNoHalfEdge);
  EXPECT_TRUE(mesh.is_constrained(0));
  EXPECT_FALSE(mesh.is_constrained(1));
}

}  // namespace
}  // namespace remesh
