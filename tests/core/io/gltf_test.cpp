#include "core/io/gltf/gltf.h"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/mesh_files.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using nlohmann::json;
using test::Face;
using test::faces_of;
using test::label_of_faces;

ReadResult read_as_gltf(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_gltf, content, limits);
}

template <class T>
std::string packed(const std::vector<T>& numbers) {
  std::string bytes;
  for (const T number : numbers) append_little_endian(bytes, number);
  return bytes;
}

std::string binary_gltf(std::string document, std::string data) {
  document.resize((document.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, '\0');
  using Sizes = std::vector<std::uint32_t>;
  return "glTF" +
         packed(Sizes{2, static_cast<std::uint32_t>(28 + document.size() + data.size()),
                      static_cast<std::uint32_t>(document.size())}) +
         "JSON" + document + packed(Sizes{static_cast<std::uint32_t>(data.size())}) + std::string("BIN\0", 4) + data;
}

/// A square of four points, with indices of 8, 16 and 32 bits for two triangles, a strip and a fan.
const std::string kData = packed(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) +
                          packed(std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3, 9, 9}) +
                          packed(std::vector<std::uint16_t>{0, 1, 3, 2}) +
                          packed(std::vector<std::uint32_t>{0, 1, 2, 3});

json square_document() {
  return json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"name": "plate", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 1}]}],
    "materials": [{"name": "oak"}, {"name": "zinc 2"}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
                  {"bufferView": 1, "byteOffset": 8, "componentType": 5123, "count": 4, "type": "SCALAR"},
                  {"bufferView": 1, "byteOffset": 16, "componentType": 5125, "count": 4, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32}],
    "buffers": [{"byteLength": 80}]})");
}

ReadResult read_square(const json& document) { return read_as_gltf(binary_gltf(document.dump(), kData)); }

TEST(gltf_reader, triangles_come_with_the_names_of_their_mesh_and_material) {
  const ReadResult result = read_square(square_document());
  EXPECT_TRUE(result.diagnostics.empty());
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.object), (std::vector<std::string>{"plate", "plate"}));
  EXPECT_EQ(label_of_faces(result.mesh.labels.material), (std::vector<std::string>{"zinc 2", "zinc 2"}));
  EXPECT_EQ(result.unit, "meter");
  EXPECT_EQ(result.up_axis, "y");
}

TEST(gltf_reader, strips_and_fans_keep_the_orientation_and_other_primitives_are_counted) {
  json document = square_document();
  json& primitives = document["meshes"][0]["primitives"];
  primitives.push_back(json::parse(R"({"attributes": {"POSITION": 0}, "indices": 2, "mode": 5})"));
  primitives.push_back(json::parse(R"({"attributes": {"POSITION": 0, "NORMAL": 0}, "indices": 3, "mode": 6})"));
  primitives.push_back(json::parse(R"({"attributes": {"POSITION": 0}, "mode": 1})"));
  const ReadResult result = read_square(document);
  EXPECT_EQ(faces_of(result.mesh),
            (std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}, {1, 2, 0}, {2, 3, 0}}));
  EXPECT_EQ(result.mesh.vertex_count(), 4u) << "primitives share their vertices";
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 2u);
}

TEST(gltf_reader, transforms_of_nodes_apply_from_the_inside_out_and_a_mirror_turns_faces_over) {
  json document = square_document();
  // A quarter turn about z takes (1, 0, 0) to (0, 1, 0).
  document["nodes"] = json::parse(R"([{"translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1, 2]},
    {"mesh": 0, "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "translation": [0, 0, 1]},
    {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]}])");
  const ReadResult result = read_square(document);
  ASSERT_EQ(result.mesh.vertex_count(), 8u);
  const auto at = [&](std::uint32_t v) { return result.mesh.positions[VertexId(v)]; };
  EXPECT_LT(norm(at(1) - Vec3{10, 2, 2}), 1e-14);
  EXPECT_LT(norm(at(3) - Vec3{8, 0, 2}), 1e-14);
  EXPECT_EQ(at(5), (Vec3{8, 0, 10}));
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}}));
}

