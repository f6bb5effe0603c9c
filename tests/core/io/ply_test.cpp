#include "core/io/ply/ply.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/io/common/bytes.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::expect_error_at_byte;
using test::expect_error_at_line;
using test::Face;
using test::faces_of;
using test::label_of_faces;

std::string header(const std::string& format, int vertices, int faces) {
  return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}
constexpr int kHeaderLines = 10;

/// Reads a triangle with more properties.
PolygonMesh read_with_labels(const std::string& properties, const std::string& values) {
  std::string head = header("ascii", 3, 1);
  head.insert(head.find("end_header"), properties);
  return test::read_with(read_ply, head + "0 0 0\n1 0 0\n1 1 0\n3 0 1 2 " + values + "\n").mesh;
}

template <class T>
void append(std::string& out, T value, ByteOrder order) {
  std::string bytes;
  append_little_endian(bytes, value);
  if (order == ByteOrder::kBig) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

/// Returns a quad and a triangle over five vertices.
std::string text_ply() { return header("ascii", 5, 2) + "0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n2 0 0\n4 0 1 2 3\n3 1 4 2\n"; }
std::string binary_ply(ByteOrder order) {
  std::string file = header(order == ByteOrder::kLittle ? "binary_little_endian" : "binary_big_endian", 5, 2);
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.1f, 2.f, 0.f, 0.f})
    append(file, x, order);
  file += '\4';
  for (const int i : {0, 1, 2, 3}) append(file, i, order);
  file += '\3';
  for (const int i : {1, 4, 2}) append(file, i, order);
  return file;
}

ReadResult read_as_ply(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_ply, content, limits);
}

TEST(ply_reader, groups_have_other_names_in_files_of_other_programs) {
  const auto groups = [](const std::string& properties, const std::string& values) {
    return label_of_faces(read_with_labels(properties, values).labels.group);
  };
  EXPECT_EQ(groups("property int layer_id\n", "7"), std::vector<std::string>{"7"});
  EXPECT_EQ(groups("property uchar material_index\nproperty int group_id\n", "5 6"), std::vector<std::string>{"6"});
  EXPECT_EQ(groups("property uchar material_index\nproperty int group\n", "5 6"), std::vector<std::string>{"6"});
  EXPECT_EQ(groups("property float group_id\n", "5"), std::vector<std::string>{}) << "no whole number";
}

TEST(ply_reader, the_caller_names_the_properties_that_may_be_groups) {
  const std::string file =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "property int zone\nproperty int group\nproperty int material\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 4 5 6\n";
  using Names = std::vector<std::string>;
  const auto labels = [&](std::optional<Names> names) {
    ReadLimits limits;
    limits.ply_labels = std::move(names);
    return read_as_ply(file, limits).mesh.labels;
  };
  EXPECT_EQ(label_of_faces(labels(std::nullopt).group), Names{"5"});
  EXPECT_EQ(label_of_faces(labels(Names{"part", "zone", "group"}).group), Names{"4"});
  EXPECT_EQ(label_of_faces(labels(Names{}).group), Names{});
  EXPECT_EQ(label_of_faces(labels(Names{}).material), Names{"6"});
  EXPECT_EQ(label_of_faces(labels(Names{"material"}).group), Names{"6"});
  EXPECT_EQ(label_of_faces(labels(Names{"material"}).material), Names{}) << "it is taken";
}

TEST(ply_reader, text_and_both_byte_orders_give_the_same_polygons) {
  for (const std::string& file : {text_ply(), binary_ply(ByteOrder::kLittle), binary_ply(ByteOrder::kBig)}) {
    const ReadResult result = read_as_ply(file);
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2, 3}, {1, 4, 2}}));
    EXPECT_EQ(result.mesh.positions[VertexId(4)], (Vec3{2, 0, 0}));
  }
  EXPECT_EQ(read_as_ply(text_ply()).mesh.positions[VertexId(3)].z, 0.1) << "numbers of text are doubles";
  EXPECT_EQ(read_as_ply(binary_ply(ByteOrder::kBig)).mesh.positions[VertexId(3)].z, double{0.1f});
}

