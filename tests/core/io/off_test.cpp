#include "core/io/off/off.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
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

const std::string kBody = "0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n3 0 1 2\n4 0 1 2 3\n";

ReadResult read_as_off(const std::string& content, const ReadLimits& limits = {}) {
  return test::read_with(read_off, content, limits);
}

TEST(off_reader, polygons_come_as_listed_whatever_the_line_ends) {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const ReadResult result = read_as_off(test::with_line_end(end, "OFF\n4 2 0\n" + kBody));
    EXPECT_TRUE(result.diagnostics.empty());
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}}));
    EXPECT_EQ(result.mesh.positions[VertexId(3)], (Vec3{0, 1, 0.1}));
  }
}

TEST(off_reader, comments_blank_lines_and_counts_may_stand_anywhere) {
  const std::vector<Face> faces = faces_of(read_as_off("OFF\n4 2 0\n" + kBody).mesh);
  for (const char* head : {"OFF 4 2 0\n", "OFF 4 2\n", "# made by hand\n\nOFF # 3D\n#\n4 2 6 # counts\n",
                           "\xef\xbb\xbfOFF\n4 2 0\n", "  OFF  \n\t4  2\t0  \n"}) {
    EXPECT_EQ(faces_of(read_as_off(head + kBody).mesh), faces) << head;
  }
  EXPECT_EQ(
      faces_of(read_as_off("OFF\n4 2 0\n0 0 0 # \x01\n\n1 0 0\n# here\n1 1 0\n0 1 0\n3 0 1 2 # red\n4 0 1 2 3").mesh),
      faces);
}

TEST(off_reader, padding_behind_the_text_is_told_and_left_out) {
  for (const std::string& padding : {std::string("\x1a"), std::string(9, '\0')}) {
    const ReadResult result = read_as_off("OFF\n4 2 0\n" + kBody + padding);
    EXPECT_EQ(result.mesh.face_count(), 2u);
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTrailingBytes);
    EXPECT_EQ(result.diagnostics[0].count, padding.size());
  }
}

TEST(off_reader, what_vertices_and_faces_carry_beyond_is_counted) {
  const std::string rest = "4 2 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 255 0 0\n4 0 1 2 3\n";
  for (const char* mark : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCNOFF"}) {
    const ReadResult result = read_as_off(std::string(mark) + "\n" + rest);
    ASSERT_EQ(result.diagnostics.size(), 2u) << mark;
    EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
    EXPECT_EQ(result.diagnostics[0].count, 4u);
    EXPECT_EQ(result.diagnostics[1].count, 1u);
  }
  EXPECT_EQ(read_as_off("nOFF\n3\n" + rest).mesh.face_count(), 2u);
  EXPECT_EQ(read_as_off("nOFF 3\n" + rest).mesh.face_count(), 2u);
}

TEST(off_reader, what_is_wrong_is_told_with_its_line) {
  const auto expect = [](const std::string& text, Code code, std::uint64_t line) {
    expect_error_at_line(read_off, text, code, line);
  };
  expect("OBJ\n", Code::kInvalidMesh, 1);
  expect("4OFF\n4 2 0\n" + kBody, Code::kInvalidMesh, 1);
  expect("nOFF\n4\n4 2 0\n" + kBody, Code::kInvalidMesh, 2);
  expect("OFF\n", Code::kInvalidMesh, 1);
  expect("OFF\nfour 2 0\n", Code::kInvalidMesh, 2);
  expect("OFF\n4\n", Code::kInvalidMesh, 2);
  expect("OFF\n-4 2 0\n", Code::kInvalidMesh, 2);
  expect("OFF\n4 2 0 0\n" + kBody, Code::kInvalidMesh, 2);
  expect("OFF\n4 2 0\n0 0\n", Code::kInvalidMesh, 3);
  expect("OFF\n4 2 0\n0 0 zero\n", Code::kInvalidMesh, 3);
  expect("OFF\n4 2 0\n0 0 nan\n", Code::kNonfiniteCoordinate, 3);
  expect("OFF\n4 2 0\n0 0 0\x02\n", Code::kInvalidMesh, 3);
  expect("OFF\n4 3 0\n" + kBody, Code::kInvalidMesh, 8);
  expect("OFF\n4 1 0\n" + kBody, Code::kInvalidMesh, 8);
  expect("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", Code::kInvalidMesh, 6);
  expect("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", Code::kInvalidMesh, 6);
  expect("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", Code::kIndexOutOfRange, 6);
  expect("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", Code::kIndexOutOfRange, 6);
  expect("OFF\n353535235358 6 0\n", Code::kMeshTooLarge, 2);
  expect_error_at_line(read_off, std::string_view("\xff\xfeO\0F\0F\0", 8), Code::kInvalidMesh, 1);
  EXPECT_EQ(test::error_of(read_off, "OFF\n1 0 0\n0 0 0\n").code, Code::kEmptyMesh);
  EXPECT_EQ(test::error_of(read_off, "OFF\n4000000000 1 0\n0 0 0\n", {5'000'000'000, 1}).code, Code::kInvalidMesh);
}

std::string binary_off(const std::string& mark, int extra_values) {
  std::string file = mark + " BINARY\n";
  const auto append = [&](auto value) {
    std::string bytes;
    append_little_endian(bytes, value);
    file.append(bytes.rbegin(), bytes.rend());
  };
  for (const int count : {3, 1, 0}) append(count);
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.5f}) {
    append(x);
    if (file.size() > 0 &&
        (file.size() - mark.size() - 8 - 12) % static_cast<std::size_t>(12 + 4 * extra_values) == 12) {
      for (int i = 0; i < extra_values; ++i) append(9.f);
    }
  }
  for (const int i : {3, 0, 1, 2, 4}) append(i);
  for (int i = 0; i < 4; ++i) append(1.f);
  return file;
}

TEST(off_reader, binary_files_are_read_and_their_ends_checked) {
  for (const auto& [mark, extra] : {std::pair<std::string, int>("OFF", 0), {"NOFF", 3}, {"STCOFF", 6}}) {
    const std::string file = binary_off(mark, extra);
    const ReadResult result = read_as_off(file);
    EXPECT_EQ(faces_of(result.mesh), (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(result.mesh.positions[VertexId(2)], (Vec3{0, 1, 0.5}));
    EXPECT_EQ(result.diagnostics.size(), extra > 0 ? 2u : 1u);
    for (const std::size_t cut : {std::size_t{1}, std::size_t{20}, file.size() - mark.size() - 9}) {
      expect_error_at_byte(read_off, file.substr(0, file.size() - cut), Code::kInvalidMesh, file.size() - cut);
    }
  }
}

TEST(off_writer, what_is_written_reads_back_bit_for_bit) {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{-0.0, 1.0 / 3, 5e-324}, Vec3{1e308, -1, 0.1}, Vec3{0, 1, 2}}) mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(2), VertexId(0), VertexId(1)});
  RunControl control;
  const std::string text = write_off(mesh, {"one\n4 4 4", "two"}, control);
  EXPECT_EQ(text.substr(0, text.find("-0")), "OFF\n3 1 0\n");
  EXPECT_TRUE(text.ends_with("3 2 0 1\n# one\n# 4 4 4\n# two\n")) << text;
  const ReadResult back = read_as_off(text);
  EXPECT_TRUE(back.diagnostics.empty());
  EXPECT_EQ(std::memcmp(back.mesh.positions.items().data(), mesh.positions.items().data(), 3 * sizeof(Vec3)), 0);
  EXPECT_EQ(faces_of(back.mesh), (std::vector<Face>{{2, 0, 1}}));
}

}  // namespace
}  // namespace remesh
