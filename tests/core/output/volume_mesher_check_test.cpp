#include "core/output/report/volume_mesher_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/intersections/self_intersections.h"
#include "core/mesh/triangle_corners.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

std::map<DiagnosticCode, VolumeObstacle> obstacles_of(const PolygonMesh& mesh, const BodyLabels& labels = {}) {
  RunControl control;
  const TriangleMesh triangles = shapes::triangles(mesh);
  const auto& positions = triangles.positions.items();
  const auto& faces = triangles.faces.items();
  const SelfIntersections found = self_intersections(positions, faces, {}, 1'000'000, control);
  const std::vector<std::uint32_t> begins = triangle_begins(faces.size(), control);
  const Adjacency edges(positions.size(), begins, corners_of(faces), control);
  std::map<DiagnosticCode, VolumeObstacle> by_code;
  for (VolumeObstacle& o :
       find_volume_obstacles(positions, corners_of(faces), edges, labels, found.pairs, 1e-9, control)) {
    EXPECT_EQ(o.places.size(), std::min<std::size_t>(o.count, VolumeObstacle::kMaxPlaces));
    by_code[o.code] = std::move(o);
  }
  return by_code;
}

/// Makes a roof of two pages that meet under this angle. It is closed below and at its ends.
PolygonMesh wedge(double degrees) {
  const double h = std::tan(degrees * std::numbers::pi / 180);
  return shapes::from_lists({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {1, 0, h}, {1, 1, h}},
                            {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}});
}

TEST(find_volume_obstacles, solids_have_none) {
  EXPECT_TRUE(obstacles_of(shapes::box({1, 2, 3}, 3)).empty());
  EXPECT_TRUE(obstacles_of(shapes::sphere(3)).empty());
  EXPECT_TRUE(obstacles_of(wedge(1)).empty());
  EXPECT_TRUE(
      obstacles_of(shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::box({1, 1, 1}), {3, 0, 0}))).empty());
}

TEST(find_volume_obstacles, open_edges_are_located_in_their_middles) {
  const auto found = obstacles_of(shapes::sheet(2, 2, 1, 1));
  ASSERT_EQ(found.size(), 1u);
  const VolumeObstacle& open = found.at(DiagnosticCode::kOpenBoundary);
  EXPECT_EQ(open.count, 4u);
  EXPECT_NE(std::find(open.places.begin(), open.places.end(), Vec3{1, 0, 0}), open.places.end());
}

TEST(find_volume_obstacles, of_many_all_are_counted_and_the_first_hundred_located) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    for (const Vec3& corner : {Vec3{2.0 * i, 0, 0}, Vec3{2.0 * i + 1, 0, 0}, Vec3{2.0 * i, 1, 0}})
      points.push_back(corner);
    faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const auto found = obstacles_of(shapes::from_lists(points, faces));
  ASSERT_EQ(found.size(), 1u);
  const VolumeObstacle& open = found.at(DiagnosticCode::kOpenBoundary);
  EXPECT_EQ(open.count, 12'000u);
  ASSERT_EQ(open.places.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(std::floor(open.places[i].x / 2), static_cast<double>(i / 3)) << i;
}

TEST(find_volume_obstacles, edges_of_more_faces_and_of_odd_winding_are_counted) {
  EXPECT_EQ(obstacles_of(shapes::three_pages()).at(DiagnosticCode::kNonManifoldEdge).count, 1u);
  PolygonMesh mesh = shapes::box({1, 1, 1});
  std::swap(mesh.corners[0], mesh.corners[1]);
  EXPECT_EQ(obstacles_of(mesh).at(DiagnosticCode::kInconsistentWinding).count, 3u);
}

TEST(find_volume_obstacles, angles_between_faces_are_small_from_a_tenth_of_a_degree_down) {
  EXPECT_TRUE(obstacles_of(wedge(0.11)).empty());
  const auto found = obstacles_of(wedge(0.09));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kSmallDihedral).count, 1u);
  EXPECT_EQ(found.at(DiagnosticCode::kSmallDihedral).places.at(0), (Vec3{0, 0.5, 0}));
}

TEST(find_volume_obstacles, around_an_edge_of_many_faces_small_angles_are_found) {
  for (const int pages : {3, 20}) {
    std::vector<Vec3> points{{0, 0, 0}, {0, 0, 1}};
    std::vector<std::vector<std::uint32_t>> faces;
    for (int i = 0; i < pages; ++i) {
      const double angle = i + 1 == pages ? 1e-4 : 2 * std::numbers::pi * i / pages;
      points.push_back({std::cos(angle), std::sin(angle), 0.5});
      faces.push_back({0, 1, static_cast<std::uint32_t>(i + 2)});
    }
    EXPECT_EQ(obstacles_of(shapes::from_lists(points, faces)).at(DiagnosticCode::kSmallDihedral).count, 1u) << pages;
  }
}

TEST(find_volume_obstacles, doubled_and_crossing_and_overlapping_faces_are_told_apart) {
  EXPECT_EQ(obstacles_of(shapes::double_sheet(2)).at(DiagnosticCode::kDuplicateFace).count,
            shapes::double_sheet(2).face_count() / 2);
  EXPECT_FALSE(obstacles_of(shapes::double_sheet(2)).count(DiagnosticCode::kOverlappingFaces));
  const PolygonMesh flat = shapes::sheet(2, 2, 1, 1);
  const auto lying = obstacles_of(shapes::joined(flat, shapes::moved(flat, {0.5, 0.25, 0})));
  EXPECT_GT(lying.at(DiagnosticCode::kOverlappingFaces).count, 0u);
  const PolygonMesh cut = shapes::from_lists({{0.5, 0.6, -1}, {0.7, 0.6, -1}, {0.6, 0.7, 2}}, {{0, 1, 2}});
  const auto crossing = obstacles_of(shapes::joined(flat, cut));
  EXPECT_GT(crossing.at(DiagnosticCode::kSelfIntersection).count, 0u);
  EXPECT_FALSE(crossing.count(DiagnosticCode::kOverlappingFaces));
}

TEST(find_volume_obstacles, a_cavity_that_looks_outwards_is_one_unless_it_has_labels_of_its_own) {
  const PolygonMesh outer = shapes::box({3, 3, 3}), inner = shapes::moved(shapes::box({1, 1, 1}), {1, 1, 1});
  EXPECT_TRUE(obstacles_of(shapes::joined(outer, shapes::turned_over(inner))).empty());
  const auto found = obstacles_of(shapes::joined(outer, inner));
  ASSERT_EQ(found.size(), 1u);
  ASSERT_EQ(found.at(DiagnosticCode::kInsideOut).count, 1u);
  const Vec3 place = found.at(DiagnosticCode::kInsideOut).places[0];
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(place[axis] >= 1 && place[axis] <= 2);
  BodyLabels labels{{}, {0, 1, 2}, {0, 1}};
  labels.set_of.assign(12, 0);
  labels.set_of.resize(24, 1);
  EXPECT_TRUE(obstacles_of(shapes::joined(outer, inner), labels).empty());
}

TEST(find_volume_obstacles, shells_inside_out_are_located) {
  const PolygonMesh mesh =
      shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::turned_over(shapes::box({1, 1, 1})), {3, 0, 0}));
  const auto found = obstacles_of(mesh);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GE(found.at(DiagnosticCode::kInsideOut).places.at(0).x, 3);
}

}  // namespace
}  // namespace remesh
