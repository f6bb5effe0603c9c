#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "core/io/obj/obj.h"

namespace remesh {
namespace {

constexpr const char* kOneTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

ReadResult read(const std::string& text, const ReadLimits& limits = {}) {
  RunControl control;
  return read_obj(text, limits, control);
}

/// Returns the error that reading `text` ends with.
Error error_of(const std::string& text, const ReadLimits& limits = {}) {
  try {
    read(text, limits);
  } catch (const Error& error) {
    EXPECT_EQ(error.stage, Stage::kRead);
    return error;
  }
  ADD_FAILURE() << "read without an error: " << text.substr(0, 200);
  return Error(Code::kInternal, Stage::kQueued, "none");
}

void expect_error(const std::string& text, Code code, std::uint64_t line) {
  const Error error = error_of(text);
  EXPECT_EQ(code_name(error.code), code_name(code)) << text.substr(0, 200) << ": " << error.what();
  EXPECT_EQ(error.line, line) << text.substr(0, 200) << ": " << error.what();
}

using Face = std::vector<std::uint32_t>;
std::vector<Face> corner_lists(const PolygonMesh& mesh) {
  std::vector<Face> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    Face& face = faces.emplace_back();
    for (const VertexId v : mesh.face(FaceId(f))) face.push_back(v.value);
  }
  return faces;
}

std::vector<std::string> labels_in_order(const LabelSet& labels) {
  std::vector<std::string> names;
  for (const std::uint32_t label : labels.of_face) names.push_back(labels.names.at(label));
  return names;
}

using Names = std::vector<std::string>;

// --- vertices

TEST(obj_reader, vertices_come_in_file_order_and_faces_as_listed) {
  const PolygonMesh mesh = read("v 0 0 0\nv 1 0 0\nf 1 2 3\nv 1 1 0.5\nv -0 1 2\nf 1 2 3 4\n").mesh;
  ASSERT_EQ(mesh.vertex_count(), 4u);
  EXPECT_EQ(mesh.positions[VertexId(2)], (Vec3{1, 1, 0.5}));
  EXPECT_TRUE(std::signbit(mesh.positions[VertexId(3)].x));
  EXPECT_EQ(corner_lists(mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2, 3}}));
  EXPECT_EQ(mesh.labels, FaceLabels{});
}

/// Returns a number as some program might print it, with any sign, count of digits, place of the point and spelling of
/// the exponent.
std::string random_number(std::mt19937_64& random) {
  const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  std::string text = std::array{"", "-", "+"}[pick(3)];
  const int digits = pick(4) == 0 ? 1 + pick(60) : 1 + pick(20);
  const int point = pick(digits + 2);  // past the digits: none
  for (int i = 0; i < digits; ++i) {
    if (i == point) text += '.';
    text += static_cast<char>('0' + pick(10));
  }
  if (point == digits) text += '.';
  if (pick(2) == 0) {
    // The value stays finite: at most 60 digits before the point.
    const int exponent = pick(5) == 0 ? pick(640) - 400 : pick(40) - 20;
    char spelled[16];
    const char* shape = std::array{"e%d", "E%+d", "e%+04d", "E%03d"}[pick(4)];
    std::snprintf(spelled, sizeof spelled, shape, exponent);
    text += spelled;
  }
  return text;
}

/// Returns the exact decimal expansion of the middle between a double and the next one, which is the hardest text to
/// round.
std::string random_tie(std::mt19937_64& random) {
  double below = 0;
  do {
    const std::uint64_t bits = random();
    std::memcpy(&below, &bits, sizeof below);
  } while (!(std::fabs(below) < 1e300 && std::fabs(below) > 1e-300));
  const long double middle = (static_cast<long double>(below) + std::nextafter(below, HUGE_VAL)) / 2;
  char text[1200];
  std::snprintf(text, sizeof text, "%.1100Lg", middle);
  return text;
}

