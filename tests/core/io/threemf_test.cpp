#include "core/io/threemf/threemf.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/mesh_files.h"
#include "core/io/threemf/zip.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::Face;
using test::faces_of;
using test::label_of_faces;

enum class Packing : std::uint16_t { kStored = 0, kDeflated = 8 };

std::string deflated(const std::string& content) {
  std::string out(content.size() + 1000, '\0');
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

/// A ZIP archive of some files.
std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files,
                   Packing packing = Packing::kDeflated) {
  std::string archive, directory;
  for (const auto& [name, content] : files) {
    const std::string packed = packing == Packing::kDeflated ? deflated(content) : content;
    std::string common;
    append_little_endian(common, std::uint16_t{20});
    append_little_endian(common, std::uint16_t{0});
    append_little_endian(common, static_cast<std::uint16_t>(packing));
    append_little_endian(common, std::uint32_t{0});
    append_little_endian(common, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(content.data()),
                                                                  static_cast<uInt>(content.size()))));
    append_little_endian(common, static_cast<std::uint32_t>(packed.size()));
    append_little_endian(common, static_cast<std::uint32_t>(content.size()));
    append_little_endian(common, static_cast<std::uint16_t>(name.size()));
    append_little_endian(common, std::uint16_t{0});
    directory += std::string("PK\1\2\24\0", 6) + common + std::string(10, '\0');
    append_little_endian(directory, static_cast<std::uint32_t>(archive.size()));
    directory += name;
    archive += "PK\3\4" + common + name + packed;
  }
  std::string end = "PK\5\6" + std::string(4, '\0');
  for (int i = 0; i < 2; ++i) append_little_endian(end, static_cast<std::uint16_t>(files.size()));
  append_little_endian(end, static_cast<std::uint32_t>(directory.size()));
  append_little_endian(end, static_cast<std::uint32_t>(archive.size()));
  return archive + directory + end + std::string(2, '\0');
}

const std::string kName = "3D/3dmodel.model";

std::string model(const std::string& resources, const std::string& build,
                  const std::string& attributes = "unit=\"inch\"") {
  return "<?xml version=\"1.0\"?>\n<model " + attributes + " xmlns:m=\"x\"><resources>" + resources +
         "</resources><build>" + build + "</build></model>";
}

const std::string kVerticesOfModel =
    "<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1.1\" "
    "z=\"0\"/></vertices>";

/// An object that is one triangle.
std::string triangle(const std::string& id, const std::string& attributes = "", const std::string& of_triangle = "") {
  return "<object id=\"" + id + "\" " + attributes + "><mesh>" + kVerticesOfModel +
         "<triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\" " + of_triangle + "/></triangles></mesh></object>";
}

ReadResult read_as_3mf(const std::string& model_text, const ReadLimits& limits = {}) {
  return test::read_with(read_threemf, zip_of({{kName, model_text}}), limits);
}

TEST(threemf_reader, transforms_of_components_come_before_those_of_items_as_the_specification_says) {
  // It is scaled by 2 in a component, and moved by 10 in the item. Other programs (assimp, OpenSCAD, PrusaSlicer) each
  // do it in another way.
  const ReadResult result = read_as_3mf(
      model(triangle("1", "name=\"a &amp; b\"") + "<object id=\"2\" name=\"set\"><components><component objectid=\"1\" "
                                                  "transform=\"2 0 0 0 2 0 0 0 2 1 0 0\"/><component objectid=\"1\"/>"
                                                  "</components></object>",
            "<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/><item objectid=\"1\"/>"));
  ASSERT_EQ(result.mesh.vertex_count(), 9u);
  const auto at = [&](std::uint32_t v) { return result.mesh.positions[VertexId(v)]; };
  EXPECT_EQ(at(0), (Vec3{11, 0, 0}));
  EXPECT_EQ(at(1), (Vec3{13, 0, 0}));
  EXPECT_EQ(at(2), (Vec3{11, 2.2, 0}));
  EXPECT_EQ(at(4), (Vec3{11, 0, 0}));
  EXPECT_EQ(at(8), (Vec3{0, 1.1, 0}));
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.object), (std::vector<std::string>{"set", "set", "a & b"}));
  EXPECT_EQ(result.unit, "inch");
  EXPECT_EQ(result.up_axis, "z");
}

