#include "core/io/stl/stl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/common/number_parsing.h"
#include "tests/support/errors.h"
#include "tests/support/reading.h"

namespace remesh {
namespace {

using test::expect_error_at_byte;
using test::expect_error_at_line;
using test::Face;
using test::faces_of;
using test::label_of_faces;

using Facet = std::array<std::array<float, 3>, 3>;

/// Two triangles over four vertices.
const std::vector<Facet> kSquare{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}}, {{{0, 0, 0}, {1, 1, 0}, {0, 1, 0.1f}}}};

std::string binary_stl(const std::vector<Facet>& facets, std::string header = "made by hand",
                       std::uint16_t attributes = 0) {
  header.resize(80, '\0');
  append_little_endian(header, static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    for (int axis = 0; axis < 3; ++axis) append_little_endian(header, 0.0f);
    for (const auto& vertex : facet) {
      for (const float coordinate : vertex) append_little_endian(header, coordinate);
    }
    append_little_endian(header, attributes);
  }
  return header;
}

std::string text_facet(const std::string& vertices) {
  return "facet normal 0 0 1\nouter loop\n" + vertices + "endloop\nendfacet\n";
}
const std::string kFacet = text_facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n");
const std::string kOther = text_facet("vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n");

ReadResult read_as_stl(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_stl, content, limits);
}

TEST(stl_reader, binary_triangles_come_as_listed_their_equal_vertices_joined) {
  const ReadResult result = read_as_stl(binary_stl(kSquare));
  EXPECT_TRUE(result.diagnostics.empty());
  EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 2, 3}}));
  ASSERT_EQ(result.mesh.vertex_count(), 4u);
  EXPECT_EQ(result.mesh.positions[VertexId(3)].z, double{0.1f}) << "the float, not the nearest decimal";
  EXPECT_FALSE(result.mesh.labels.object.is_used());
}

TEST(stl_reader, zeros_of_both_signs_are_one_place_and_the_first_one_stays) {
  const PolygonMesh mesh =
      read_as_stl(binary_stl({{{{-0.0f, 0, 0}, {1, 0, 0}, {1, 1, 0}}}, {{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}})).mesh;
  EXPECT_EQ(mesh.vertex_count(), 4u);
  EXPECT_TRUE(std::signbit(mesh.positions[VertexId(0)].x));
}

TEST(stl_reader, corners_chosen_to_collide_are_joined_all_the_same_and_soon) {
  // Heights whose hashes have the lower half 0, as in the test of welding.
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  std::uint64_t inverse = kFactor;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFactor * inverse;
  std::vector<std::string> heights;
  for (std::uint64_t i = 1; heights.size() < 60'000; ++i) {
    const auto z = std::bit_cast<double>((i << 32 | i) * inverse);
    if (!(std::fabs(z) < 1e100 && std::fabs(z) > 1e-100)) continue;
    std::array<char, 32> text;
    heights.emplace_back(text.data(), std::to_chars(text.data(), text.data() + text.size(), z).ptr);
  }
  std::string content = "solid\n";
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 0; i < heights.size(); i += 3)
      content += text_facet("vertex 0 0 " + heights[i] + "\nvertex 0 0 " + heights[i + 1] + "\nvertex -0 0 " +
                            heights[i + 2] + "\n");
  const ReadResult result = read_as_stl(content + "endsolid\n");
  ASSERT_EQ(result.mesh.vertex_count(), heights.size());
  for (std::uint32_t c = 0; c < result.mesh.corners.size(); ++c)
    ASSERT_EQ(result.mesh.corners[c].value, c % heights.size());
}

TEST(stl_reader, a_binary_file_may_begin_with_solid) {
  for (const char* header : {"solid", "solid facet", "  solid part\n facet normal"}) {
    EXPECT_EQ(faces_of(read_as_stl(binary_stl(kSquare, header)).mesh).size(), 2u) << header;
    EXPECT_EQ(faces_of(read_as_stl(binary_stl(kSquare, header) + "\n").mesh).size(), 2u) << header;
  }
}

TEST(stl_reader, trailing_bytes_are_told_and_a_whole_record_more_is_an_error) {
  const std::string file = binary_stl(kSquare);
  for (const std::size_t extra : {1u, 49u}) {
    const ReadResult result = read_as_stl(file + std::string(extra, 'x'));
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTrailingBytes);
    EXPECT_EQ(result.diagnostics[0].count, extra);
  }
  expect_error_at_byte(read_stl, file + std::string(50, 'x'), Code::kInvalidMesh, 184);
  EXPECT_EQ(read_as_stl(file + std::string(500, '\0')).diagnostics.at(0).count, 500u) << "padding";
}

