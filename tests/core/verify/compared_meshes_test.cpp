// Tests the comparison of two meshes as they were read. near_faces_test.cpp tests its bounds.

#include "core/verify/near_faces/compared_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/remesh.h"
#include "tests/support/errors.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

verification::TwoWayDistance compared(const PolygonMesh& a, const PolygonMesh& b, std::optional<double> tolerance = {},
                                      int workers = 1) {
  RunControl control;
  return compare_surfaces(a, b, tolerance, {.workers = workers}, control);
}

TEST(compared_meshes, polygons_count_as_their_triangles_and_keep_their_numbers) {
  // Face 5 of a box of quads is raised out of the way as a face of its own, with a point of no face beside it.
  const PolygonMesh box = shapes::quad_box({1, 1, 1});
  const PolygonMesh more =
      shapes::joined(box, shapes::moved(shapes::polygon({{0, 0}, {1, 0}, {1.5, 0.5}, {1, 1}, {0, 1}}), {0, 0, 3}));
  const verification::TwoWayDistance both = compared(more, box, 0.5);
  EXPECT_EQ(both.a_to_b.face, FaceId(6));
  EXPECT_LE(both.b_to_a.bound, 1e-11);
  // A pentagon is three triangles, and one face.
  EXPECT_EQ(both.a_to_b.far_count, 3);
  ASSERT_EQ(both.a_to_b.far_faces.size(), 1);
  EXPECT_EQ(both.a_to_b.far_faces[0].face, FaceId(6));
  // Its tip is half a unit beside the box.
  EXPECT_NEAR(both.a_to_b.distance, std::hypot(2, 0.5), 1e-12);
  EXPECT_EQ(both.a_to_b.at, (Vec3{1.5, 0.5, 3}));
}

TEST(compared_meshes, vertices_may_be_there_several_times_and_unused_ones_do_not_count) {
  PolygonMesh soup = shapes::sphere(2);
  for (VertexId& corner : soup.corners) corner = soup.positions.push_back(soup.positions[corner]);
  soup.positions.push_back({1000, 0, 0});
  const verification::TwoWayDistance both = compared(soup, shapes::sphere(2));
  EXPECT_LE(std::max(both.a_to_b.bound, both.b_to_a.bound), 1e-11);
  EXPECT_DOUBLE_EQ(both.diagonal, std::sqrt(12));
}

TEST(compared_meshes, a_mesh_without_faces_is_refused) {
  EXPECT_EQ(test::error_of([] { compared(shapes::sphere(1), {}); }).code, Code::kEmptyMesh);
}

TEST(compared_meshes, it_is_the_same_for_any_number_of_workers) {
  const verification::TwoWayDistance one = compared(shapes::sphere(4), shapes::sphere(2));
  const verification::TwoWayDistance four = compared(shapes::sphere(4), shapes::sphere(2), {}, 4);
  EXPECT_EQ(one.a_to_b.bound, four.a_to_b.bound);
  EXPECT_EQ(one.b_to_a.at, four.b_to_a.at);
}

}  // namespace
}  // namespace remesh
