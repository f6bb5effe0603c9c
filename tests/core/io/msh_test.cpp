#include "core/io/msh/msh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/mesh_files.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::expect_error_at_byte;
using test::expect_error_at_line;
using test::Face;
using test::faces_of;
using test::label_of_faces;

const std::string kHead22 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kHead41 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string kNodes22 = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0.1\n$EndNodes\n";
const std::string kNodes41 = "$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n$EndNodes\n";
const std::vector<Face> kTwoFaces{{0, 1, 2}, {0, 1, 2, 3}};

ReadResult read_as_msh(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_msh, content, limits);
}

TEST(msh_reader, version_2_gives_faces_and_the_names_of_their_physical_groups) {
  const ReadResult result = read_as_msh(
      kHead22 + "$PhysicalNames\n3\n2 7 \"a \"quoted\" lid\"\n1 8 \"a curve\"\n2 9 \"floor\"\n$EndPhysicalNames\n" +
      kNodes22 + "$Elements\n3\n10 1 2 8 1 1 2\n11 2 2 7 1 1 2 3\n12 3 2 8 2 1 2 3 4\n$EndElements\n");
  EXPECT_EQ(faces_of(result.mesh), kTwoFaces);
  EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 0.1}));
  // The name of a curve is none of a surface with the same number.
  EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"a \"quoted\" lid", "8"}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
}

TEST(msh_reader, version_4_gives_the_first_physical_group_of_each_surface) {
  const ReadResult result =
      read_as_msh(kHead41 + "$PhysicalNames\n1\n2 7 \"lid\"\n$EndPhysicalNames\n$Entities\n1 1 3 0\n1 0 0 0 0\n" +
                  "1 0 0 0 1 0 0 1 9 2 1 -1\n1 0 0 0 1 1 0 2 7 8 1 1\n2 0 0 0 1 1 0 1 -9 0\n3 0 0 0 1 1 0 0 0\n" +
                  "$EndEntities\n" + kNodes41 + "$Elements\n4 4 1 4\n1 1 1 1\n1 1 2\n2 1 2 1\n2 1 2 3\n" +
                  "2 2 3 1\n3 1 2 3 4\n2 3 2 1\n4 1 2 3\n$EndElements\n");
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}, {0, 1, 2}}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"lid", "9", "0"}));
  ASSERT_EQ(result.diagnostics.size(), 2u);
  EXPECT_EQ(result.diagnostics[0].count, 1u) << "an edge";
  EXPECT_EQ(result.diagnostics[1].count, 1u) << "a surface with two groups";
}

TEST(msh_reader, nodes_may_have_any_numbers_and_faces_of_higher_order_are_their_corners) {
  const std::string nodes = "$Nodes\n6\n900 0 0 0\n7 1 0 0\n8 1 1 0\n3 0.5 0 0\n2 1 0.5 0\n9000000000 0 0 0\n";
  const ReadResult result =
      read_as_msh(kHead22 + nodes + "$EndNodes\n$Elements\n1\n1 9 2 0 1 900 7 8 3 2 3\n$EndElements\n");
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}}));
  EXPECT_FALSE(result.mesh.labels.group.is_used());
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
}

TEST(msh_reader, sections_that_are_not_known_are_skipped_wherever_they_are) {
  const std::string elements = "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n";
  for (const std::string other :
       {"$Comments\n$ 1 2 x\n$EndComments\n", "$Periodic\n0\n$EndPeriodic\n", "$X\n$EndX\n"}) {
    EXPECT_EQ(read_as_msh(kHead22 + other + kNodes22 + other + elements + other).mesh.face_count(), 1u) << other;
    EXPECT_EQ(read_as_msh(test::with_line_end("\r\n", other + kHead22 + kNodes22 + elements)).mesh.face_count(), 1u);
  }
}

template <class T>
void append(std::string& out, ByteOrder order, const std::vector<T>& numbers) {
  for (const T number : numbers) {
    std::string bytes;
    append_little_endian(bytes, number);
    if (order == ByteOrder::kBig) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  }
}