TEST(stl_reader, binary_data_that_ends_early_is_an_error_at_its_end) {
  const std::string file = binary_stl(kSquare);
  for (const std::size_t size : {81u, 84u, 100u, 134u, 183u}) {
    expect_error_at_byte(read_stl, file.substr(0, size), Code::kInvalidMesh, size);
  }
  std::string count_too_large = file;
  count_too_large.replace(80, 4, "\xff\xff\xff\xff");
  expect_error_at_byte(read_stl, count_too_large, Code::kInvalidMesh, file.size());
}

TEST(stl_reader, a_coordinate_that_is_not_finite_is_an_error_at_its_vertex) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    std::vector<Facet> facets = kSquare;
    facets[1][2][1] = bad;
    expect_error_at_byte(read_stl, binary_stl(facets), Code::kNonfiniteCoordinate, 84 + 50 + 36);
    EXPECT_EQ(test::error_of(read_stl, binary_stl(facets)).element, 1u);
  }
}

TEST(stl_reader, attribute_bytes_are_dropped_and_counted) {
  const ReadResult result = read_as_stl(binary_stl(kSquare, "", 0x7c1f));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_EQ(result.diagnostics[0].count, 2u);
}

TEST(stl_reader, text_is_read_in_doubles_whatever_its_case_blanks_and_line_ends) {
  const std::string text =
      "\xef\xbb\xbfSolid a part\n\n  FACET normal 0 0 1\n\tOuter   Loop\nvertex 0.1 0 0\nVertex 1e0 .5 -0\n"
      "vertex +1 1. 0\n endloop foo\nendfacet bar baz\nendsolid whatever\n\n";
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const ReadResult result = read_as_stl(test::with_line_end(end, text));
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(result.mesh.positions[VertexId(0)], (Vec3{0.1, 0, 0}));
    EXPECT_EQ(result.mesh.positions[VertexId(1)], (Vec3{1, 0.5, 0}));
    EXPECT_EQ(label_of_faces(result.mesh.labels.object), (std::vector<std::string>{"a part"}));
  }
}

TEST(stl_reader, padding_behind_a_text_is_told_and_left_out) {
  for (const std::string& padding : {std::string("\x1a"), std::string(900, '\0')}) {
    const std::string text = "solid a\n" + kFacet + "endsolid a\n" + padding;
    EXPECT_FALSE(is_binary_stl(text));
    const ReadResult result = read_as_stl(text);
    EXPECT_EQ(result.mesh.face_count(), 1u);
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTrailingBytes);
    EXPECT_EQ(result.diagnostics[0].count, padding.size());
  }
}

TEST(stl_reader, a_facet_may_stand_on_one_line_and_its_normal_may_be_anything) {
  const std::string one_line =
      "facet normal nan - inf outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
  EXPECT_EQ(read_as_stl("solid\n" + one_line + " endsolid\n").mesh.face_count(), 1u);
  EXPECT_EQ(read_as_stl("solid\n" + one_line + " " + one_line + "\nendsolid").mesh.face_count(), 2u);
  EXPECT_EQ(
      read_as_stl("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid")
          .mesh.face_count(),
      1u);
}