TEST(threemf_reader, rows_of_a_transform_multiply_points_from_the_left_and_mirrors_turn_faces_over) {
  // x goes to y, y to x, z is moved by 3: a quarter turn and a mirror.
  const ReadResult result =
      read_as_3mf(model(triangle("1"), "<item objectid=\"1\" transform=\"0 1 0 1 0 0 0 0 1 0 0 3\"/>", ""));
  EXPECT_EQ(result.mesh.positions[VertexId(1)], (Vec3{0, 1, 3}));
  EXPECT_EQ(result.mesh.positions[VertexId(2)], (Vec3{1.1, 0, 3}));
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 2, 1}}));
  EXPECT_EQ(result.unit, "millimeter");
}

TEST(threemf_reader, base_materials_are_materials_and_other_properties_are_counted) {
  const std::string materials =
      "<basematerials id=\"7\"><base name=\"oak\" displaycolor=\"#fff\"/><base name=\"zinc\"/></basematerials>"
      "<m:colorgroup id=\"8\"><m:color color=\"#fff\"/></m:colorgroup>";
  const std::string items = "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"3\"/><item objectid=\"4\"/>";
  const ReadResult result = read_as_3mf(model(materials + triangle("1", "pid=\"7\" pindex=\"1\"") +
                                                  triangle("2", "pid=\"7\" pindex=\"1\"", "p1=\"0\"") +
                                                  triangle("3", "", "pid=\"8\" p1=\"0\"") + triangle("4"),
                                              items, "requiredextensions=\"m\""));
  EXPECT_EQ(label_of_faces(result.mesh.labels.material), (std::vector<std::string>{"zinc", "oak", "", ""}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.object),
            (std::vector<std::string>{"object_1", "object_2", "object_3", "object_4"}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
}

TEST(threemf_reader, the_relationships_tell_which_file_is_the_model_and_files_may_be_stored) {
  const std::string text = model(triangle("1"), "<item objectid=\"1\"/>");
  const std::string relationships =
      "<Relationships><Relationship Target=\"/a/b.png\" Type=\"x/thumbnail\"/><Relationship "
      "Target=\"/Other/Part.model\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  for (const Packing packing : {Packing::kStored, Packing::kDeflated}) {
    const std::string file =
        zip_of({{"[Content_Types].xml", ""}, {"_rels/.rels", relationships}, {"other/part.model", text}}, packing);
    EXPECT_EQ(test::read_with(read_threemf, file).mesh.face_count(), 1u);
    EXPECT_EQ(sniff_format(file), Format::kThreemf);
  }
}

TEST(threemf_reader, what_is_wrong_is_refused) {
  const std::string item = "<item objectid=\"1\"/>";
  const std::string components = "<object id=\"2\"><components><component objectid=\"";
  const std::vector<std::pair<std::string, Code>> wrong{
      {"<html/>", Code::kInvalidMesh},
      {model("", item), Code::kInvalidMesh},
      {model(triangle("1"), ""), Code::kEmptyMesh},
      {model(triangle("1"), "<item objectid=\"9\"/>"), Code::kInvalidMesh},
      {model(triangle("1") + triangle("1"), item), Code::kInvalidMesh},
      {model(triangle("1"), item, "requiredextensions=\"p\""), Code::kInvalidMesh},
      {model(triangle("1"), "<item objectid=\"1\" transform=\"1 0 0\"/>"), Code::kInvalidMesh},
      {model(triangle("1") + components + "2\"/></components></object>", item), Code::kInvalidMesh},
      {model(components + "1\"/></components></object>" + triangle("1"), item), Code::kInvalidMesh},
      {model("<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\"/>", item), Code::kInvalidMesh},
      {model("<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"inf\"/>", item), Code::kNonfiniteCoordinate},
      {model("<object id=\"1\"><mesh>" + kVerticesOfModel + "<triangles><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>", item),
       Code::kIndexOutOfRange},
      {model("<object id=\"1\"><mesh>" + kVerticesOfModel + "<triangles><triangle v1=\"0\" v2=\"1\"/>", item),
       Code::kInvalidMesh},
  };
  for (const auto& [text, code] : wrong)
    EXPECT_EQ(code_name(test::error_of(read_threemf, zip_of({{kName, text}})).code), code_name(code)) << text;
  EXPECT_EQ(test::error_of(read_threemf, zip_of({{"a", "b"}})).code, Code::kInvalidMesh);
}

TEST(threemf_reader, a_damaged_archive_is_an_error_wherever_it_is_damaged) {
  const std::string file = zip_of({{kName, model(triangle("1"), "<item objectid=\"1\"/>")}});
  for (std::size_t size = 0; size < file.size(); ++size)
    EXPECT_NE(test::error_of(read_threemf, file.substr(0, size)).code, Code::kInternal) << size;
  // Every changed byte is told, or is one that no reader needs, such as a date.
  const std::vector<Vec3> points = test::read_with(read_threemf, file).mesh.positions.items();
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string changed = file;
    changed[at] = static_cast<char>(changed[at] ^ 0x55);
    try {
      EXPECT_EQ(test::read_with(read_threemf, changed).mesh.positions.items(), points) << at;
    } catch (const Error& error) {
      EXPECT_NE(error.code, Code::kInternal) << at;
    }
  }
}