/// A triangle and a quadrilateral in the physical group 7, and an edge.
std::string binary(const std::string& version, ByteOrder order) {
  using Ints = std::vector<std::int32_t>;
  using Sizes = std::vector<std::uint64_t>;
  const bool is_new = version == "4.1";
  std::string file = "$MeshFormat\n" + version + " 1 8\n";
  append(file, order, Ints{1});
  file += "\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"lid\"\n$EndPhysicalNames\n";
  if (is_new) {
    file += "$Entities\n";
    append(file, order, Sizes{0, 0, 1, 0});
    append(file, order, Ints{1});
    append(file, order, std::vector<double>{0, 0, 0, 1, 1, 0.1});
    append(file, order, Sizes{1});
    append(file, order, Ints{7});
    append(file, order, Sizes{0});
    file += "\n$EndEntities\n$Nodes\n";
    append(file, order, Sizes{1, 4, 1, 4});
    append(file, order, Ints{2, 1, 0});
    append(file, order, Sizes{4, 1, 2, 3, 4});
  } else {
    file += "$Nodes\n4\n";
  }
  std::int32_t node = 0;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0.1}}) {
    if (!is_new) append(file, order, Ints{++node});
    append(file, order, std::vector<double>{p.x, p.y, p.z});
  }
  file += "\n$EndNodes\n$Elements\n";
  if (is_new) {
    append(file, order, Sizes{3, 3, 1, 3});
    append(file, order, Ints{1, 1, 1});
    append(file, order, Sizes{1, 1, 1, 2});
    append(file, order, Ints{2, 1, 2});
    append(file, order, Sizes{1, 2, 1, 2, 3});
    append(file, order, Ints{2, 1, 3});
    append(file, order, Sizes{1, 3, 1, 2, 3, 4});
  } else {
    file += "3\n";
    append(file, order, Ints{1, 1, 2, 1, 7, 1, 1, 2});
    append(file, order, Ints{2, 1, 2, 2, 7, 1, 1, 2, 3});
    append(file, order, Ints{3, 1, 2, 3, 7, 1, 1, 2, 3, 4});
  }
  return file + "\n$EndElements\n";
}

TEST(msh_reader, binary_files_of_both_versions_and_byte_orders_say_the_same_as_text) {
  for (const std::string version : {"2.2", "4.1"}) {
    for (const ByteOrder order : {ByteOrder::kLittle, ByteOrder::kBig}) {
      const ReadResult result = read_as_msh(binary(version, order));
      EXPECT_EQ(faces_of(result.mesh), kTwoFaces) << version;
      EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 0.1}));
      EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"lid", "lid"}));
    }
  }
}

TEST(msh_reader, every_shorter_piece_of_a_binary_file_is_an_error_with_its_byte_or_line) {
  for (const std::string version : {"2.2", "4.1"}) {
    const std::string file = binary(version, ByteOrder::kLittle);
    for (std::size_t size = 0; size + 1 < file.size(); ++size) {
      const Error error = test::error_of(read_msh, file.substr(0, size));
      EXPECT_TRUE(error.line || error.byte || error.code == Code::kEmptyMesh) << size << ": " << error.what();
    }
  }
}

