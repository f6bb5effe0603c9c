#include "core/io/common/mesh_builder.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/errors.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::error_of;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class builder : public testing::Test {
 protected:
  /// Returns a builder to which a mesh with these numbers of vertices and faces was announced. It has room for all of
  /// them.
  MeshBuilder announced(std::uint64_t vertices, std::uint64_t faces) {
    MeshBuilder builder(limits_, control_);
    builder.announce(vertices, faces, vertices, faces, Place::line(1));
    return builder;
  }

  ReadLimits limits_{10, 5};
  RunControl control_;
};

TEST_F(builder, what_is_added_is_the_mesh) {
  MeshBuilder builder = announced(4, 2);
  for (int x = 0; x < 4; ++x) builder.add_vertex({double(x), 0.5, -1}, Place::line(2));
  for (const std::vector<int>& face : {std::vector{3, 1, 0}, {0, 1, 2, 3}}) {
    builder.begin_face(face.size(), Place::line(3));
    for (const int v : face) builder.add_corner(v, Place::line(3));
  }
  const PolygonMesh mesh = builder.take();
  EXPECT_EQ(test::faces_of(mesh), (std::vector<test::Face>{{3, 1, 0}, {0, 1, 2, 3}}));
  ASSERT_EQ(mesh.vertex_count(), 4u);
  EXPECT_EQ(mesh.positions[VertexId(3)], (Vec3{3, 0.5, -1}));
}

TEST_F(builder, counts_up_to_the_limits_are_let_in_and_one_more_is_told_with_its_limit) {
  EXPECT_NO_THROW(announced(10, 5));
  const Error vertices = error_of([&] { announced(11, 0); });
  EXPECT_EQ(vertices.code, Code::kMeshTooLarge);
  EXPECT_EQ(vertices.limit, 10u);
  const Error faces = error_of([&] { announced(0, 6); });
  EXPECT_EQ(faces.code, Code::kMeshTooLarge);
  EXPECT_EQ(faces.limit, 5u);
}

TEST_F(builder, nothing_is_reserved_that_the_file_has_no_room_for) {
  limits_ = {1u << 30, 1u << 30};
  MeshBuilder builder(limits_, control_);
  builder.announce(1u << 30, 1u << 30, 7, 9, Place::byte(0));
  EXPECT_LT(builder.mesh().positions.items().capacity(), 1000u);
  EXPECT_LT(builder.mesh().face_begin.capacity(), 1000u);
  EXPECT_LT(builder.mesh().corners.capacity(), 1000u);
}

TEST_F(builder, a_vertex_that_is_not_finite_is_told_by_its_number_and_place) {
  MeshBuilder builder = announced(2, 1);
  builder.add_vertex({0, 0, 0}, Place::byte(80));
  const Error error = error_of([&] { builder.add_vertex({0, kInfinity, 0}, Place::byte(92)); });
  EXPECT_EQ(error.code, Code::kNonfiniteCoordinate);
  EXPECT_EQ(error.element, 1u);
  EXPECT_EQ(error.byte, 92u);
}

TEST_F(builder, a_corner_is_one_of_the_vertices_announced_be_they_read_or_not) {
  MeshBuilder builder = announced(3, 2);
  for (const bool is_second : {false, true}) {
    builder.begin_face(3, Place::line(7));
    EXPECT_NO_THROW(builder.add_corner(0, Place::line(7)));
    EXPECT_NO_THROW(builder.add_corner(2, Place::line(7)));
    for (const std::int64_t wrong : {std::int64_t{-1}, std::int64_t{3}, std::numeric_limits<std::int64_t>::max()}) {
      const Error error = error_of([&] { builder.add_corner(wrong, Place::line(8)); });
      EXPECT_EQ(error.code, Code::kIndexOutOfRange) << wrong;
      EXPECT_EQ(error.line, 8u);
      EXPECT_EQ(error.element, is_second ? 1u : 0u);
    }
    builder.add_corner(1, Place::line(7));
  }
}

TEST_F(builder, a_face_has_three_corners_or_more_and_no_more_than_32_bits_count) {
  MeshBuilder builder = announced(3, 2);
  for (const std::uint64_t few : {0u, 1u, 2u}) {
    EXPECT_EQ(error_of([&] { builder.begin_face(few, Place::line(1)); }).code, Code::kInvalidMesh) << few;
  }
  builder.begin_face(3, Place::line(1));
  for (const std::int64_t v : {0, 1, 2}) builder.add_corner(v, Place::line(1));
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  for (const std::uint64_t many : {kMost - 2, kMost, std::numeric_limits<std::uint64_t>::max()}) {
    EXPECT_EQ(error_of([&] { builder.begin_face(many, Place::line(2)); }).code, Code::kMeshTooLarge) << many;
  }
  EXPECT_NO_THROW(builder.begin_face(kMost - 3, Place::line(2)));
}

TEST_F(builder, a_mesh_without_a_face_is_empty) {
  MeshBuilder builder = announced(1, 0);
  builder.add_vertex({1, 2, 3}, Place::line(2));
  EXPECT_EQ(error_of([&] { builder.take(); }).code, Code::kEmptyMesh);
}

TEST_F(builder, ticks_tell_how_far_reading_is_and_obey_a_stop) {
  MeshBuilder builder = announced(1, 1);
  constexpr int kMany = 10'000;
  for (int i = 0; i < kMany; ++i) builder.tick(300, 400);
  EXPECT_NEAR(control_.fraction(), 0.75, 1e-6);
  control_.cancel();
  EXPECT_EQ(error_of([&] {
              for (int i = 0; i < kMany; ++i) builder.tick(300, 400);
            }).code,
            Code::kCancelled);
}

TEST(parse_coordinate, a_token_is_a_finite_number_or_an_error_that_cites_it) {
  EXPECT_EQ(parse_coordinate("-1.5e2", Place::line(1)), -150);
  const Error word = error_of([] { parse_coordinate("12mm", Place::line(4)); });
  EXPECT_EQ(word.code, Code::kInvalidMesh);
  EXPECT_EQ(word.line, 4u);
  EXPECT_NE(std::string(word.what()).find("12mm"), std::string::npos);
  for (const char* token : {"nan", "-inf", "1e999"}) {
    EXPECT_EQ(error_of([&] { parse_coordinate(token, Place::line(1)); }).code, Code::kNonfiniteCoordinate) << token;
  }
}

}  // namespace
}  // namespace remesh