TEST(obj_reader, coordinates_are_correctly_rounded) {
  std::mt19937_64 random(20);
  std::vector<double> expected;
  std::string text;
  for (int i = 0; i < 102'000; ++i) {
    const std::string number = i < 100'000 ? random_number(random) : random_tie(random);
    text += i % 3 == 0 ? "\nv " : " ";
    text += number;
    expected.push_back(std::strtod(number.c_str(), nullptr));
    ASSERT_TRUE(std::isfinite(expected.back())) << number;
  }
  const PolygonMesh mesh = read(text + "\nf 1 2 3\n").mesh;
  ASSERT_EQ(mesh.vertex_count() * 3, expected.size());
  for (std::uint32_t i = 0; i < expected.size(); ++i) {
    const double value = mesh.positions[VertexId(i / 3)][static_cast<int>(i % 3)];
    ASSERT_EQ(value, expected[i]);
    ASSERT_EQ(std::signbit(value), std::signbit(expected[i]));
  }
}

TEST(obj_reader, vertex_errors_name_their_line) {
  const std::string face = "f 1 1 1\n";
  expect_error("v 0 0 0\nv 1\n" + face, Code::kInvalidMesh, 2);
  expect_error("v\n" + face, Code::kInvalidMesh, 1);
  expect_error("v 1 # 2 3\n" + face, Code::kInvalidMesh, 1);
  expect_error("v 0 0 0\n\nv 1 2 x3\n" + face, Code::kInvalidMesh, 3);
  expect_error("v 1 2 3.1+e2\n" + face, Code::kInvalidMesh, 1);
  expect_error("v 1,0 2 3\n" + face, Code::kInvalidMesh, 1);
  expect_error("#\n#\nv 0 nan 0\n" + face, Code::kNonfiniteCoordinate, 3);
  expect_error("v -inf 0 0\n" + face, Code::kNonfiniteCoordinate, 1);
  expect_error("v 0 0 1e999\n" + face, Code::kNonfiniteCoordinate, 1);
  expect_error("v 0 0 -1.#IND\n" + face, Code::kNonfiniteCoordinate, 1);
}

TEST(obj_reader, a_missing_z_is_zero_and_counted) {
  const ReadResult result = read("v 0 0 5\nv 1 0\nv 1 1 # flat\nf 1 2 3\n");
  EXPECT_EQ(result.mesh.positions[VertexId(1)], (Vec3{1, 0, 0}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_EQ(result.diagnostics[0].count, 2u);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_NE(result.diagnostics[0].message.find("missing z read as 0"), std::string::npos);
}

TEST(obj_reader, values_after_z_are_counted_but_not_read) {
  const ReadResult result = read("v 0 0 0 1\nv 1 0 0 nan 1e999 red\nv 1 1 0 # 1\nf 1 2 3\n");
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{0, 1}));
}

// --- faces

TEST(obj_reader, corners_are_taken_in_every_form) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const char* face :
       {"1 2 3 4", "1/1 2/2 3/3 4/4", "1//1 2//2 3//3 4//4", "1/1/1 2/2/2 3/3/3 4/4/4", "1/ 2// 3/7/ 4", "-4 -3 -2 -1",
        "1/-9 -3//-9 3/0/0 -1/5/-2", "  1\t2 \v3\f4  ", "1 2 3 4 # a square", "01 2 003 4"}) {
    EXPECT_EQ(corner_lists(read(vertices + "f " + face + "\n").mesh), (std::vector<Face>{{0, 1, 2, 3}})) << face;
  }
}

TEST(obj_reader, negative_indices_count_back_from_where_they_stand) {
  const std::string text = std::string(kOneTriangle) + "f -3 -2 -1\nv 0 0 1\nf -3 -2 -1\nf 1 -1 2\n";
  EXPECT_EQ(corner_lists(read(text).mesh), (std::vector<Face>{{0, 1, 2}, {1, 2, 3}, {0, 3, 1}}));
}