TEST(ply_reader, padding_behind_a_text_is_told_and_left_out) {
  const ReadResult result = read_as_ply(text_ply() + std::string(3, '\0') + "\x1a");
  EXPECT_EQ(result.mesh.face_count(), 2u);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTrailingBytes);
  EXPECT_EQ(result.diagnostics[0].count, 4u);
  EXPECT_NE(result.diagnostics[0].message.find(std::to_string(text_ply().size())), std::string::npos);
}

TEST(ply_reader, the_header_may_end_its_lines_in_any_way) {
  const std::string file = binary_ply(ByteOrder::kLittle);
  const std::size_t size = file.find("end_header\n") + 11;
  const std::string data = file.substr(size);
  for (const char* end : {"\n", "\r\n", "\r"}) {
    EXPECT_EQ(read_as_ply(test::with_line_end(end, file.substr(0, size)) + data).mesh.face_count(), 2u);
    EXPECT_EQ(read_as_ply(test::with_line_end(end, text_ply())).mesh.face_count(), 2u);
  }
  std::string mixed = file;
  mixed.replace(size - 1, 1, "\r\n");
  EXPECT_EQ(read_as_ply(mixed).mesh.face_count(), 2u) << "one that ends in CRLF among others";
}

TEST(ply_reader, data_that_begins_like_a_line_end_is_data) {
  std::string file = binary_ply(ByteOrder::kLittle);
  const std::size_t size = file.find("end_header\n") + 11;
  file[size] = '\n';  // the first byte of x
  const double x = read_as_ply(file).mesh.positions[VertexId(0)].x;
  EXPECT_NE(x, 0);
  EXPECT_EQ(
      read_as_ply(test::with_line_end("\r", file.substr(0, size)) + file.substr(size)).mesh.positions[VertexId(0)].x,
      x);
}

TEST(ply_reader, every_number_type_is_read) {
  const std::pair<const char*, const char*> types[] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                       {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                       {"float", "float32"}, {"double", "float64"}};
  for (const auto& [old_name, new_name] : types) {
    for (const std::string type : {old_name, new_name}) {
      std::string file = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty " + type + " x\nproperty " +
                         type + " y\nproperty " + type +
                         " z\nelement face 1\nproperty list ushort uint vertex_index\nend_header\n";
      const auto add = [&](int value) {
        if (type.starts_with("float")) return append(file, static_cast<float>(value), ByteOrder::kBig);
        if (type == "double") return append(file, static_cast<double>(value), ByteOrder::kBig);
        if (type.ends_with("char") || type.ends_with("int8"))
          return append(file, static_cast<std::int8_t>(value), ByteOrder::kBig);
        if (type.ends_with("short") || type.ends_with("16"))
          return append(file, static_cast<std::int16_t>(value), ByteOrder::kBig);
        append(file, value, ByteOrder::kBig);
      };
      if (type == "float64") continue;  // the same as double
      for (const int value : {1, 2, 3, 4, 5, 6, 7, 8, 100}) add(value);
      append(file, std::uint16_t{3}, ByteOrder::kBig);
      for (const std::uint32_t i : {2u, 1u, 0u}) append(file, i, ByteOrder::kBig);
      const PolygonMesh mesh = read_as_ply(file).mesh;
      EXPECT_EQ(mesh.positions[VertexId(2)], (Vec3{7, 8, 100})) << type;
      EXPECT_EQ(faces_of(mesh), (std::vector<Face>{{2, 1, 0}})) << type;
    }
  }
}

