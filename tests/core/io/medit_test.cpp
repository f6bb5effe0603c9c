#include "core/io/medit/medit.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/io/mesh_files.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::expect_error_at_line;
using test::Face;
using test::faces_of;
using test::label_of_faces;

const std::string kHead = "MeshVersionFormatted 2\nDimension 3\n";
const std::string kVertices = "Vertices\n4\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0.1 5\n";

ReadResult read_as_medit(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_medit, content, limits);
}

TEST(medit_reader, triangles_and_quadrilaterals_come_with_their_references_as_groups) {
  const std::string faces = "Triangles\n1\n1 2 3 7\nQuadrilaterals\n1\n1 2 3 4 -2\n";
  for (const std::string& file :
       {kHead + kVertices + faces + "End\n", kHead + kVertices + faces,
        std::string("MeshVersionFormatted\n1\n\nDimension\n3\n\n# by hand\n") + kVertices + "\n\n" + faces + "\nEnd",
        test::with_line_end("\r\n", kHead + kVertices + faces + "End\n"),
        test::with_line_end(" ", kHead + kVertices + faces + "End\n")}) {
    const ReadResult result = read_as_medit(file);
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}}));
    EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 0.1}));
    EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"7", "-2"}));
  }
}

TEST(medit_reader, names_are_in_comments_and_a_reference_of_0_alone_is_none) {
  const auto groups = [](const std::string& comments, const std::string& reference) {
    return label_of_faces(
        read_as_medit(kHead + comments + kVertices + "Triangles 1 1 2 3 " + reference + "\nEnd").mesh.labels.group);
  };
  EXPECT_EQ(groups("# reference 7: a lid # b\n# reference 7: twice\n", "7"), std::vector<std::string>{"a lid # b"});
  EXPECT_EQ(groups("# reference 8: other\n# reference x: y\n#reference\n", "7"), std::vector<std::string>{"7"});
  EXPECT_EQ(groups("", "0"), std::vector<std::string>{});
  EXPECT_EQ(groups("# reference 0: rest\n", "0"), std::vector<std::string>{"rest"});
}

TEST(medit_reader, other_records_are_skipped_and_counted) {
  const ReadResult result = read_as_medit(
      kHead + kVertices + "Corners\n2\n1 2\nEdges 1\n1 2 9\nTriangles\n1\n1 2 3 0\nTetrahedra\n1\n1 2 3 4 1\n" +
      "SubDomainFromMesh\n0\nEnd\n");
  EXPECT_EQ(result.mesh.face_count(), 1u);
  ASSERT_EQ(result.diagnostics.size(), 3u);
  EXPECT_EQ(result.diagnostics[0].message, "records of Corners were dropped: 2");
  EXPECT_EQ(result.diagnostics[1].message, "records of Edges were dropped: 1");
}

TEST(medit_reader, what_is_wrong_is_told_with_its_line) {
  const std::vector<std::pair<std::string, std::uint64_t>> wrong{
      {"", 0},
      {"Mesh 2\n", 1},
      {"MeshVersionFormatted 2\nDimension 2\n", 2},
      {kHead + "Triangles\n1\n1 2 3 0\n", 3},
      {kHead + "Vertices\n2\n0 0 0 0\n1 0 0\n", 6},
      {kHead + "Vertices\n1\n0 0 0 0 0\n", 5},
      {kHead + kVertices + "Triangles\n1\n0 1 2 0\n", 11},
      {kHead + kVertices + "Triangles\n1\n1 2 3 x\n", 11},
      {kHead + kVertices + kVertices, 9},
  };
  for (const auto& [file, line] : wrong) expect_error_at_line(read_medit, file, Code::kInvalidMesh, line);
  expect_error_at_line(read_medit, kHead + kVertices + "Triangles\n1\n1 2 5 0\n", Code::kIndexOutOfRange, 11);
  expect_error_at_line(read_medit, kHead + "Vertices\n1\n0 0 1e999 0\n", Code::kNonfiniteCoordinate, 5);
  EXPECT_EQ(test::error_of(read_medit, kHead + kVertices + "End\n").code, Code::kEmptyMesh);
}

TEST(medit_reader, counts_that_the_file_has_no_room_for_cost_no_memory_and_limits_hold) {
  EXPECT_EQ(test::error_of(read_medit, kHead + "Vertices\n9000000\n0 0 0 0\n").code, Code::kInvalidMesh);
  EXPECT_EQ(test::error_of(read_medit, kHead + "Vertices\n99999999999\n").code, Code::kMeshTooLarge);
  const std::string huge = "18446744073709551615";
  EXPECT_EQ(test::error_of(read_medit, kHead + kVertices + "Triangles 1 1 2 3 0 Quadrilaterals " + huge).code,
            Code::kMeshTooLarge);
  const std::string two = kHead + kVertices + "Triangles 1 1 2 3 0 Quadrilaterals 1 1 2 3 4 0 End";
  EXPECT_EQ(read_as_medit(two, {4, 2}).mesh.face_count(), 2u);
  EXPECT_EQ(test::error_of(read_medit, two, {4, 1}).code, Code::kMeshTooLarge);
}

TEST(medit_writer, what_is_written_reads_back_bit_for_bit_with_the_names) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{-0.0, 5e-324, 1e308}, Vec3{1, 0.1, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 1.0 / 3}})
    mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  mesh.faces.push_back({VertexId(0), VertexId(2), VertexId(3)});
  mesh.labels.material.names = {"Wand größe 1", "unused", "b"};
  mesh.labels.material.of_face.items() = {2, 0};
  const IdVector<FaceId, PatchId> patches(2, PatchId(0));
  RunControl control;
  for (const NameRule rule : {NameRule::kPortable, NameRule::kExact}) {
    const WriterInput input{mesh, patches, {"a comment\nof two lines"}, {}, {.names = rule}};
    const std::string file = write_mesh(Format::kMesh, input, control);
    EXPECT_EQ(sniff_format(file), Format::kMesh);
    const PolygonMesh back = read_mesh(Format::kMesh, file, {}, control).mesh;
    EXPECT_EQ(back.positions, mesh.positions);
    EXPECT_TRUE(std::signbit(back.positions[VertexId(0)].x));
    EXPECT_EQ(faces_of(back), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(label_of_faces(back.labels.group),
              (std::vector<std::string>{"b", rule == NameRule::kExact ? "Wand größe 1" : "Wand_gr__e_1"}));
    EXPECT_EQ(renamed_labels(Format::kMesh, input, control).size(), rule == NameRule::kExact ? 0u : 1u);
  }
}

}  // namespace
}  // namespace remesh