TEST(gltf_reader, buffers_may_be_embedded_in_json_which_is_not_taken_for_a_mesh_in_json) {
  json document = square_document();
  document["buffers"][0]["uri"] =
      "data:application/"
      "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAECAAIDCQkA"
      "AAEAAwACAAAAAAABAAAAAgAAAAMAAAA=";
  const std::string text = document.dump();
  EXPECT_EQ(faces_of(read_as_gltf(text).mesh), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(sniff_format(text), Format::kGlb);
  EXPECT_EQ(sniff_format(binary_gltf(text, kData)), Format::kGlb);
  EXPECT_EQ(sniff_format(R"({"vertices": [], "faces": [], "asset": 1})"), Format::kJson);
}

TEST(gltf_reader, what_is_wrong_is_refused) {
  const auto changed = [](const std::string& pointer, const json& value) {
    json document = square_document();
    document[json::json_pointer(pointer)] = value;
    return binary_gltf(document.dump(), kData);
  };
  const std::vector<std::pair<std::string, Code>> wrong{
      {"glTF", Code::kInvalidMesh},
      {binary_gltf("{", kData), Code::kInvalidMesh},
      {binary_gltf(std::string(100'000, '['), kData), Code::kInvalidMesh},
      {binary_gltf("[]", kData), Code::kInvalidMesh},
      {binary_gltf(square_document().dump(), kData).substr(0, 700), Code::kInvalidMesh},
      {changed("/asset/version", "1.0"), Code::kInvalidMesh},
      {changed("/extensionsRequired", {"KHR_draco_mesh_compression"}), Code::kInvalidMesh},
      {changed("/buffers/0/uri", "part.bin"), Code::kInvalidMesh},
      {changed("/buffers/0/uri", "/etc/passwd"), Code::kInvalidMesh},
      {changed("/nodes/0/mesh", 1), Code::kInvalidMesh},
      {changed("/nodes/0/mesh", -1), Code::kInvalidMesh},
      {changed("/nodes/0/mesh", "x"), Code::kInvalidMesh},
      {changed("/nodes/0/children", {0}), Code::kInvalidMesh},
      {changed("/nodes/0/scale", {1, 1}), Code::kInvalidMesh},
      {changed("/scene", 7), Code::kInvalidMesh},
      {changed("/accessors/0/count", 5), Code::kInvalidMesh},
      {changed("/accessors/0/byteOffset", 4), Code::kInvalidMesh},
      {changed("/accessors/0/componentType", 5130), Code::kInvalidMesh},
      {changed("/accessors/0/sparse", {{"count", 1}}), Code::kInvalidMesh},
      {changed("/accessors/1/count", 5), Code::kInvalidMesh},
      {changed("/accessors/1/componentType", 5126), Code::kInvalidMesh},
      {changed("/accessors/1/componentType", 5120), Code::kInvalidMesh},
      {changed("/bufferViews/0/byteStride", 4), Code::kInvalidMesh},
      {changed("/bufferViews/0/byteLength", 18446744073709551615u), Code::kInvalidMesh},
      {changed("/bufferViews/1/byteOffset", 50), Code::kInvalidMesh},
      {changed("/accessors/0/count", 1e15), Code::kMeshTooLarge},
      {changed("/accessors/0/count", 2), Code::kIndexOutOfRange},
      {changed("/meshes/0/primitives/0/mode", 0), Code::kEmptyMesh},
  };
  for (const auto& [file, code] : wrong)
    EXPECT_EQ(code_name(test::error_of(read_gltf, file).code), code_name(code)) << file.substr(0, 1100);
}

TEST(gltf_reader, nodes_that_use_a_mesh_again_stay_within_the_limits) {
  json document = square_document();
  for (int i = 1; i < 100; ++i) {
    document["nodes"].push_back({{"mesh", 0}});
    document["scenes"][0]["nodes"].push_back(i);
  }
  const std::string file = binary_gltf(document.dump(), kData);
  EXPECT_EQ(read_as_gltf(file, {400, 200}).mesh.face_count(), 200u);
  EXPECT_EQ(test::error_of(read_gltf, file, {400, 199}).code, Code::kMeshTooLarge);
  EXPECT_EQ(test::error_of(read_gltf, file, {399, 200}).code, Code::kMeshTooLarge);
}

TEST(gltf_writer, what_is_written_reads_back_bit_for_bit_with_boundaries_as_materials) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{-0.0, 0x1p-149, 0x1p127}, Vec3{1, 0.5, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0x1p-20}})
    mesh.positions.push_back(p);
  for (const int v : {1, 2, 1}) mesh.faces.push_back({VertexId(0), VertexId(v), VertexId(v + 1)});
  mesh.labels.group.names = {"Wand \"größe\" \\1", "b"};
  mesh.labels.group.of_face.items() = {0, 1, 0};
  const IdVector<FaceId, PatchId> patches(3, PatchId(0));
  RunControl control;
  for (const bool is_y_up : {false, true}) {
    const std::string file = write_mesh(Format::kGlb, {mesh, patches, {"a \"comment\""}, {}, {}, is_y_up}, control);
    const ReadResult back = test::read_with(read_gltf, file);
    EXPECT_EQ(back.mesh.positions, mesh.positions);
    EXPECT_TRUE(std::signbit(back.mesh.positions[VertexId(0)].x));
    EXPECT_EQ(faces_of(back.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(label_of_faces(back.mesh.labels.material),
              (std::vector<std::string>{"Wand \"größe\" \\1", "Wand \"größe\" \\1", "b"}));
    EXPECT_EQ(back.up_axis, is_y_up ? "y" : "");
  }
  mesh.positions[VertexId(1)].x = 0.1;
  EXPECT_THROW(write_mesh(Format::kGlb, {mesh, patches, {}}, control), Error);
}

TEST(gltf_writer, colours_show_the_smallest_angle_if_asked) {
  TriangleMesh mesh;
  // A triangle whose angles at its base have the tangent 7/4, so that the third is 59.5 degrees; one with sides of 3, 4
  // and 5, whose least angle has the tangent 3/4; and a needle.
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{1, 1.75, 0}, Vec3{4, 0, 0}, Vec3{0, 3, 0}, Vec3{0, 0, 64}})
    mesh.positions.push_back(p);
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 3, 4}, std::array{0, 1, 5}})
    mesh.faces.push_back({VertexId(a), VertexId(b), VertexId(c)});
  const IdVector<FaceId, PatchId> patches(3, PatchId(0));
  RunControl control;
  const Writing writing{.glb_colours = GlbColours::kQuality};
  const std::string file = write_mesh(Format::kGlb, {mesh, patches, {}, {}, writing}, control);
  const PolygonMesh back = test::read_with(read_gltf, file).mesh;
  EXPECT_EQ(faces_of(back), (std::vector<Face>{{0, 1, 5}, {0, 3, 4}, {0, 1, 2}}));
  EXPECT_EQ(label_of_faces(back.labels.material),
            (std::vector<std::string>{"min_angle_0", "min_angle_35", "min_angle_55"}));
}

}  // namespace
}  // namespace remesh