TEST(threemf_reader, components_and_packed_data_that_grow_without_end_stay_within_the_limits) {
  // Each of forty objects uses the one before it twice.
  std::string chain = triangle("1");
  for (int id = 2; id <= 40; ++id) {
    const std::string use = "<component objectid=\"" + std::to_string(id - 1) + "\"/>";
    chain += "<object id=\"" + std::to_string(id) + "\"><components>" + use + use + "</components></object>";
  }
  const ReadLimits limits{1000, 1000, {}};
  const auto code = [&](const std::string& text, const ReadLimits& with) {
    return test::error_of(read_threemf, zip_of({{kName, text}}), with).code;
  };
  EXPECT_EQ(code(model(chain, "<item objectid=\"40\"/>"), limits), Code::kMeshTooLarge);
  const std::size_t begin = chain.find("<triangles>"), end = chain.find("</triangles>");
  EXPECT_EQ(code(model(chain.erase(begin, end - begin), "<item objectid=\"40\"/>"), {1'000'000'000, 1000, {}}),
            Code::kMeshTooLarge);
  EXPECT_EQ(
      read_as_3mf(model(triangle("1"), "<item objectid=\"1\"/><item objectid=\"1\"/>"), {6, 2, {}}).mesh.face_count(),
      2u);
  EXPECT_EQ(code(model(triangle("1"), "<item objectid=\"1\"/><item objectid=\"1\"/>"), {5, 2, {}}),
            Code::kMeshTooLarge);

  const std::string blanks = model(triangle("1"), "<item objectid=\"1\"/>") + std::string(4'000'000, ' ');
  EXPECT_EQ(code(blanks, {1000, 1000, {}}), Code::kDecompressedTooLarge) << "by ratio";
  EXPECT_EQ(code(blanks, {1000, 1000, {3'000'000, 100'000}}), Code::kDecompressedTooLarge) << "by size";
  EXPECT_EQ(read_as_3mf(blanks, {1000, 1000, {5'000'000, 100'000}}).mesh.face_count(), 1u);
}

}  // namespace
}  // namespace remesh