TEST(obj_reader, a_face_may_stand_before_its_vertices) {
  EXPECT_EQ(corner_lists(read(std::string("f 1 2 3\n") + kOneTriangle + "f 3 2 1\n").mesh),
            (std::vector<Face>{{0, 1, 2}, {2, 1, 0}}));
}

TEST(obj_reader, an_index_without_its_vertex_names_the_first_line_of_such) {
  const std::string v = kOneTriangle;
  expect_error(v + "f 1 2 0\n", Code::kIndexOutOfRange, 4);
  expect_error(v + "f 1 2 3\nf 1 2 4\n", Code::kIndexOutOfRange, 5);
  expect_error(v + "f 1 2 -4\n", Code::kIndexOutOfRange, 4);
  expect_error("f -1 -2 -3\n" + v, Code::kIndexOutOfRange, 1);
  expect_error("f 1 2 3\nf 1 2 4\nf 1 2 9\nf 1 2 5\n" + v, Code::kIndexOutOfRange, 2);
  expect_error("f 1 2 3\nf 3 2 1\nf 9 2 4\nf 1 2 5\n" + v, Code::kIndexOutOfRange, 3);
  expect_error(v + "f 1 2 2147483648\n", Code::kIndexOutOfRange, 4);
  expect_error(v + "f 1 2 -2147483648\n", Code::kIndexOutOfRange, 4);
  expect_error(v + "f 1 2 99999999999999999999\n", Code::kIndexOutOfRange, 4);
  expect_error(v + "f 1/99999999999 2 3\n", Code::kIndexOutOfRange, 4);
}

TEST(obj_reader, an_error_names_its_face_or_vertex_from_0) {
  const std::string v = kOneTriangle, face = "f 1 2 3\n";
  const std::string two_faces = v + face + face;
  for (const char* bad : {"f 1 2 9\n", "f 1 2 0\n", "f 1 2 -9\n", "f 1 2 99999999999\n", "f 1 2\n", "f 1 2 x\n"}) {
    EXPECT_EQ(error_of(two_faces + bad + face).element, 2u) << bad;
  }
  EXPECT_EQ(error_of(face + "f 1 2 9\n" + v).element, 1u);
  for (const char* bad : {"v 1\n", "v 1 x 0\n", "v nan 0 0\n"}) EXPECT_EQ(error_of(v + bad + face).element, 3u) << bad;
}

TEST(obj_reader, malformed_faces_name_their_line) {
  const std::string v = kOneTriangle;
  for (const char* face :
       {"f", "f 1", "f 1 2", "f 1// 2//", "f 1 2 # 3", "f 1 2 x", "f 1 2 3.5", "f 1 2 /3", "f 1 2 3/1/1/1",
        "f 1 2 3///", "f 1 2 3/x", "f 1 2 3/1/x", "f 1 2 3\\ 1", "f 1 2 +3", "f 1 2 0x3", "f 1 2 -"}) {
    expect_error(v + face + "\n", Code::kInvalidMesh, 4);
  }
}