TEST(msh_reader, what_is_wrong_is_told_with_its_line) {
  const auto elements = [](const std::string& line) { return "$Elements\n1\n" + line + "\n$EndElements\n"; };
  const std::vector<std::pair<std::string, std::uint64_t>> wrong{
      {"$MeshFormat\n3 0 8\n$EndMeshFormat\n", 2},
      {"$MeshFormat\n2.2 1 4\n$EndMeshFormat\n", 2},
      {kHead22 + elements("1 2 0 1 2 3"), 5},
      {kHead22 + kNodes22 + elements("1 94 0 1 2 3"), 13},
      {kHead22 + kNodes22 + elements("1 2 0 1 2 x"), 13},
      {kHead22 + kNodes22 + elements("1 2 0 1 2"), 14},
      {kHead22 + kNodes22 + "$Elements\n1\n1 2 0 1 2 3 4\n$EndElements\n", 13},
      {kHead22 + kNodes22 + "$Foo\n", 11},
      {kHead22 + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n", 7},
      {kHead22 + "$PhysicalNames\n1\n2 1 lid\n$EndPhysicalNames\n", 7},
      {kHead41 + "$Nodes\n1 4 1 4\n2 1 0 5\n", 6},
      {kHead41 + "$Nodes\n1 4 1 4\n4 1 1 4\n", 6},
  };
  for (const auto& [file, line] : wrong) expect_error_at_line(read_msh, file, Code::kInvalidMesh, line);
  expect_error_at_line(read_msh, kHead22 + kNodes22 + elements("1 2 0 1 2 5"), Code::kIndexOutOfRange, 13);
  expect_error_at_line(read_msh, kHead22 + "$Nodes\n1\n1 0 nan 0\n", Code::kNonfiniteCoordinate, 6);
  EXPECT_EQ(test::error_of(read_msh, kHead22 + kNodes22 + elements("1 1 0 1 2")).code, Code::kEmptyMesh);
}

TEST(msh_reader, counts_that_the_file_has_no_room_for_cost_no_memory_and_limits_hold) {
  EXPECT_EQ(test::error_of(read_msh, kHead22 + "$Nodes\n9000000\n1 0 0 0\n").code, Code::kInvalidMesh);
  EXPECT_EQ(test::error_of(read_msh, kHead22 + "$Nodes\n99999999999\n").code, Code::kMeshTooLarge);
  const std::string two = "$Elements\n3\n1 1 0 1 2\n2 2 0 1 2 3\n3 2 0 2 3 4\n$EndElements\n";
  EXPECT_EQ(read_as_msh(kHead22 + kNodes22 + two, {4, 2}).mesh.face_count(), 2u) << "an edge is no face";
  EXPECT_EQ(test::error_of(read_msh, kHead22 + kNodes22 + two, {4, 1}).code, Code::kMeshTooLarge);
  EXPECT_EQ(test::error_of(read_msh, kHead22 + kNodes22 + two, {3, 2}).code, Code::kMeshTooLarge);
}

/// Two unit cubes side by side, one of which has a cubic cavity, with one patch a cube.
TriangleMesh cubes(std::vector<std::uint32_t>& cube_of_face) {
  TriangleMesh mesh;
  const auto add = [&](double x, double from, double to, bool is_cavity) {
    const int first = static_cast<int>(mesh.positions.size());
    for (int v = 0; v < 8; ++v)
      mesh.positions.push_back({x + (v & 1 ? to : from), v & 2 ? to : from, v & 4 ? to : from});
    constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& [a, b, c, d] : kFaces)
      for (const auto& [p, q] : {std::pair(b, c), std::pair(c, d)}) {
        const int second = is_cavity ? q : p, third = is_cavity ? p : q;
        mesh.faces.push_back({VertexId(first + a), VertexId(first + second), VertexId(first + third)});
        cube_of_face.push_back(static_cast<std::uint32_t>(first) / 8);
      }
  };
  add(0, 0, 1, false);
  add(3, 0, 1, false);
  add(0, 0.25, 0.5, true);
  return mesh;
}

TEST(msh_writer, the_lines_that_fill_the_surface_name_each_solid_and_leave_its_cavities_out) {
  std::vector<std::uint32_t> cubes_of;
  const TriangleMesh mesh = cubes(cubes_of);
  IdVector<FaceId, PatchId> patches;
  for (const std::uint32_t cube : cubes_of) patches.push_back(PatchId(cube));
  RunControl control;
  for (const MshVersion version : {MshVersion::k22, MshVersion::k41}) {
    const std::string file = write_mesh(Format::kMsh, {mesh, patches, {}, {}, {.msh_version = version}}, control);
    EXPECT_NE(
        file.find("\nSurface Loop(1) = {1};\nSurface Loop(2) = {2};\nSurface Loop(3) = {3};\nVolume(1) = {1, 3};\n"
                  "Volume(2) = {2};\nPhysical Volume(\"volume\", 4) = {1:2};\n$EndComments\n"),
        std::string::npos)
        << file.substr(0, 600);
    EXPECT_NE(file.find("$PhysicalNames\n4\n2 1 \"patch_0\"\n2 2 \"patch_1\"\n2 3 \"patch_2\"\n3 4 \"volume\"\n"),
              std::string::npos);
  }
}

