#include "core/io/fe/fe.h"

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

const std::string kNodes = "*NODE\n1, 0, 0, 0\n2, 1., 0., 0.\n3, 1., 1D0, 0.\n14, 0., 1., 1.5-3\n";

ReadResult read_as_abaqus(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_abaqus, content, limits);
}
ReadResult read_as_nastran(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_nastran, content, limits);
}

TEST(abaqus_reader, shells_come_by_their_corners_with_the_sets_of_their_elements) {
  const std::string elements =
      "*ELEMENT, TYPE=S3, ELSET=lid\n5, 1, 2, 3\n*Element, type=S4R, elset=\"side wall\"\n6, 1, 2, 3, 14\n";
  for (const std::string& file : {"*HEADING\na part\n" + kNodes + elements, "** by hand\n" + elements + kNodes,
                                  "*PART, NAME=a\n" + kNodes + elements +
                                      "*END PART\n*ASSEMBLY\n*INSTANCE, NAME=b, PART=a\n*END INSTANCE\n*END ASSEMBLY\n",
                                  test::with_line_end("\r\n", kNodes + elements),
                                  kNodes + "*ELEMENT,\nTYPE=S3,\nELSET=lid\n5,1,2,\n3\n"
                                           "*ELEMENT,TYPE=CPS4,ELSET=side wall\n6,1,2,3,\n14\n"}) {
    const ReadResult result = read_as_abaqus(file);
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}})) << file;
    EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 1.5e-3}));
    EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"lid", "side wall"}));
  }
  const ReadResult higher =
      read_as_abaqus(kNodes + "*ELEMENT,TYPE=STRI65\n1,1,2,3,14,14,14\n*ELEMENT,TYPE=S8R\n2,1,2,3,14,\n1,1,1,1\n");
  EXPECT_EQ(faces_of(higher.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}}));
  EXPECT_FALSE(higher.mesh.labels.group.is_used());
}

TEST(abaqus_reader, sets_that_follow_name_faces_and_the_first_one_wins) {
  const std::string faces = kNodes + "*ELEMENT, TYPE=S3, ELSET=own\n11,1,2,3\n12,1,3,14\n13,2,3,14\n14,1,2,14\n";
  const auto groups = [&](const std::string& sets) {
    return label_of_faces(read_as_abaqus(faces + sets).mesh.labels.group);
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(groups("*ELSET, ELSET=a\n12, 11,\n*ELSET, ELSET=b, GENERATE\n12, 13\n"), (Names{"a", "a", "b", "own"}));
  EXPECT_EQ(groups("*ELSET, ELSET=a, GENERATE\n1, 4000000, 2\n"), (Names{"a", "own", "a", "own"}));
  EXPECT_EQ(groups("*ELSET, ELSET=a\nown, 99\n"), (Names{"own", "own", "own", "own"}));
  std::string many;
  for (int i = 0; i < 100; ++i) many += "*ELSET, ELSET=s, GENERATE\n1, 100\n";
  EXPECT_EQ(test::error_of(read_abaqus, faces + many).code, Code::kInvalidMesh) << "work in proportion";
}

TEST(abaqus_reader, parts_count_on_their_own_and_other_elements_are_counted) {
  const std::string part =
      kNodes + "*ELEMENT, TYPE=S3\n1, 1, 2, 14\n*ELEMENT, TYPE=C3D4\n7, 1, 2, 3, 14\n8, 1, 2,\n3, 14\n";
  const ReadResult result =
      read_as_abaqus("*PART, NAME=a\n" + part + "*END PART\n*PART, NAME=b\n" + part + "*END PART\n");
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 3}, {4, 5, 7}}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_GE(result.diagnostics[0].count, 4u);
}