TEST(obj_reader, a_polygon_of_any_size_stays_one_face) {
  for (const std::uint32_t sides : {255u, 256u, 1000u, 70'000u}) {
    std::string text;
    for (std::uint32_t i = 0; i < sides; ++i) text += "v " + std::to_string(i) + " 0 " + std::to_string(i * i) + "\n";
    text += "f";
    for (std::uint32_t i = 0; i < sides; ++i) text += " " + std::to_string(i + 1) + "//1";
    const PolygonMesh mesh = read(text).mesh;
    ASSERT_EQ(mesh.face_count(), 1u);
    ASSERT_EQ(mesh.corners.size(), sides);
    for (std::uint32_t i = 0; i < sides; ++i) ASSERT_EQ(mesh.corners[i], VertexId(i));
  }
}

TEST(obj_reader, text_without_a_face_is_an_empty_mesh) {
  for (const char* text : {"", "\n", "# nothing", "v 0 0 0\n", "o a\ng b\n", "\xef\xbb\xbf"}) {
    EXPECT_EQ(error_of(text).code, Code::kEmptyMesh) << text;
  }
}

// --- limits and control

TEST(obj_reader, limits_hold_to_the_last_element) {
  const std::string text = std::string(kOneTriangle) + "f 1 2 3\nf 3 2 1\n";
  EXPECT_EQ(read(text, {.max_vertices = 3, .max_faces = 2}).mesh.face_count(), 2u);
  const Error vertices = error_of(text, {.max_vertices = 2, .max_faces = 2});
  EXPECT_EQ(vertices.code, Code::kMeshTooLarge);
  EXPECT_EQ(vertices.limit, 2u);
  EXPECT_EQ(vertices.line, 3u);
  const Error faces = error_of(text, {.max_vertices = 3, .max_faces = 1});
  EXPECT_EQ(faces.code, Code::kMeshTooLarge);
  EXPECT_EQ(faces.limit, 1u);
  EXPECT_EQ(faces.line, 5u);
}

TEST(obj_reader, a_face_of_more_than_four_million_corners_is_too_large) {
  std::string text = std::string(kOneTriangle) + "f";
  for (int i = 0; i < 4'000'001; ++i) text += " 1";
  EXPECT_EQ(error_of(text).code, Code::kMeshTooLarge);
  text.resize(text.size() - 2);
  EXPECT_EQ(read(text).mesh.corners.size(), 4'000'000u);
}

TEST(obj_reader, a_stop_is_obeyed_and_progress_shown) {
  std::string text = std::string(kOneTriangle) + "f 1 2 3\n";
  while (text.size() < 4'000'000) text += "vn 0 0 1\n";
  RunControl control;
  (void)read_obj(text, {}, control);
  EXPECT_EQ(control.stage(), Stage::kRead);
  EXPECT_GT(control.fraction(), 0.9);
  control.cancel();
  try {
    (void)read_obj(text, {}, control);
    FAIL() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled);
  }
}

// --- lines and bytes

const std::vector<std::string> kLineEnds = {"\n", "\r\n", "\r"};

/// `text` with another line end than `\n`.
std::string with_line_end(const std::string& line_end, std::string_view text) {
  std::string result;
  for (const char c : text) c == '\n' ? result.append(line_end) : result.append(1, c);
  return result;
}

TEST(obj_reader, line_ends_of_all_three_kinds_count_lines_alike) {
  for (const std::string& end : kLineEnds) {
    const std::string text = "# a\n\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    EXPECT_EQ(corner_lists(read(with_line_end(end, text)).mesh), (std::vector<Face>{{0, 1, 2}}));
    expect_error(with_line_end(end, text + "\nf 1 2 x\n"), Code::kInvalidMesh, 8);
    expect_error(with_line_end(end, text + "\nf 1 2 x"), Code::kInvalidMesh, 8);
  }
  expect_error("v 0 0 0\r\n\rv x 0 0\r\r\n\n", Code::kInvalidMesh, 3);
}

TEST(obj_reader, a_backslash_at_the_end_continues_the_line) {
  for (const std::string& end : kLineEnds) {
    const std::string text = "v 0 \\\n0 \\\n 0\nv 1 0 0\nv 0 1 0\ng a\\\nb\nf 1\\\n2 3\n";
    const PolygonMesh mesh = read(with_line_end(end, text)).mesh;
    EXPECT_EQ(corner_lists(mesh), (std::vector<Face>{{0, 1, 2}}));
    EXPECT_EQ(mesh.labels.group.names, Names{"a b"});
    expect_error(with_line_end(end, text + "f 1 \\\n2 \\\nx\n"), Code::kInvalidMesh, 10);
    expect_error(with_line_end(end, text + "f 1 2 \\\n3\nf 0 1 2"), Code::kIndexOutOfRange, 12);
  }
  EXPECT_EQ(read(std::string(kOneTriangle) + "f 1 2 3 \\").mesh.face_count(), 1u);
  EXPECT_EQ(read(std::string(kOneTriangle) + "f 1 2 3 \\\n\\\n\\\n").mesh.face_count(), 1u);
}