TEST(stl_reader, each_solid_is_an_object_even_where_two_have_one_name) {
  const PolygonMesh named =
      read_as_stl("solid a\n" + kFacet + "endsolid\nsolid b\n" + kOther + kOther + "endsolid b\n").mesh;
  EXPECT_EQ(label_of_faces(named.labels.object), (std::vector<std::string>{"a", "b", "b"}));
  const PolygonMesh alike =
      read_as_stl("solid\n" + kFacet + "endsolid\nsolid\nendsolid\nsolid\n" + kOther + "endsolid\n").mesh;
  EXPECT_EQ(alike.labels.object.of_face.items(), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_FALSE(read_as_stl("solid\n" + kFacet + "endsolid\n").mesh.labels.object.is_used());
}

/// Returns the text with each letter in the other case.
std::string in_other_case(std::string text) {
  for (char& c : text) c = static_cast<char>(is_letter(c) ? c ^ ('a' ^ 'A') : c);
  return text;
}

TEST(stl_reader, what_ends_a_part_may_be_one_word_or_two_in_any_case) {
  const std::string lines = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  for (const char* loop : {"endloop", "end loop", "End\tLoop", "end loop of it", "ENDLOOP"}) {
    for (const char* facet : {"endfacet", "end facet", "END  Facet", "end facet bar"}) {
      for (const char* solid : {"endsolid", "end solid", "End Solid part", "end solid end loop", "ENDSOLID facet"}) {
        const std::string text = "solid part\n" + lines + loop + "\n" + facet + "\n" + solid + "\n";
        const PolygonMesh mesh = read_as_stl(text).mesh;
        EXPECT_EQ(faces_of(mesh), (std::vector<Face>{{0, 1, 2}})) << text;
        EXPECT_EQ(read_as_stl(in_other_case(text)).mesh.face_count(), 1u) << text;
      }
    }
  }
  const std::string one_line =
      "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 end loop end facet";
  EXPECT_EQ(read_as_stl("solid\n" + one_line + " " + one_line + " end solid\n").mesh.face_count(), 2u);
}

TEST(stl_reader, a_solid_may_end_with_the_text_or_with_the_next_solid) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    EXPECT_EQ(read_as_stl(test::with_line_end(end, "solid a\n" + kFacet)).mesh.face_count(), 1u);
    const PolygonMesh two =
        read_as_stl(test::with_line_end(end, "solid a\n" + kFacet + "solid b\n" + kOther + kOther)).mesh;
    EXPECT_EQ(label_of_faces(two.labels.object), (std::vector<std::string>{"a", "b", "b"}));
  }
}

TEST(stl_reader, a_name_is_the_rest_of_its_line_whatever_it_holds) {
  for (const std::string& name : {std::string("facet"), std::string("solid"), std::string("endsolid"),
                                  std::string("end solid"), std::string("facet normal 0 0 1"), std::string("# part"),
                                  std::string("two  words"), std::string("Geh\xc3\xa4use"), std::string("Geh\xe4use"),
                                  std::string("a\x01z"), std::string(300, '/'), std::string("vertex 1 2 3")}) {
    const PolygonMesh mesh =
        read_as_stl("solid \t" + name + " \r\n" + kFacet + "endsolid " + name + "\nsolid\n" + kOther).mesh;
    EXPECT_EQ(label_of_faces(mesh.labels.object), (std::vector<std::string>{name, ""}));
  }
}

TEST(stl_reader, comments_and_lines_of_a_head_are_passed_over) {
  const std::string head = "made by hand\nunits mm\n\n";
  const std::string comments = "# facet\n; endsolid\n!\n// vertex 1 2 3 \xe4\x01\n";
  const std::string facet =
      "facet normal 0 0 1 # up\n// here\nouter loop\nvertex 0 0 0 # origin\nvertex 1 0 0\n# now\nvertex 0 1 0 ; "
      "c\nendloop\n"
      "endfacet\n";
  const PolygonMesh mesh = read_as_stl(comments + head + "solid a\n" + head + comments + facet + comments + facet +
                                       "endsolid\n" + comments + "solid b\n" + head + facet + "endsolid\n# the end")
                               .mesh;
  EXPECT_EQ(label_of_faces(mesh.labels.object), (std::vector<std::string>{"a", "a", "b"}));
  // Elsewhere a line that begins with no keyword is a mistake.
  expect_error_at_line(read_stl, "solid\n" + kFacet + "units mm\n" + kFacet, Code::kInvalidMesh, 9);
  expect_error_at_line(read_stl, "hello\nworld\n", Code::kInvalidMesh, 2);
  expect_error_at_line(read_stl, "hello\nw\x01rld\nsolid\n", Code::kInvalidMesh, 2);
}

TEST(stl_reader, what_is_not_a_triangle_is_an_error_at_its_line) {
  const auto solid = [](const std::string& vertices) { return "solid\n" + text_facet(vertices) + "endsolid\n"; };
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0 0\n"), Code::kInvalidMesh, 6);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"), Code::kInvalidMesh,
                       8);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0\n"), Code::kInvalidMesh, 5);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0 0 0\n"), Code::kInvalidMesh, 5);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0 1e\n"), Code::kInvalidMesh, 5);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1 0 nan\n"), Code::kNonfiniteCoordinate, 5);
  expect_error_at_line(read_stl, solid("vertex 0 0 0\nvertex 1\x10 0 0\n"), Code::kInvalidMesh, 5);
}