TEST(abaqus_reader, what_is_wrong_is_refused_with_its_line) {
  const std::string face = "*ELEMENT, TYPE=S3\n1, 1, 2, 3\n";
  expect_error_at_line(read_abaqus, kNodes + "*INCLUDE, INPUT=other.inp\n" + face, Code::kInvalidMesh, 6);
  expect_error_at_line(read_abaqus, "*NODE, SYSTEM=C\n1,0,0,0\n", Code::kInvalidMesh, 1);
  expect_error_at_line(read_abaqus, kNodes + "*ELEMENT, TYPE=S3\n1, 1, 2, 5\n", Code::kIndexOutOfRange, 7);
  expect_error_at_line(read_abaqus, kNodes + "*ELEMENT, TYPE=S3\n1, 1, 2, x\n", Code::kInvalidMesh, 7);
  expect_error_at_line(read_abaqus, kNodes + "*ELEMENT, TYPE=S3\n1, 1, 2, 3, 14\n", Code::kInvalidMesh, 7);
  expect_error_at_line(read_abaqus, kNodes + "*ELEMENT, TYPE=S4\n1, 1, 2, 3\n" + face, Code::kInvalidMesh, 8);
  expect_error_at_line(read_abaqus, "*NODE\n1, 1e999, 0, 0\n", Code::kNonfiniteCoordinate, 2);
  expect_error_at_line(read_abaqus, "*NODE\n1, 1..2, 0, 0\n", Code::kInvalidMesh, 2);
  expect_error_at_line(read_abaqus,
                       "*PART, NAME=a\n*END PART\n*INSTANCE, PART=a\n1, 0, 0\n*END INSTANCE\n" + kNodes + face,
                       Code::kInvalidMesh, 4);
  EXPECT_EQ(test::error_of(read_abaqus, kNodes + kNodes + face).code, Code::kInvalidMesh) << "nodes twice";
  EXPECT_EQ(test::error_of(read_abaqus, kNodes + face + face).code, Code::kInvalidMesh) << "elements twice";
  EXPECT_EQ(test::error_of(read_abaqus, kNodes).code, Code::kEmptyMesh);
  EXPECT_EQ(test::error_of(read_abaqus, kNodes + face, {3, 9}).code, Code::kMeshTooLarge);
  EXPECT_EQ(test::error_of(read_abaqus, kNodes + face, {9, 0}).code, Code::kMeshTooLarge);
}

TEST(nastran_reader, fields_of_both_widths_and_divided_by_commas_are_the_same_mesh) {
  const std::vector<std::string> files{
      "SOL 101\nCEND\nBEGIN BULK\n$ points\n"
      "GRID           1              0.      0.      0.\nGRID           2              1.      0.      0.\n"
      "GRID           3              1.     1.0      0.\nGRID          14              0.      1.  1.5-3\n"
      "CTRIA3         5       7       1       2       3\nCQUAD4         6       8       1       2       3      14\n"
      "ENDDATA\nGRID, 1\n",
      "GRID,1,,0.,0.,0.\ngrid,2,0,1.,0.,0.\nGRID,3,,1.,1.0,0.\nGRID,14,,0.,1.,1.5E-3\n"
      "CTRIA3,5,7,1,2,3\nCQUAD4,6,8,1,2,3,14\n",
      "CTRIA6         5       7       1       2       3      14      14      14\n"
      "CQUAD4*                6               8               1               2\n*                      3              "
      "14\n"
      "GRID*                  1                              0.              0.\n*                     0.\n"
      "GRID*                  2                              1.              0.\n*                     0.\n"
      "GRID*                  3                              1.             1.0\n*                     0.\n"
      "GRID*                 14                              0.              1.\n*                 1.5-3\n"};
  for (const std::string& file : files) {
    const ReadResult result = read_as_nastran(file);
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}})) << file;
    EXPECT_EQ(result.mesh.positions[VertexId(2)], (Vec3{1, 1, 0})) << file;
    EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 1.5e-3})) << file;
    EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"7", "8"})) << file;
  }
}

TEST(nastran_reader, what_is_wrong_is_refused_with_its_line_and_other_elements_are_counted) {
  const std::string points = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n";
  const ReadResult result = read_as_nastran(points + "CTETRA,1,1,1,2,3,4\nCTRIA3,2,1,1,2,3\nCORD2R,9,0\n");
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
  expect_error_at_line(read_nastran, points + "CTRIA3,2,1,1,2,5\n", Code::kIndexOutOfRange, 5);
  expect_error_at_line(read_nastran, points + "CTRIA3,2,1,1,2\n", Code::kInvalidMesh, 5);
  expect_error_at_line(read_nastran, points + "INCLUDE 'a.bdf'\n", Code::kInvalidMesh, 5);
  expect_error_at_line(read_nastran, "GRID,1,3,0.,0.,0.\n" + points, Code::kInvalidMesh, 1);
  expect_error_at_line(read_nastran, "GRID,1,,0.x,0.,0.\n", Code::kInvalidMesh, 1);
  EXPECT_EQ(test::error_of(read_nastran, points + points + "CTRIA3,2,1,1,2,3\n").code, Code::kInvalidMesh);
  EXPECT_EQ(test::error_of(read_nastran, points).code, Code::kEmptyMesh);
  EXPECT_EQ(test::error_of(read_nastran, points, {3, 9}).code, Code::kMeshTooLarge);
}

}  // namespace
}  // namespace remesh