TEST(obj_reader, blanks_behind_a_backslash_matter_where_it_may_end_a_name) {
  const PolygonMesh mesh = read(
                               "v 0 \\ \n0 \\\t \n 0\nv 1 0 0\nv 0 1 0\nvn 0 0 \\ \n1\nusemtl C:\\dir\\ \nf 1\\ \n2 "
                               "\\\n 3\\ \n\nf 1 2 3 # C:\\ \nf 3 2 1\n")
                               .mesh;
  EXPECT_EQ(corner_lists(mesh), (std::vector<Face>{{0, 1, 2}, {0, 1, 2}, {2, 1, 0}}));
  EXPECT_EQ(mesh.labels.material.names, Names{"C:\\dir\\"});
}

TEST(obj_reader, a_comment_that_ends_in_a_backslash_does_not_swallow_the_next_line) {
  EXPECT_EQ(read("v 0 0 0\n# C:\\parts\\\nv 1 0 0\n  #\\\nv 0 1 0\nf 1 2 3\n").mesh.vertex_count(), 3u);
}

TEST(obj_reader, a_utf8_byte_order_mark_is_skipped) {
  EXPECT_EQ(read(std::string("\xef\xbb\xbf") + kOneTriangle + "f 1 2 3\n").mesh.vertex_count(), 3u);
}

TEST(obj_reader, utf16_is_refused_by_name) {
  for (const std::string mark : {"\xff\xfe", "\xfe\xff"}) {
    const Error error = error_of(mark + std::string("v\0 \0", 4));
    EXPECT_EQ(error.code, Code::kInvalidMesh);
    EXPECT_EQ(error.line, 1u);
    EXPECT_NE(std::string(error.what()).find("UTF-16"), std::string::npos);
  }
}

TEST(obj_reader, control_characters_are_no_text_but_in_comments) {
  const std::string v = kOneTriangle;
  for (int c = 1; c < 0x20; ++c) {
    if (std::strchr("\t\n\v\f\r", c) != nullptr) continue;
    expect_error(v + "g a" + static_cast<char>(c) + "b\nf 1 2 3\n", Code::kInvalidMesh, 4);
    EXPECT_EQ(read(v + "# " + static_cast<char>(c) + "\nf 1 2 3\n").mesh.face_count(), 1u);
  }
  expect_error(v + "vn 0 0 1\x7f\n", Code::kInvalidMesh, 4);
  expect_error(v + "f 1 2 3\n" + std::string(4, '\0') + "\n", Code::kInvalidMesh, 5);
  expect_error(v + "f 1 2 \\\n3\x01\n", Code::kInvalidMesh, 5);
  EXPECT_NE(std::string(error_of(std::string("v 0 0\0 0", 8)).what()).find("0x00"), std::string::npos);
}

TEST(obj_reader, zeros_and_the_end_mark_of_dos_behind_the_text_are_padding) {
  const std::string text = std::string(kOneTriangle) + "f 1 2 3";
  for (const std::string& padding : {std::string("\x1a"), std::string(300, '\0'), "\x1a" + std::string(5, '\0')})
    for (const std::string end : {"", "\n", "\r\n", " \\\n", " # the last"}) {
      const ReadResult result = read(text + end + padding);
      EXPECT_EQ(corner_lists(result.mesh), (std::vector<Face>{{0, 1, 2}}));
      ASSERT_EQ(result.diagnostics.size(), 1u);
      EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTrailingBytes);
      EXPECT_EQ(result.diagnostics[0].count, padding.size());
    }
  expect_error(text + "\n\x1a\nf 1 2 3\n", Code::kInvalidMesh, 5);
}

TEST(obj_reader, the_old_word_for_a_face_is_read) {
  const ReadResult result = read(std::string(kOneTriangle) + "fo 1 2 3\nf 3/1 2 1\n  fo\t-3//1 -2 \\\n-1\n");
  EXPECT_EQ(corner_lists(result.mesh), (std::vector<Face>{{0, 1, 2}, {2, 1, 0}, {0, 1, 2}}));
  EXPECT_TRUE(result.diagnostics.empty());
  expect_error(std::string(kOneTriangle) + "fo 1 2\n", Code::kInvalidMesh, 4);
}