TEST(stl_reader, text_out_of_order_or_cut_off_is_an_error_at_its_line) {
  expect_error_at_line(read_stl, kFacet, Code::kInvalidMesh, 1);
  expect_error_at_line(read_stl, "solid\nvertex 0 0 0\n", Code::kInvalidMesh, 2);
  expect_error_at_line(read_stl, "solid\nfacet normal 0 0 1\nendfacet\n", Code::kInvalidMesh, 3);
  for (const char* end : {"end\n", "end of it\n", "end facet\n", "endsolid\n", "end solid\n", "solid b\n"})
    expect_error_at_line(read_stl, "solid\nfacet\nouter loop\n" + std::string(end), Code::kInvalidMesh, 4);
  // Cut off inside a facet, after any of its lines.
  for (std::size_t at = kFacet.find('\n'); at + 1 < kFacet.size(); at = kFacet.find('\n', at + 1)) {
    const auto lines =
        static_cast<std::uint64_t>(std::count(kFacet.begin(), kFacet.begin() + static_cast<long>(at) + 1, '\n'));
    expect_error_at_line(read_stl, "solid\n" + kOther + kFacet.substr(0, at + 1), Code::kInvalidMesh, 8 + lines);
  }
  expect_error_at_line(read_stl, "solid\n" + kFacet + "endsolid\nand more\n", Code::kInvalidMesh, 10);
  expect_error_at_line(read_stl, "solid\nfacet normal 0 0 1\nouter loop\nendsolid\n", Code::kInvalidMesh, 4);
  expect_error_at_line(read_stl, std::string_view("\xff\xfes\0o\0", 6), Code::kInvalidMesh, 1);
  EXPECT_EQ(test::error_of(read_stl, "solid\nendsolid\n").code, Code::kEmptyMesh);
  EXPECT_EQ(test::error_of(read_stl, binary_stl({})).code, Code::kEmptyMesh);
}

TEST(stl_reader, limits_count_faces_and_different_vertices) {
  for (const std::string& file : {binary_stl(kSquare), "solid\n" + kFacet + kOther + "endsolid\n"}) {
    EXPECT_EQ(read_as_stl(file, {4, 2}).mesh.face_count(), 2u);
    EXPECT_EQ(test::error_of(read_stl, file, {4, 1}).limit, 1u);
    EXPECT_EQ(test::error_of(read_stl, file, {3, 2}).limit, 3u);
    EXPECT_EQ(test::error_of(read_stl, file, {3, 2}).code, Code::kMeshTooLarge);
  }
}

TriangleMesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleMesh mesh;
  for (const Vec3& p : {a, b, c}) mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  return mesh;
}

std::string written_as_stl(const TriangleMesh& mesh) {
  RunControl control;
  return write_stl(mesh, {"a summary"}, control);
}

TEST(stl_writer, floats_are_written_as_they_are_and_normals_have_length_one) {
  const TriangleMesh mesh = triangle({0.1F, -0.0, 0}, {FLT_MAX, 0, 0}, {0, 3e-30F, 1e-45F});
  const std::string file = written_as_stl(mesh);
  ASSERT_EQ(file.size(), 84u + 50u);
  EXPECT_FALSE(file.starts_with("solid"));
  EXPECT_NE(file.find("a summary"), std::string::npos);
  const auto number = [&](int i) { return load<float>(file.data() + 84 + 4 * i, ByteOrder::kLittle); };
  EXPECT_FLOAT_EQ(number(2), 1);
  const PolygonMesh back = read_as_stl(file).mesh;
  EXPECT_EQ(back.positions, mesh.positions);
  EXPECT_TRUE(std::signbit(back.positions[VertexId(0)].y));
}

TEST(stl_writer, what_is_no_float_is_a_defect_and_is_never_rounded) {
  for (const double x : {0.1, 1e39, 1e-50, 16777217.0, HUGE_VAL}) {
    const Error error = test::error_of([&] { written_as_stl(triangle({x, 0, 0}, {1, 0, 0}, {0, 1, 0})); });
    EXPECT_EQ(error.code, Code::kInternal) << x;
  }
}

}  // namespace
}  // namespace remesh
