#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/io/common/base64.h"
#include "core/io/common/bytes.h"
#include "core/io/mesh_files.h"
#include "core/io/vtu/vtu.h"
#include "core/io/vtu/xml_elements.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::Face;
using test::faces_of;
using test::label_of_faces;

ReadResult read_as_vtu(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_vtu, content, limits);
}

std::string array(const std::string& name, const std::string& values, const std::string& more = "") {
  return "<DataArray type=\"" + std::string(name == "Points" ? "Float64" : "Int64") + "\" Name=\"" + name +
         "\" format=\"ascii\" " + more + ">\n" + values + "\n</DataArray>\n";
}

/// A triangle, a line, a pixel and a quadratic triangle over the corners of a square and the middles of two sides.
std::string grid(const std::string& cell_data = "", const std::string& field_data = "") {
  return "<?xml version=\"1.0\"?>\n<!-- <Piece> --><VTKFile type='UnstructuredGrid' version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n<UnstructuredGrid>" +
         field_data + "<Piece NumberOfPoints=\"6\" NumberOfCells=\"4\">\n<Points>" +
         array("Points", "0 0 0  1 0 0  0 1 0\n1 1 0.1  0.5 0 0  1 0.5 0", "NumberOfComponents=\"3\"") +
         "</Points><Cells>" + array("connectivity", "0 1 2 0 1 0 1 2 3 0 1 3 4 5 4") + array("offsets", "3 5 9 15") +
         array("types", "5 3 8 22") + "</Cells><PointData/>" + cell_data + "</Piece></UnstructuredGrid></VTKFile>";
}

TEST(base64, blanks_may_stand_anywhere_and_a_new_text_begins_behind_padding) {
  const std::string digits = "AAECAwQFBgcICQoLDA0ODw==/+8=";  // the bytes 0 to 15, and 255 239 by itself
  std::string bytes;
  for (char c = 0; c < 16; ++c) bytes += c;
  bytes += "\xff\xef";
  EXPECT_EQ(from_base64(digits, 100), bytes);
  for (std::size_t at = 0; at <= digits.size(); ++at) {
    std::string broken = digits;
    EXPECT_EQ(from_base64(broken.insert(at, "\n  "), 100), bytes) << at;
    EXPECT_EQ(from_base64(digits, at), bytes.substr(0, at)) << at;
    // A character that is no digit ends the text.
    broken[at] = '<';
    EXPECT_EQ(from_base64(broken, 100), from_base64(digits.substr(0, at), 100)) << at;
  }
}

TEST(vtk_reader, cells_that_are_faces_come_in_their_order_with_their_labels_and_names) {
  const ReadResult result = read_as_vtu(grid(
      "<CellData>" + array("group", "7 9 8 7") + array("temperature", "1 2 3 4") + "</CellData>",
      "<FieldData><DataArray type=\"Int32\" Name=\"group_names\" NumberOfComponents=\"2\" "
      "ComponentName7=\"a &lt;lid&gt; &#228;\" ComponentName9=\"x\" format=\"ascii\">7 9</DataArray></FieldData>"));
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 3, 2}, {0, 1, 3}}));
  EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{1, 1, 0.1}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"a <lid> ä", "8", "a <lid> ä"}));
  EXPECT_FALSE(result.mesh.labels.object.is_used());
  std::vector<std::uint64_t> counts;
  for (const Diagnostic& dropped : result.diagnostics) counts.push_back(dropped.count);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{1, 1, 1})) << "a line, a curved face, an array";
}

/// VTK writes a million of floats as 1e+06.
TEST(vtk_reader, whole_numbers_may_be_written_as_reals) {
  const ReadResult result = read_as_vtu(grid("<CellData>" + array("group", "1 9 1e+06 7.0") + "</CellData>"));
  EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"1", "1000000", "7"}));
}