TEST(obj_reader, a_line_must_start_with_a_keyword) {
  const std::string v = kOneTriangle;
  for (const char* line :
       {"<html>", "1 2 3", "{}", "\xff\xfe", "\xc3\xa4 1", "v\xc3\xa4 1", "-f 1 2 3", "_v 1", "f, 1 2 3", "/ 1"}) {
    expect_error(v + line + "\nf 1 2 3\n", Code::kInvalidMesh, 4);
  }
}

TEST(obj_reader, names_and_comments_may_be_in_any_encoding) {
  const PolygonMesh mesh = read(std::string("# \xff\xfe \xc3\n") + kOneTriangle + "g t\xfcr\nf 1 2 3\n").mesh;
  EXPECT_EQ(mesh.labels.group.names, Names{"t\xfcr"});
}

// --- labels

TEST(obj_reader, faces_keep_object_group_and_material) {
  const PolygonMesh mesh = read(std::string(kOneTriangle) +
                                "o hull\ng deck left\nusemtl steel \nf 1 2 3\n"
                                "usemtl glass\nf 1 2 3\n"
                                "g\tkeel  \t right \no hull\nf 1 2 3\n"
                                "g deck left\nusemtl steel\nf 1 2 3\n")
                               .mesh;
  EXPECT_EQ(mesh.labels.object.names, Names{"hull"});
  EXPECT_EQ(labels_in_order(mesh.labels.object), (Names{"hull", "hull", "hull", "hull"}));
  EXPECT_EQ(mesh.labels.group.names, (Names{"deck left", "keel right"}));
  EXPECT_EQ(labels_in_order(mesh.labels.group), (Names{"deck left", "deck left", "keel right", "deck left"}));
  EXPECT_EQ(mesh.labels.material.names, (Names{"steel", "glass"}));
  EXPECT_EQ(labels_in_order(mesh.labels.material), (Names{"steel", "glass", "glass", "steel"}));
}

TEST(obj_reader, faces_before_the_first_record_of_a_kind_have_the_empty_name) {
  const FaceLabels labels = read(std::string(kOneTriangle) + "f 1 2 3\nf 1 2 3\ng a\nf 1 2 3\n").mesh.labels;
  EXPECT_EQ(labels.group.names, (Names{"", "a"}));
  EXPECT_EQ(labels_in_order(labels.group), (Names{"", "", "a"}));
  EXPECT_FALSE(labels.object.is_used());
  EXPECT_FALSE(labels.material.is_used());
}

TEST(obj_reader, records_without_a_name_give_the_empty_name) {
  const FaceLabels labels =
      read(std::string(kOneTriangle) + "f 1 2 3\no\ng  \nusemtl\t\nf 1 2 3\nusemtl a\nf 1 2 3\n").mesh.labels;
  EXPECT_EQ(labels_in_order(labels.object), (Names{"", "", ""}));
  EXPECT_EQ(labels_in_order(labels.group), (Names{"", "", ""}));
  EXPECT_EQ(labels_in_order(labels.material), (Names{"", "", "a"}));
  EXPECT_EQ(labels.object.names, Names{""});
}

TEST(obj_reader, a_name_that_no_face_bears_leaves_no_trace) {
  const FaceLabels labels = read(std::string(kOneTriangle) + "g a\ng b\nf 1 2 3\ng c\nusemtl d\n").mesh.labels;
  EXPECT_EQ(labels.group.names, Names{"b"});
  EXPECT_EQ(labels.material, LabelSet{});
}