TEST(ply_reader, unknown_elements_and_properties_are_skipped_and_counted) {
  const std::string declarations =
      "element camera 2\nproperty float fov\nproperty list uchar short path\n"
      "element vertex 3\nproperty uchar red\nproperty double x\nproperty list int float weights\nproperty double y\n"
      "property double z\nelement face 1\nproperty float area\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nelement edge 2\nproperty int a\nproperty int b\nend_header\n";
  const std::string text =
      "ply\nformat ascii 1.0\n" + declarations +
      "1.5 2 7 7\n2.5 0\n255 0 1 nan 0 0\n0 1 0 0 0\n\n0 0 2 1 2 1 0\n.5 3 0 1 2 6 0 0 1 0 1 1\n0 1\n1 2\n";
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + declarations;
  const auto f = [&](float x) { append_little_endian(binary, x); };
  const auto d = [&](double x) { append_little_endian(binary, x); };
  const auto i = [&](std::int32_t x) { append_little_endian(binary, x); };
  f(1.5f), binary += '\2', append_little_endian(binary, std::int16_t{7}), append_little_endian(binary, std::int16_t{7});
  f(2.5f), binary += '\0';
  binary += '\xff', d(0), i(1), f(0), d(0), d(0);
  binary += '\0', d(1), i(0), d(0), d(0);
  binary += '\0', d(0), i(2), f(1), f(2), d(1), d(0);
  f(.5f), binary += '\3', i(0), i(1), i(2), binary += '\2', f(0), f(0);
  i(0), i(1), i(1), i(2);
  for (const std::string& file : {text, binary}) {
    const ReadResult result = read_as_ply(file);
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(result.mesh.positions[VertexId(2)], (Vec3{0, 1, 0}));
    std::vector<std::uint64_t> counts;
    for (const Diagnostic& diagnostic : result.diagnostics) {
      EXPECT_EQ(diagnostic.code, DiagnosticCode::kAttributeDropped);
      counts.push_back(diagnostic.count);
    }
    EXPECT_EQ(counts, (std::vector<std::uint64_t>{2, 3, 3, 1, 1, 2})) << "camera, red, weights, area, texcoord, edge";
  }
}

TEST(ply_reader, whole_numbers_of_faces_by_the_names_of_labels_are_labels) {
  const std::string file =
      "ply\nformat ascii 1.0\ncomment group 7 the lid\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty int group\nproperty uchar "
      "material\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 7 1\n3 0 2 1 -4 1\n";
  const PolygonMesh mesh = read_as_ply(file).mesh;
  EXPECT_EQ(label_of_faces(mesh.labels.group), (std::vector<std::string>{"the lid", "-4"}));
  EXPECT_EQ(label_of_faces(mesh.labels.material), (std::vector<std::string>{"1", "1"}));
  EXPECT_FALSE(mesh.labels.object.is_used());
}

TEST(ply_reader, a_malformed_header_is_an_error_at_its_line) {
  const auto expect = [](const std::string& text, std::uint64_t line) {
    expect_error_at_line(read_ply, "ply\nformat ascii 1.0\n" + text, Code::kInvalidMesh, line);
  };
  expect_error_at_line(read_ply, "plywood\n", Code::kInvalidMesh, 1);
  expect_error_at_line(read_ply, "ply\nformat ebcdic 1.0\n", Code::kInvalidMesh, 2);
  expect_error_at_line(read_ply, "ply\nformat ascii 2.0\n", Code::kInvalidMesh, 2);
  expect_error_at_line(read_ply, "ply\nend_header\n", Code::kInvalidMesh, 2);
  expect("format ascii 1.0\n", 3);
  expect("element vertex\n", 3);
  expect("element vertex -1\n", 3);
  expect("element vertex 1\nelement vertex 1\n", 4);
  expect("property float x\n", 3);
  expect("element vertex 1\nproperty quad x\n", 4);
  expect("element vertex 1\nproperty float\n", 4);
  expect("element vertex 1\nproperty float x\nproperty int x\n", 5);
  expect("element face 1\nproperty list float int vertex_indices\n", 4);
  expect("element vertex 1\nend_header\n", 3);
  expect("nonsense\n", 3);
  expect("element vertex 1\n", 3);
  expect("element tristrips 1\nproperty list int int vertex_indices\nelement vertex 0\nend_header\n1 1\n", 3);
  expect("element face 1\nproperty list uchar int vertex_indices\nend_header\n", 5);
  expect("element vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n", 3);
  expect(
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property int vertex_indices\nend_header\n0 0 0\n0\n",
      7);
  expect_error_at_line(read_ply, std::string_view("\xfe\xff\0p\0l\0y", 8), Code::kInvalidMesh, 1);
}

