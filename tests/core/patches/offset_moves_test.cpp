#include "core/patches/curved/offset_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace remesh {
namespace {

/// A rod along z, a ball that touches it inside at the height 0, a cone around z, and a rod along x of the same radius.
RecognisedSurfaces surfaces() {
  RecognisedSurfaces all;
  const auto add = [&](const AnalyticSurface& shape) {
    RecognisedSurface surface;
    surface.shape = shape;
    all.surfaces.push_back(surface);
  };
  add({SurfaceKind::kCylinder, {}, {0, 0, 1}, 2, 0, 0});
  add({SurfaceKind::kSphere, {}, {}, 2, 0, 0});
  add({SurfaceKind::kCone, {}, {0, 0, 1}, 0, 0, 0.5});
  add({SurfaceKind::kCylinder, {}, {1, 0, 0}, 2, 0, 0});
  return all;
}
constexpr SurfaceId kRod(0), kBall(1), kCone(2), kOtherRod(3);

std::vector<OffsetMove> moves(const Vec3& at, const OffsetSite& site) {
  std::vector<OffsetMove> found;
  add_offset_moves(at, site, surfaces(), found);
  return found;
}
/// The sum of the moves, if each surface is moved by its offset.
Vec3 way(const Vec3& at, const OffsetSite& site, const std::vector<double>& offsets) {
  IdVector<SurfaceId, double> by(surfaces().surfaces.size(), 0);
  for (std::size_t i = 0; i < offsets.size(); ++i) by[SurfaceId(i)] = offsets[i];
  const std::vector<OffsetMove> found = moves(at, site);
  return moved_by(found, by);
}
void expect_move(const Vec3& a, const Vec3& b, double tolerance = 1e-14) {
  EXPECT_LE(norm(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(offset_moves, a_vertex_of_one_surface_moves_along_its_normal) {
  expect_move(way({0, 2, 5}, {{kRod}, {}, {}}, {0.1}), {0, 0.1, 0});
  expect_move(way({0, 0, 2}, {{kBall}, {}, {}}, {0, 0.1}), {0, 0, 0.1});
}

TEST(offset_moves, a_cone_turns_around_its_apex) {
  const double along = 3, angle = 1e-6;
  const Vec3 at{along * std::sin(0.5), 0, along * std::cos(0.5)};
  const Vec3 to{along * std::sin(0.5 + angle), 0, along * std::cos(0.5 + angle)};
  expect_move(way(at, {{kCone}, {}, {}}, {0, 0, angle}), to - at, 1e-11);
  EXPECT_TRUE(moves({}, {{kCone}, {}, {}}).empty()) << "the apex";
}

TEST(offset_moves, a_vertex_keeps_to_its_planes_and_lines) {
  expect_move(way({0, 2, 5}, {{kRod}, {{0, 0, 1}}, {}}, {0.1}), {0, 0.1, 0});
  // A plane through the axis ends at the rod, and so does a cap.
  expect_move(way({0, 2, 5}, {{kRod}, {{0, 0, 1}, {1, 0, 0}}, {}}, {0.1}), {0, 0.1, 0});
  expect_move(way({0, 2, 5}, {{kRod}, {{0, 0, 1}, {1, 0, 0}}, {{0, 1, 0}}}, {0.1}), {0, 0.1, 0});
  // In an oblique plane, the vertex is outside by about the offset.
  const Vec3 oblique = normalized({0, 1, 2});
  const Vec3 in_plane = way({0, 2, 5}, {{kRod}, {oblique}, {}}, {0.1});
  EXPECT_NEAR(dot(in_plane, oblique), 0, 1e-16);
  EXPECT_NEAR(in_plane.y, 0.1, 0.01);
  // Three planes, two lines, or a plane across the line leave no way.
  EXPECT_TRUE(way({0, 2, 5}, {{kRod}, {{0, 0, 1}, {1, 0, 0}, normalized({1, 1, 1})}, {}}, {0.1}) == Vec3{});
  EXPECT_TRUE(way({0, 2, 5}, {{kRod}, {}, {{0, 1, 0}, {0, 0, 1}}}, {0.1}) == Vec3{});
  EXPECT_TRUE(way({0, 2, 5}, {{kRod}, {normalized({0, 1, 1})}, {{0, 1, 0}}}, {0.1}) == Vec3{});
}

TEST(offset_moves, a_vertex_stays_where_a_plane_touches_the_surface) {
  EXPECT_TRUE(moves({0, 2, 5}, {{kRod}, {{0, 1, 0}}, {}}).empty());
  // So it does if the plane is off by rounding.
  EXPECT_TRUE(moves({0, 2, 5}, {{kRod}, {normalized({1e-6, 1, 1e-6})}, {}}).empty());
}

TEST(offset_moves, planes_that_are_the_same_up_to_rounding_count_once) {
  const Vec3 almost = normalized({3e-9, -4e-9, 1});
  expect_move(way({0, 2, 5}, {{kRod}, {{0, 0, 1}, almost}, {}}, {0.1}), {0, 0.1, 0}, 1e-8);
  expect_move(way({0, 2, 5}, {{kRod}, {{0, 0, 1}}, {{0, 1, 0}, {1e-7, -1, 0}}}, {0.1}), {0, 0.1, 0}, 1e-7);
}

TEST(offset_moves, where_two_surfaces_meet_a_vertex_moves_out_of_both) {
  // Both have the same normal here.
  const Vec3 across = way({0, 2, 0}, {{kRod, kOtherRod}, {}, {}}, {0.1, 0, 0, 0.1});
  EXPECT_NEAR(across.y, 0.1, 0.005);
  const Vec3 at{2, 0, 2};  // on both rods, whose normals there are x and z
  const Vec3 both = way(at, {{kRod, kOtherRod}, {}, {}}, {0.1, 0, 0, 0.2});
  EXPECT_NEAR(both.x, 0.1, 1e-14);
  EXPECT_NEAR(both.z, 0.2, 1e-14);
}

TEST(offset_moves, where_two_surfaces_touch_a_vertex_moves_by_a_mean) {
  const Vec3 at{0, 2, 0};
  EXPECT_NEAR(way(at, {{kRod, kBall}, {}, {}}, {0.1, 0.1}).y, 0.1, 0.005);
  EXPECT_NEAR(way(at, {{kRod, kBall}, {}, {}}, {0.1, 0.3}).y, 0.2, 0.01);
  // Nearly touching surfaces with different offsets do not send it far away.
  const Vec3 near{0.02, std::sqrt(4 - 0.0004 - 0.04), 0.2};
  EXPECT_LE(norm(way(near, {{kRod, kBall}, {}, {}}, {0.1, 0.3})), 0.6);
}

TEST(offset_moves, they_are_found_by_vertex) {
  OffsetMoves list;
  list.add(VertexId(2), {0, 2, 5}, {{kRod}, {}, {}}, surfaces());
  list.add(VertexId(4), {0, 2, 5}, {{kRod}, {{0, 1, 0}}, {}}, surfaces());
  OffsetMoves others;
  others.add(VertexId(2), {1, 1, 1}, list.moves(0));
  others.add(VertexId(3), {1, 1, 1}, list.moves(1));
  EXPECT_EQ(list.find(VertexId(4)), 1U);
  EXPECT_EQ(list.find(VertexId(3)), list.size());
  EXPECT_EQ(list.moves(0).size(), 1U);
  EXPECT_TRUE(list.moves(1).empty());
  EXPECT_EQ(others.moves(0).size(), 1U);
  EXPECT_EQ(others.place(0), (Vec3{1, 1, 1}));
  EXPECT_TRUE(others.moves(1).empty());
}

}  // namespace
}  // namespace remesh