TEST(obj_reader, names_keep_what_looks_like_syntax) {
  const FaceLabels labels =
      read(std::string(kOneTriangle) + "o  a  b # c \nusemtl C:\\x\\f 1\ng f 1 2 3\nf 1 2 3\n").mesh.labels;
  EXPECT_EQ(labels.object.names, Names{"a  b # c"});
  EXPECT_EQ(labels.material.names, Names{"C:\\x\\f 1"});
  EXPECT_EQ(labels.group.names, Names{"f 1 2 3"});
}

TEST(obj_reader, a_name_of_more_than_4096_bytes_is_refused) {
  const std::string name(4096, 'n');
  EXPECT_EQ(read(kOneTriangle + ("g " + name) + "\nf 1 2 3\n").mesh.labels.group.names, Names{name});
  expect_error(kOneTriangle + ("g " + name) + "n\nf 1 2 3\n", Code::kInvalidMesh, 4);
}

TEST(obj_reader, material_libraries_are_kept_as_text) {
  const FaceLabels labels =
      read(std::string("mtllib  a.mtl b c.mtl \nmtllib\n") + kOneTriangle + "f 1 2 3\nmtllib /etc/passwd\n")
          .mesh.labels;
  EXPECT_EQ(labels.material_libraries, (Names{"a.mtl b c.mtl", "/etc/passwd"}));
}

TEST(obj_reader, a_material_library_that_exists_is_not_opened) {
  const auto path = std::filesystem::temp_directory_path() / ("obj_reader_test_" + std::to_string(getpid()) + ".mtl");
  std::ofstream(path) << "newmtl steel\n";
  const int watch = inotify_init1(IN_NONBLOCK);
  ASSERT_GE(watch, 0);
  ASSERT_GE(inotify_add_watch(watch, path.c_str(), IN_OPEN | IN_ACCESS), 0);
  alignas(inotify_event) char events[4096];

  (void)read("mtllib " + path.string() + "\n" + kOneTriangle + "usemtl steel\nf 1 2 3\n");
  EXPECT_LT(::read(watch, events, sizeof events), 0) << "opened";

  std::ifstream(path).get();
  EXPECT_GT(::read(watch, events, sizeof events), 0) << "the watch would not have seen it";
  close(watch);
  std::filesystem::remove(path);
}

// --- what is dropped

TEST(obj_reader, each_kind_of_other_record_is_counted_once) {
  const ReadResult result = read(std::string("vt 0 0\nvn 0 0 1\nvt nan x\n") + kOneTriangle +
                                 "s 1\nf 1 2 3\nl 1 2\np 1\nvp 1\nvw 0 1\ncstype bezier\ncstype bspline\nvt\n");
  std::vector<std::pair<std::string, std::uint64_t>> found;
  for (const Diagnostic& diagnostic : result.diagnostics) {
    EXPECT_EQ(diagnostic.code, DiagnosticCode::kAttributeDropped);
    EXPECT_NE(diagnostic.message.find(std::to_string(diagnostic.count)), std::string::npos) << diagnostic.message;
    found.emplace_back(diagnostic.message.substr(0, diagnostic.message.find(' ')), diagnostic.count);
  }
  EXPECT_EQ(found, (std::vector<std::pair<std::string, std::uint64_t>>{
                       {"vt", 3}, {"vn", 1}, {"s", 1}, {"l", 1}, {"p", 1}, {"vp", 1}, {"vw", 1}, {"cstype", 2}}));
}

TEST(obj_reader, made_up_keywords_do_not_make_the_report_grow_without_end) {
  std::string text = kOneTriangle;
  for (int i = 0; i < 1000; ++i) text += "k" + std::to_string(i) + " 1\n";
  text += std::string(100'000, 'k') + "\nf 1 2 3\n";
  const ReadResult result = read(text);
  EXPECT_LE(result.diagnostics.size(), 64u);
  std::uint64_t total = 0;
  for (const Diagnostic& diagnostic : result.diagnostics) {
    total += diagnostic.count;
    EXPECT_LT(diagnostic.message.size(), 200u);
  }
  EXPECT_EQ(total, 1001u);
}

}  // namespace
}  // namespace remesh
