#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "core/io/obj/obj.h"

namespace remesh {
namespace {

TriangleMesh two_triangles() {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0.5}, Vec3{1, 1, -2}, Vec3{0, 1, 1e-9}}) mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  mesh.faces.push_back({VertexId(0), VertexId(2), VertexId(3)});
  return mesh;
}

LabelSet labels(std::vector<std::string> names, std::vector<std::uint32_t> of_face) {
  LabelSet set;
  set.names = std::move(names);
  set.of_face.items() = std::move(of_face);
  return set;
}

std::string write(const TriangleMesh& mesh, const std::vector<std::string>& comments = {}) {
  RunControl control;
  return write_obj(mesh, comments, control);
}

PolygonMesh read_back(const std::string& text) {
  RunControl control;
  return read_obj(text, {}, control).mesh;
}

TEST(obj_writer, vertices_come_in_shortest_numbers_and_faces_count_from_one) {
  EXPECT_EQ(write(two_triangles()),
            "v 0 0 0\n"
            "v 1 0 0.5\n"
            "v 1 1 -2\n"
            "v 0 1 1e-09\n"
            "f 1 2 3\n"
            "f 1 3 4\n");
}

TEST(obj_writer, comments_and_material_libraries_come_first) {
  TriangleMesh mesh = two_triangles();
  mesh.labels.material_libraries = {"a.mtl b.mtl", "c.mtl"};
  EXPECT_TRUE(write(mesh, {"remeshed", ""}).starts_with("# remeshed\n#\nmtllib a.mtl b.mtl\nmtllib c.mtl\nv 0 0 0\n"));
}

TEST(obj_writer, a_label_is_written_where_it_changes) {
  TriangleMesh mesh = two_triangles();
  mesh.faces.push_back({VertexId(1), VertexId(2), VertexId(3)});
  mesh.labels.object = labels({"hull"}, {0, 0, 0});
  mesh.labels.group = labels({"", "deck"}, {0, 1, 1});
  mesh.labels.material = labels({"steel", "glass"}, {0, 1, 0});
  const std::string text = write(mesh);
  EXPECT_EQ(text.substr(text.find('o')),
            "o hull\ng\nusemtl steel\nf 1 2 3\n"
            "g deck\nusemtl glass\nf 1 3 4\n"
            "usemtl steel\nf 2 3 4\n");
}

TEST(obj_writer, text_in_comments_and_names_cannot_make_a_record) {
  TriangleMesh mesh = two_triangles();
  mesh.labels.material_libraries = {"a.mtl\nv 9 9 9"};
  mesh.labels.object = labels({"o\rf 1 1 1"}, {0, 0});
  mesh.labels.group = labels({std::string("g\0h", 3)}, {0, 0});
  mesh.labels.material = labels({"C:\\dir\\"}, {0, 0});
  const std::string text = write(mesh, {"one\nv 9 9 9", "two\r\nv 9 9 9\rv 8 8 8\n", "path\\"});
  const PolygonMesh back = read_back(text);
  EXPECT_EQ(back.vertex_count(), 4u);
  EXPECT_EQ(back.face_count(), 2u);
  EXPECT_EQ(back.labels.material_libraries, std::vector<std::string>{"a.mtl v 9 9 9"});
  EXPECT_EQ(back.labels.object.names, std::vector<std::string>{"o f 1 1 1"});
  EXPECT_EQ(back.labels.group.names, std::vector<std::string>{"g h"});
  EXPECT_EQ(back.labels.material.names, std::vector<std::string>{"C:\\dir\\"}) << "and does not continue the line";
  EXPECT_TRUE(text.starts_with("# one\n# v 9 9 9\n# two\n# v 9 9 9\n# v 8 8 8\n#\n# path\\ \nmtllib")) << text;
}

TEST(obj_writer, any_finite_doubles_and_labels_read_back_bit_for_bit) {
  std::mt19937_64 random(7);
  TriangleMesh mesh;
  while (mesh.positions.size() < 20'000) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t bits = random();
      std::memcpy(&p[axis], &bits, sizeof bits);
    }
    if (is_finite(p)) mesh.positions.push_back(p);
  }
  mesh.positions.push_back({0.0, -0.0, 5e-324});
  const auto pick = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
  for (int f = 0; f < 30'000; ++f) {
    mesh.faces.push_back({VertexId(pick(20'001)), VertexId(pick(20'001)), VertexId(pick(20'001))});
  }
  mesh.labels.group = labels({"a", "", "b c", "#d"}, {0, 1, 2, 3});
  mesh.labels.material = labels({""}, {});
  while (mesh.labels.group.of_face.size() < mesh.faces.size()) mesh.labels.group.of_face.push_back(pick(4));
  mesh.labels.material.of_face.assign(mesh.faces.size(), 0);

  const PolygonMesh back = read_back(write(mesh));
  ASSERT_EQ(back.vertex_count(), mesh.positions.size());
  EXPECT_EQ(
      std::memcmp(back.positions.items().data(), mesh.positions.items().data(), sizeof(Vec3) * back.vertex_count()), 0);
  ASSERT_EQ(back.face_count(), mesh.faces.size());
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    const auto face = back.face(FaceId(f));
    ASSERT_TRUE(std::equal(face.begin(), face.end(), mesh.faces[FaceId(f)].begin(), mesh.faces[FaceId(f)].end())) << f;
  }
  EXPECT_EQ(back.labels, mesh.labels);
}

TEST(obj_writer, any_number_of_threads_writes_the_same_bytes) {
  TriangleMesh mesh;
  for (int i = 0; i < 50'000; ++i) mesh.positions.push_back({1.0 / (i + 1), std::sqrt(i), -1.5 * i});
  for (std::uint32_t f = 0; f < 70'000; ++f)
    mesh.faces.push_back({VertexId(f % 50'000), VertexId(f * 7 % 50'000), VertexId(f / 2)});
  mesh.labels.group = labels({"a", "b"}, {});
  for (std::uint32_t f = 0; f < 70'000; ++f) mesh.labels.group.of_face.push_back(f / 4000 % 2);
  const auto write_with = [&](int threads) { return tbb::task_arena(threads).execute([&] { return write(mesh); }); };
  const std::string alone = write_with(1);
  EXPECT_EQ(std::count(alone.begin(), alone.end(), 'g'), 18);
  for (const int threads : {2, 5}) EXPECT_EQ(write_with(threads), alone);
}

TEST(obj_writer, a_stop_is_obeyed_and_progress_shown) {
  RunControl control;
  TriangleMesh mesh = two_triangles();
  for (int i = 0; i < 100'000; ++i) mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  (void)write_obj(mesh, {}, control);
  EXPECT_EQ(control.stage(), Stage::kWrite);
  EXPECT_GT(control.fraction(), 0.5);
  EXPECT_LE(control.fraction(), 1);
  control.cancel();
  try {
    (void)write_obj(mesh, {}, control);
    FAIL() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled);
  }
}

}  // namespace
}  // namespace remesh