TEST(msh_writer, a_patch_of_two_groups_is_two_entities_and_reads_back_in_both_versions) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 1e-300}}) mesh.positions.push_back(p);
  for (const int v : {1, 2, 1}) mesh.faces.push_back({VertexId(0), VertexId(v), VertexId(v + 1)});
  mesh.labels.group.names = {"no face", "a", "b"};
  mesh.labels.group.of_face.items() = {1, 2, 1};
  const IdVector<FaceId, PatchId> patches(3, PatchId(0));
  RunControl control;
  for (const MshVersion version : {MshVersion::k22, MshVersion::k41}) {
    const std::string file = write_mesh(Format::kMsh, {mesh, patches, {"x"}, {}, {.msh_version = version}}, control);
    EXPECT_EQ(sniff_format(file), Format::kMsh);
    const PolygonMesh back = read_mesh(Format::kMsh, file, {}, control).mesh;
    EXPECT_EQ(back.positions, mesh.positions);
    const bool is_new = version == MshVersion::k41;
    // Version 4 lists the faces of one entity after the other.
    EXPECT_EQ(faces_of(back), (is_new ? std::vector<Face>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}
                                      : std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
    EXPECT_EQ(label_of_faces(back.labels.group),
              (is_new ? std::vector<std::string>{"a", "a", "b"} : std::vector<std::string>{"a", "b", "a"}));
    EXPECT_EQ(file.find("no face"), std::string::npos);
    EXPECT_EQ(file.find("Physical Volume"), std::string::npos) << "it is open";
  }
}

TEST(smesh_writer, there_is_a_point_in_each_solid_and_in_each_cavity) {
  std::vector<std::uint32_t> cubes_of;
  const TriangleMesh mesh = cubes(cubes_of);
  const IdVector<FaceId, PatchId> patches(mesh.faces.size(), PatchId(0));
  RunControl control;
  const std::string file = write_mesh(Format::kSmesh, {mesh, patches, {}}, control);
  EXPECT_NE(file.find("# marker 1: patch_0\n# nodes\n24 3 0 0\n"), std::string::npos) << file;
  double x = 0, y = 0, z = 0, w = 0;
  const char* at = file.c_str() + file.find("# holes\n");
  ASSERT_EQ(std::sscanf(at, "# holes 1 1 %lf %lf %lf", &x, &y, &z), 3) << at;
  for (const double c : {x, y, z}) EXPECT_TRUE(c > 0.25 && c < 0.5) << at;
  at = file.c_str() + file.find("# regions\n");
  double u[3];
  ASSERT_EQ(std::sscanf(at, "# regions 2 1 %lf %lf %lf 1 -1 2 %lf %lf %lf 2 %lf", &x, &y, &z, u, u + 1, u + 2, &w), 7)
      << at;
  for (const double c : {x, y, z, u[0] - 3, u[1], u[2]}) EXPECT_TRUE(c > 0 && c < 1) << at;
  EXPECT_FALSE(x > 0.25 && x < 0.5 && y > 0.25 && y < 0.5 && z > 0.25 && z < 0.5) << "in the cavity";
  EXPECT_EQ(w, -1);
}

TEST(smesh_writer, points_are_inside_at_any_scale) {
  for (const double scale : {1e-150, 1e-30, 1e30, 1e200}) {
    std::vector<std::uint32_t> cubes_of;
    TriangleMesh mesh = cubes(cubes_of);
    for (Vec3& p : mesh.positions) p = scale * p;
    const IdVector<FaceId, PatchId> patches(mesh.faces.size(), PatchId(0));
    RunControl control;
    const std::string file = write_mesh(Format::kSmesh, {mesh, patches, {}}, control);
    double x = 0, y = 0, z = 0;
    const char* at = file.c_str() + file.find("# holes\n");
    ASSERT_EQ(std::sscanf(at, "# holes 1 1 %lf %lf %lf", &x, &y, &z), 3) << at;
    for (const double c : {x, y, z}) EXPECT_TRUE(c > 0.25 * scale && c < 0.5 * scale) << at;
  }
}

}  // namespace
}  // namespace remesh
