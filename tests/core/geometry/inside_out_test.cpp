#include "core/geometry/inside_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/shapes.h"

namespace remesh {
namespace {

std::vector<FaceId> found_in(const PolygonMesh& mesh) {
  RunControl control;
  const Adjacency edges(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  const InsideOut found = find_inside_out(mesh.positions.items(), mesh.face_begin, mesh.corners, edges, control);
  EXPECT_EQ(found.is_inside_out.empty(), found.first_faces.empty());
  for (const FaceId f : found.first_faces) EXPECT_EQ(found.is_inside_out[f.value], 1);
  return found.first_faces;
}

/// A cube about the origin; inwards: it looks inwards.
PolygonMesh cube(double size, bool inwards, const Vec3& at = {}) {
  PolygonMesh mesh = shapes::moved(shapes::box({size, size, size}, 2), at - Vec3{size / 2, size / 2, size / 2});
  return inwards ? shapes::turned_over(mesh) : mesh;
}

PolygonMesh all(const std::vector<PolygonMesh>& meshes) {
  PolygonMesh joined = meshes[0];
  for (std::size_t i = 1; i < meshes.size(); ++i) joined = shapes::joined(joined, meshes[i]);
  return joined;
}

constexpr std::uint32_t kCube = 48;

TEST(find_inside_out, a_negative_volume_counts_where_it_is_no_cavity) {
  using Found = std::vector<FaceId>;
  EXPECT_EQ(found_in(cube(1, false)), Found{});
  EXPECT_EQ(found_in(cube(1, true)), Found{FaceId(0)});
  EXPECT_EQ(found_in(all({cube(4, false), cube(2, true)})), Found{});          // a cavity
  EXPECT_EQ(found_in(all({cube(4, false), cube(2, false)})), Found{});         // a solid in a solid
  EXPECT_EQ(found_in(all({cube(4, true), cube(2, true)})), Found{FaceId(0)});  // the outer one only
  EXPECT_EQ(found_in(all({cube(4, false), cube(3, true), cube(2, true)})), Found{FaceId(2 * kCube)});
  EXPECT_EQ(found_in(all({cube(5, false), cube(4, true), cube(3, false), cube(2, true)})), Found{});
  EXPECT_EQ(found_in(all({cube(1, false), cube(1, true, {3, 0, 0}), cube(1, true, {-3, 0, 0})})),
            (Found{FaceId(kCube), FaceId(2 * kCube)}));
}

/// Cubes in one another, the outermost first, that look outwards and inwards in turn: solids and their cavities. One
/// looks the wrong way.
PolygonMesh nest(int count, int wrong) {
  PolygonMesh mesh;
  const PolygonMesh shape = shapes::quad_box({2, 2, 2}, 1);
  mesh.face_begin = {0};
  for (int i = 0; i < count; ++i) {
    const double size = count - i;
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    for (const Vec3& p : shape.positions) mesh.positions.push_back(size * (p - Vec3{1, 1, 1}));
    for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
      std::vector<VertexId> loop;
      for (const VertexId v : shape.face(FaceId(f))) loop.push_back(VertexId(first + v.value));
      if ((i % 2 == 1) != (i == wrong)) std::reverse(loop.begin(), loop.end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
  }
  return mesh;
}

TEST(find_inside_out, a_nest_of_any_number_of_pieces_is_judged_right) {
  EXPECT_EQ(found_in(nest(20, 4)), std::vector<FaceId>{FaceId(4 * 6)});
  // More than all rays together may look at.
  constexpr int kMany = 6'000;
  EXPECT_EQ(found_in(nest(kMany, -1)), std::vector<FaceId>{});
  EXPECT_EQ(found_in(nest(kMany, kMany - 2)), std::vector<FaceId>{FaceId((kMany - 2) * 6)});
  EXPECT_EQ(found_in(nest(kMany, 0)), std::vector<FaceId>{FaceId(0)});
  const PolygonMesh turned = shapes::rotated(nest(kMany, kMany - 400), {1, 2, 3}, 40);
  EXPECT_EQ(found_in(turned), std::vector<FaceId>{FaceId((kMany - 400) * 6)});
  // Side by side in the innermost one.
  for (const int count : {kMany, kMany - 1}) {
    PolygonMesh mesh = nest(count, -1);
    std::vector<FaceId> inwards;
    for (int i = 0; i < 10; ++i) {
      inwards.push_back(FaceId(mesh.face_count()));
      mesh = shapes::joined(mesh, cube(0.1, true, {0.15 * i - 0.7, 0, 0}));
    }
    EXPECT_EQ(found_in(mesh), count % 2 == 0 ? inwards : std::vector<FaceId>{});
  }
}

TEST(find_inside_out, it_does_not_matter_how_all_is_turned) {
  const PolygonMesh mesh = all({cube(5, false), cube(3, true), cube(1, true), cube(0.5, true, {0, 2, 0})});
  for (int i = 0; i < 30; ++i) {
    const PolygonMesh turned = shapes::rotated(mesh, {1, 2, 3}, 12.0 * i);
    EXPECT_EQ(found_in(turned), std::vector<FaceId>{FaceId(2 * kCube)}) << i;
  }
}

TEST(find_inside_out, polygons_that_are_not_convex_count_as_what_they_cover) {
  const std::vector<Vec2> u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  const PolygonMesh solid = shapes::prism(u, 1);
  const auto in_notch = shapes::moved(cube(0.5, true), {1.5, 2, 0.5}),
             in_arm = shapes::moved(cube(0.5, true), {0.5, 2, 0.5});
  const std::uint32_t n = static_cast<std::uint32_t>(solid.face_count());
  EXPECT_EQ(found_in(shapes::joined(solid, in_notch)), std::vector<FaceId>{FaceId(n)});
  EXPECT_EQ(found_in(shapes::joined(solid, in_arm)), std::vector<FaceId>{});
}

TEST(find_inside_out, open_and_doubled_sheets_enclose_nothing) {
  EXPECT_TRUE(found_in(shapes::turned_over(shapes::sheet(1, 1, 2, 2))).empty());
  EXPECT_TRUE(found_in(shapes::rotated(shapes::double_sheet(1), {1, 2, 3}, 33)).empty());
  EXPECT_TRUE(found_in(shapes::rotated(shapes::turned_over(shapes::double_sheet(1)), {1, 2, 3}, 33)).empty());
}

}  // namespace
}  // namespace remesh