TEST(ply_reader, records_that_do_not_fit_the_header_are_errors_at_their_line) {
  const auto expect = [](const std::string& records, Code code, std::uint64_t line) {
    expect_error_at_line(read_ply, header("ascii", 3, 1) + records, code, kHeaderLines + line);
  };
  expect("0 0 0\n1 0 0\n", Code::kInvalidMesh, 2);
  expect("0 0 0\n1 0\n", Code::kInvalidMesh, 2);
  expect("0 0 0\n1 0 0 0\n", Code::kInvalidMesh, 2);
  expect("0 0 0\n1 0 x\n", Code::kInvalidMesh, 2);
  expect("0 0 0\n1 0 inf\n", Code::kNonfiniteCoordinate, 2);
  expect("0 0 0\n1 0 0\n0 1 0\n3 0 1\n", Code::kInvalidMesh, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n2 0 1\n", Code::kInvalidMesh, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", Code::kInvalidMesh, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n3 0 1 2.0\n", Code::kInvalidMesh, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", Code::kIndexOutOfRange, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", Code::kIndexOutOfRange, 4);
  expect("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n3 0 1 2\n", Code::kInvalidMesh, 6);
}

TEST(ply_reader, binary_data_that_ends_early_or_goes_on_is_an_error_at_its_byte) {
  const std::string file = binary_ply(ByteOrder::kLittle);
  const std::size_t data = file.find("end_header\n") + 11;
  for (std::size_t size = data; size < file.size(); ++size) {
    expect_error_at_byte(read_ply, file.substr(0, size), Code::kInvalidMesh, size);
  }
  EXPECT_EQ(read_as_ply(file + "\n").diagnostics.at(0).code, DiagnosticCode::kTrailingBytes);
  expect_error_at_byte(read_ply, file + std::string(13, 'x'), Code::kInvalidMesh, file.size());
}

TEST(ply_reader, counts_are_compared_with_the_limits_before_anything_is_reserved) {
  EXPECT_EQ(read_as_ply(text_ply(), {5, 2}).mesh.face_count(), 2u);
  EXPECT_EQ(test::error_of(read_ply, text_ply(), {4, 2}).code, Code::kMeshTooLarge);
  EXPECT_EQ(test::error_of(read_ply, text_ply(), {5, 1}).code, Code::kMeshTooLarge);
  const std::string many =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty uchar x\n"
      "property uchar y\nproperty uchar z\nelement face 0\nend_header\nxyz";
  EXPECT_EQ(test::error_of(read_ply, many, {5'000'000'000, 2}).code, Code::kInvalidMesh);
  const std::string skipped =
      "ply\nformat binary_little_endian 1.0\nelement what 18446744073709551615\nproperty double x\n"
      "element vertex 0\nelement face 0\nend_header\nxyz";
  EXPECT_EQ(test::error_of(read_ply, skipped).code, Code::kInvalidMesh);
}

TEST(ply_reader, points_alone_are_an_empty_mesh) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n0 0 0\n";
  EXPECT_EQ(test::error_of(read_ply, points).code, Code::kEmptyMesh);
}

TEST(ply_writer, what_is_written_reads_back_bit_for_bit_with_its_labels) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{-0.0, 1.0 / 3, 5e-324}, Vec3{1e308, -1, 0.1}, Vec3{0, 1, 2}}) mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(2), VertexId(0), VertexId(1)});
  mesh.faces.push_back({VertexId(0), VertexId(2), VertexId(1)});
  mesh.labels.group.names = {" a  name", ""};
  mesh.labels.group.of_face.items() = {0, 1};
  mesh.labels.material.names = {"end_header"};
  mesh.labels.material.of_face.items() = {0, 0};
  RunControl control;
  const ReadResult back = read_as_ply(write_ply(mesh, {"one\nend_header", "two"}, control));
  EXPECT_TRUE(back.diagnostics.empty());
  ASSERT_EQ(back.mesh.vertex_count(), 3u);
  EXPECT_EQ(std::memcmp(back.mesh.positions.items().data(), mesh.positions.items().data(), 3 * sizeof(Vec3)), 0);
  EXPECT_EQ(faces_of(back.mesh), (std::vector<Face>{{2, 0, 1}, {0, 2, 1}}));
  EXPECT_EQ(back.mesh.labels, mesh.labels);
}

}  // namespace
}  // namespace remesh