TEST(vtk_reader, what_is_wrong_is_told_with_its_byte) {
  const std::string good = grid();
  EXPECT_EQ(read_as_vtu(good).mesh.face_count(), 3u);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string file = good;
    const std::size_t at = file.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return file.replace(at, from.size(), to);
  };
  const std::vector<std::pair<std::string, Code>> wrong{
      {"<VTKFile type=\"ImageData\"></VTKFile>", Code::kInvalidMesh},
      {"<html></html>", Code::kInvalidMesh},
      {with("1 0 0  0", "1 0 x  0"), Code::kInvalidMesh},
      {with("1 0 0  0", "1 0 inf  0"), Code::kNonfiniteCoordinate},
      {with("0.5 0 0  1 0.5 0", "0.5 0 0"), Code::kInvalidMesh},
      {with("4 5 4", "4 5 4 5"), Code::kInvalidMesh},
      {with("3 5 9 15", "3 5 9 16"), Code::kInvalidMesh},
      {with("3 5 9 15", "5 3 9 15"), Code::kInvalidMesh},
      {with("0 1 2 0 1", "0 1 6 0 1"), Code::kIndexOutOfRange},
      {with("0 1 2 0 1", "0 1 -1 0 1"), Code::kIndexOutOfRange},
      {with("\"4\"", "\"99999999999\""), Code::kMeshTooLarge},
      {with("\"6\"", "\"99999999999\""), Code::kMeshTooLarge},
      {with("\"6\"", "\"6x\""), Code::kInvalidMesh},
      {with("3 5 9 15", "3 5 9 999999999999"), Code::kMeshTooLarge},
      {with("byte_order", "compressor=\"vtkLZ4DataCompressor\" byte_order"), Code::kInvalidMesh},
      {with("</Points>", "</Points"), Code::kInvalidMesh},
      {good.substr(0, 60), Code::kInvalidMesh},
  };
  for (const auto& [file, code] : wrong) {
    const Error error = test::error_of(read_vtu, file);
    EXPECT_EQ(code_name(error.code), code_name(code)) << file << error.what();
    EXPECT_TRUE(error.byte) << error.what();
  }
}

TEST(vtk_reader, a_packed_array_takes_no_more_memory_than_its_piece_tells) {
  // A list of blocks that tells of 2^32 - 1 blocks, one whose block would have 4 GiB, and one that is as long as its
  // piece tells and has a single byte, in little-endian base64.
  for (const char* blocks : {"/////wCAAAAAAAAA", "AQAAAP////8AAAAA", "AQAAAJAAAAAAAAAAAQAAAHg="}) {
    std::string file = grid();
    file.replace(file.find("byte_order"), 0, "compressor=\"vtkZLibDataCompressor\" ");
    const std::size_t begin = file.find("format=\"ascii\"");
    file.replace(begin, 14, "format=\"binary\"");
    const std::size_t text = file.find('>', begin) + 1;
    file.replace(text, file.find('<', text) - text, blocks);
    EXPECT_EQ(test::error_of(read_vtu, file).code, Code::kInvalidMesh) << blocks;
  }
}

TEST(vtk_reader, pieces_are_put_together_and_poly_data_count_their_cells_by_kind) {
  const auto piece = [&](const std::string& x, const std::string& label) {
    return "<Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfPolys=\"1\" NumberOfStrips=\"1\"><Points>" +
           array("Points", x + " 0 0 " + x + " 1 0 " + x + " 0 1 " + x + " 1 1", "NumberOfComponents=\"3\"") +
           "</Points><Strips>" + array("connectivity", "0 1 2 3") + array("offsets", "4") + "</Strips><Verts>" +
           array("connectivity", "3") + array("offsets", "1") + "</Verts><Polys>" + array("connectivity", "3 2 1") +
           array("offsets", "3") + "</Polys><CellData>" + array("material", "0 1 " + label) + "</CellData></Piece>";
  };
  const ReadResult result = read_as_vtu("<VTKFile type=\"PolyData\"><PolyData>" + piece("0", "2") + piece("1", "3") +
                                        "</PolyData></VTKFile>");
  EXPECT_EQ(faces_of(result.mesh),
            (std::vector<Face>{{3, 2, 1}, {0, 1, 2}, {1, 3, 2}, {7, 6, 5}, {4, 5, 6}, {5, 7, 6}}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.material), (std::vector<std::string>{"1", "2", "2", "1", "3", "3"}));
}

const std::string kLegacyHead = "# vtk DataFile Version 3.0\na title\nASCII\nDATASET POLYDATA\n";

TEST(vtk_reader, legacy_files_are_read_as_text_with_their_cell_data) {
  const std::string points = "POINTS 4 float\n0 0 0 1 0 0\n1 1 0 0 1 0.5\n";
  const std::string data =
      "CELL_DATA 3\nNORMALS n float\n0 0 1 0 0 1 0 0 1\nSCALARS group int\nLOOKUP_TABLE default\n5 6 7\n"
      "FIELD more 1\nmaterial 1 3 int\n1 1 2\nMETADATA\nINFORMATION 0\n\nPOINT_DATA 4\nSCALARS t double 1\n"
      "LOOKUP_TABLE default\n1 2 3 4\n";
  for (const std::string& polygons :
       {std::string("LINES 1 3\n2 0 1\nPOLYGONS 2 9\n3 0 1 2\n4 0 1 2 3\n"),
        std::string("LINES 2 2\nOFFSETS vtktypeint64\n0 2\nCONNECTIVITY vtktypeint64\n0 1\nPOLYGONS 3 7\nOFFSETS "
                    "vtktypeint64\n0 3 7\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 2 3\n")}) {
    const ReadResult result = read_as_vtu(kLegacyHead + points + polygons + data);
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}}));
    EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 0.5}));
    EXPECT_EQ(label_of_faces(result.mesh.labels.group), (std::vector<std::string>{"6", "7"}));
    EXPECT_EQ(label_of_faces(result.mesh.labels.material), (std::vector<std::string>{"1", "2"}));
    EXPECT_EQ(sniff_format(kLegacyHead + points), Format::kVtu);
  }
}

TEST(vtk_reader, what_is_wrong_in_a_legacy_file_is_told_with_its_byte) {
  const std::string points = kLegacyHead + "POINTS 3 float\n0 0 0 1 0 0 1 1 0\n";
  const std::vector<std::pair<std::string, Code>> wrong{
      {"# vtk DataFile", Code::kInvalidMesh},
      {"# vtk DataFile Version 3.0\na\nTEXT\n", Code::kInvalidMesh},
      {"# vtk DataFile Version 3.0\na\nASCII\nDATASET STRUCTURED_GRID\n", Code::kInvalidMesh},
      {kLegacyHead, Code::kInvalidMesh},
      {points + "POLYGONS 1 4\n3 0 1\n", Code::kInvalidMesh},
      {points + "POLYGONS 1 4\n4 0 1 2\n", Code::kInvalidMesh},
      {points + "POLYGONS 2 4\n3 0 1 2\n", Code::kInvalidMesh},
      {points + "POLYGONS 1 4\n3 0 1 3\n", Code::kIndexOutOfRange},
      {points + "POLYGONS 1 4\n3 0 1 2\nCELL_DATA 2\nSCALARS group int\nLOOKUP_TABLE default\n1 2\n",
       Code::kInvalidMesh},
      {points + "THINGS 1\n", Code::kInvalidMesh},
      {kLegacyHead + "POINTS 99999999 float\n", Code::kMeshTooLarge},
      {kLegacyHead + "POINTS 3 float\n0 0 0 1 0 0 1 nan 0\n", Code::kNonfiniteCoordinate},
  };
  for (const auto& [file, code] : wrong) {
    const Error error = test::error_of(read_vtu, file);
    EXPECT_EQ(code_name(error.code), code_name(code)) << file << error.what();
    EXPECT_TRUE(error.byte) << error.what();
  }
}

TEST(vtk_reader, what_is_written_reads_back_bit_for_bit_with_all_labels_and_their_names) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{-0.0, 5e-324, 1e308}, Vec3{1, 0.1, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 1.0 / 3}})
    mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  mesh.faces.push_back({VertexId(0), VertexId(2), VertexId(3)});
  for (LabelSet* set : {&mesh.labels.object, &mesh.labels.group, &mesh.labels.material}) {
    set->names = {"Wand größe 1", "a<b>\"&'", ""};
    set->of_face.items() = {1, 0};
  }
  mesh.labels.material.of_face.items() = {2, 1};
  const IdVector<FaceId, PatchId> patches(2, PatchId(0));
  RunControl control;
  const std::string file = write_mesh(Format::kVtu, {mesh, patches, {"a comment"}}, control);
  const PolygonMesh back = read_mesh(Format::kVtu, file, {}, control).mesh;
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_EQ(faces_of(back), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(label_of_faces(back.labels.object), label_of_faces(mesh.labels.object));
  EXPECT_EQ(label_of_faces(back.labels.group), label_of_faces(mesh.labels.group));
  EXPECT_EQ(label_of_faces(back.labels.material), label_of_faces(mesh.labels.material));
}

TEST(xml_elements, tags_attributes_and_text_are_found_among_comments_and_quotes) {
  XmlTags tags("<?xml?><!-- <a> --><!DOCTYPE b>\n<n:a x = 'y>' z=\"'\">text<b/></n:a >rest");
  EXPECT_TRUE(tags.next().opens("a"));
  EXPECT_EQ(tags.tag().attribute("x"), "y>");
  EXPECT_EQ(tags.tag().attribute("z"), "'");
  EXPECT_EQ(tags.tag().attribute("y"), std::nullopt);
  EXPECT_EQ(tags.next().kind, XmlTag::Kind::kEmpty);
  EXPECT_EQ(tags.text_before(), "text");
  EXPECT_TRUE(tags.next().closes("a"));
  EXPECT_EQ(tags.next().kind, XmlTag::Kind::kEnd);
  EXPECT_EQ(tags.text_before(), "rest");
  EXPECT_EQ(xml_text("a&lt;&gt;&amp;&quot;&apos;&#65;&#xe4;&x;&#;"), "a<>&\"'Aä&x;");
  for (const char* unended : {"<a", "<!-- ->", "<a x=\">", "<?x"}) {
    EXPECT_THROW(
        {
          XmlTags broken(unended);
          broken.next();
        },
        Error)
        << unended;
  }
}

}  // namespace
}  // namespace remesh
