#include "api/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "api/request_code.h"
#include "core/base/error.h"

namespace remesh::api {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct Read {
  ReadResult result;
  RequestOptions options;
};

Read read(std::string_view text, const ReadLimits& limits = {}) {
  RunControl control;
  OptionReader options;
  ReadResult result = read_json(text, limits, control, options);
  return {std::move(result), options.options()};
}

Error error_of(std::string_view text, const ReadLimits& limits = {}) {
  try {
    read(text, limits);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "no error for " << text.substr(0, 200);
  return {Code::kInternal, Stage::kRead, ""};
}

constexpr std::string_view kSquareAsJson = R"({"vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "faces": [[0,1,2,3]]})";

// A mesh with one thing in it replaced.
std::string mesh(std::string_view vertices, std::string_view faces, std::string_view more = "") {
  return "{\"vertices\":" + std::string(vertices) + ",\"faces\":" + std::string(faces) + std::string(more) + "}";
}
constexpr std::string_view kVertices = "[[0,0,0],[1,0,0],[0,1,0]]";
constexpr std::string_view kFaces = "[[0,1,2]]";

TEST(json_reader, a_bare_mesh_is_read) {
  const PolygonMesh mesh = read(kSquareAsJson).result.mesh;
  EXPECT_EQ(mesh.vertex_count(), 4u);
  EXPECT_EQ(mesh.positions[VertexId(2)], (Vec3{1, 1, 0}));
  EXPECT_THAT(mesh.face_begin, ElementsAre(0u, 4u));
  EXPECT_THAT(mesh.corners, ElementsAre(VertexId(0), VertexId(1), VertexId(2), VertexId(3)));
  EXPECT_FALSE(mesh.labels.group.is_used());
}

TEST(json_reader, a_mesh_beside_its_options_is_read_in_any_order_of_keys) {
  for (
      const std::string_view text :
      {R"({"mesh":{"faces":[[0,1,2]],"vertices":[[0,0,0],[1,0,0],[0,1,0]]},"options":{"plane_tolerance":1e-5,"repair":["winding","degenerate"],"reference_axis":[0,0,1]}})",
       R"({"options":{"reference_axis":"0,0,1","repair":"degenerate,winding","plane_tolerance":0.00001},"mesh":{"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]}})",
       R"({"options":{"reference_axis":"0,0,1","repair":"degenerate,winding","plane_tolerance":0.00001},"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]})"}) {
    const Read got = read(text);
    EXPECT_EQ(got.result.mesh.face_count(), 1u);
    EXPECT_TRUE(got.result.diagnostics.empty());
    EXPECT_EQ(got.options.core.plane_tolerance, 1e-5);
    EXPECT_EQ(got.options.core.repair, (Repair{false, true, false, true, false}));
    EXPECT_EQ(got.options.core.reference_direction, (Vec3{0, 0, 1}));
  }
}

TEST(json_reader, a_list_of_words_with_signs_changes_the_default) {
  const auto repair = [](const std::string& value) {
    return read(mesh(kVertices, kFaces, ",\"options\":{\"repair\":" + value + "}")).options.core.repair;
  };
  Repair changed;
  changed.inside_out = true;
  changed.winding = false;
  for (const char* value : {R"(["+inside_out","-winding"])", R"("+inside_out,-winding")", R"(" inside_out,-winding")"})
    EXPECT_EQ(repair(value), changed) << value;
  EXPECT_EQ(error_of(R"({"options":{"repair":["+inside_out","winding"]}})").code, Code::kInvalidOption);
}

TEST(json_reader, coordinates_come_back_bit_for_bit) {
  std::mt19937_64 random(20240607);
  nlohmann::json document{{"vertices", nlohmann::json::array()}, {"faces", {{0, 1, 2}}}};
  std::vector<double> values{0.1, -0.0, 5e-324, 1.7976931348623157e308, 9007199254740993.0, 2.2250738585072011e-308};
  while (values.size() < 3000) {
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  for (std::size_t i = 0; i < values.size(); i += 3) {
    document["vertices"].push_back({values[i], values[i + 1], values[i + 2]});
  }
  const PolygonMesh mesh = read(document.dump()).result.mesh;
  ASSERT_EQ(mesh.vertex_count() * 3, values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double got = mesh.positions[VertexId(i / 3)][static_cast<int>(i % 3)];
    EXPECT_EQ(std::bit_cast<std::uint64_t>(got), std::bit_cast<std::uint64_t>(values[i])) << values[i];
  }
}

TEST(json_reader, integers_are_coordinates_too) {
  const PolygonMesh mesh =
      read(R"({"vertices":[[-3,18446744073709551615,-9223372036854775808],[1,0,0],[0,1e2,0]],"faces":[[0,1,2]]})")
          .result.mesh;
  EXPECT_EQ(mesh.positions[VertexId(0)], (Vec3{-3, 18446744073709551615.0, -9223372036854775808.0}));
}

TEST(json_reader, face_groups_become_group_labels) {
  const PolygonMesh mesh =
      read(::remesh::api::mesh(kVertices, "[[0,1,2],[0,2,1],[1,2,0]]", R"(,"face_groups":[7,-2,7])")).result.mesh;
  EXPECT_THAT(mesh.labels.group.names, ElementsAre("7", "-2"));
  EXPECT_THAT(mesh.labels.group.of_face.items(), ElementsAre(0u, 1u, 0u));
}

TEST(json_reader, labels_of_an_answer_are_read) {
  const std::string faces = "[[0,1,2],[0,2,1],[1,2,0]]";
  const auto with = [&](const std::string& labels) { return mesh(kVertices, faces, ",\"labels\":" + labels); };
  // Names that no face has are dropped, and equal ones are one.
  const Read got = read(with(R"({"material":{"of_face":[3,1.0,0],"names":["b","\u00e4","unused","b"],"colour":1},)"
                             R"("object":{"names":["part"],"of_face":[0,0,0]},"layer":[{"names":[0]}]})"));
  const FaceLabels& labels = got.result.mesh.labels;
  EXPECT_THAT(labels.material.names, ElementsAre("b", "ä"));
  EXPECT_THAT(labels.material.of_face.items(), ElementsAre(0u, 1u, 0u));
  EXPECT_THAT(labels.object.names, ElementsAre("part"));
  EXPECT_FALSE(labels.group.is_used());
  ASSERT_EQ(got.result.diagnostics.size(), 1u);
  EXPECT_THAT(got.result.diagnostics[0].message, HasSubstr(R"("colour" "layer")"));

  const std::string group = R"({"names":["a"],"of_face":[0,0,0]})";
  const std::map<std::string, std::pair<Code, std::string>> wrong{
      {with("[1]"), {Code::kInvalidMesh, "labels must be an object"}},
      {with(R"({"group":["a"]})"), {Code::kInvalidMesh, "labels must be as"}},
      {with(R"({"group":{"names":[1],"of_face":[0,0,0]}})"), {Code::kInvalidMesh, "labels must be as"}},
      {with(R"({"group":{"names":["a"],"of_face":[0,0.5,0]}})"), {Code::kInvalidMesh, "labels must be as"}},
      {with(R"({"group":{"names":["a"],"of_face":[0,-1,0]}})"), {Code::kInvalidMesh, "labels must be as"}},
      {with(R"({"group":{"names":["a"],"of_face":{}}})"), {Code::kInvalidMesh, "labels must be as"}},
      {with(R"({"group":{"names":["a"],"of_face":[0,0]}})"), {Code::kInvalidMesh, "group.of_face has 2 entries for 3"}},
      {with(R"({"group":{}})"), {Code::kInvalidMesh, "group.of_face has 0 entries for 3"}},
      {with(R"({"group":{"names":["a"],"of_face":[0,0,1]}})"), {Code::kIndexOutOfRange, "1 for face 2; there are 1"}},
      {with("{\"group\":" + group + "},\"face_groups\":[1,1,1]"), {Code::kInvalidMesh, "exclude each other"}},
      {with("{\"group\":" + group + ",\"group\":" + group + "}"),
       {as_code(RequestCode::kMalformedJson), "occurs twice"}}};
  for (const auto& [text, expected] : wrong) {
    const Error error = error_of(text);
    EXPECT_EQ(error.code, expected.first) << text;
    EXPECT_THAT(error.what(), HasSubstr(expected.second)) << text;
  }
}

TEST(json_reader, whole_numbers_are_integers_however_they_are_written) {
  const PolygonMesh got =
      read(mesh(kVertices, "[[0.0,1e0,20e-1],[-0.0,1,2]]", R"(,"face_groups":[-7,-7.0])")).result.mesh;
  EXPECT_THAT(got.corners, ElementsAre(VertexId(0), VertexId(1), VertexId(2), VertexId(0), VertexId(1), VertexId(2)));
  EXPECT_THAT(got.labels.group.names, ElementsAre("-7"));
  EXPECT_EQ(error_of(mesh(kVertices, "[[0,1,2.5]]")).code, Code::kInvalidMesh);
  for (const char* index : {"3.0", "-1.0", "1e9", "1e300"})
    EXPECT_EQ(error_of(mesh(kVertices, "[[0,1," + std::string(index) + "]]")).code, Code::kIndexOutOfRange) << index;
}

TEST(json_reader, keys_that_are_not_understood_are_skipped_and_counted) {
  const Read got = read(mesh(kVertices, kFaces, R"(,"uv":[[0,1],{"a":[true,null,"x"]}],"name":"part","n":3)"));
  ASSERT_EQ(got.result.diagnostics.size(), 1u);
  EXPECT_EQ(got.result.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
  EXPECT_EQ(got.result.diagnostics[0].count, 3u);
  EXPECT_THAT(got.result.diagnostics[0].message, HasSubstr("\"uv\" \"name\" \"n\""));
  EXPECT_EQ(got.result.mesh.face_count(), 1u);
}

TEST(json_reader, what_is_not_json_is_located) {
  const Error error = error_of("{\"vertices\":\n[[0,0,0],\n[1,0,,0]]}");
  EXPECT_EQ(error.code, RequestCode::kMalformedJson);
  EXPECT_EQ(error.line, 3u);
  for (const std::string_view text : {"", " ", "{", "nul", "{\"vertices\":[[0,0,0]", "{'vertices':[]}",
                                      "{\"a\":\"\xff\"}", "{} x", "\"\\ud800\"", "{\"a\":1,}"}) {
    EXPECT_EQ(error_of(text).code, RequestCode::kMalformedJson) << text;
  }
}

TEST(json_reader, every_truncation_is_an_error) {
  for (std::size_t length = 0; length < kSquareAsJson.size(); ++length) {
    EXPECT_EQ(error_of(kSquareAsJson.substr(0, length)).code, RequestCode::kMalformedJson) << length;
  }
}

TEST(json_reader, deep_nesting_is_refused_at_any_place) {
  const std::string deep(1 << 20, '[');
  EXPECT_EQ(error_of("{\"x\":" + deep).code, RequestCode::kMalformedJson);
  EXPECT_EQ(error_of("{\"mesh\":{\"x\":" + deep).code, RequestCode::kMalformedJson);
  EXPECT_EQ(error_of(deep).code, Code::kInvalidMesh);
}

TEST(json_reader, a_doubled_key_is_refused) {
  EXPECT_EQ(error_of(mesh(kVertices, kFaces, ",\"faces\":[]")).code, RequestCode::kMalformedJson);
  EXPECT_EQ(error_of(R"({"mesh":{},"mesh":{}})").code, RequestCode::kMalformedJson);
  EXPECT_EQ(error_of(R"({"mesh":{"vertices":[]},"vertices":[]})").code, RequestCode::kMalformedJson);
  EXPECT_EQ(error_of(R"({"options":{"refine":false,"refine":false}})").code, Code::kInvalidOption);
}

TEST(json_reader, a_wrong_shape_names_its_element) {
  struct Case {
    std::string text;
    std::optional<std::uint64_t> element;
  };
  const Case cases[] = {
      {"[]", {}},
      {"3", {}},
      {"{}", {}},
      {R"({"mesh":[]})", {}},
      {R"({"vertices":{}})", {}},
      {mesh("[[0,0,0],[1,0]]", kFaces), 1},
      {mesh("[[0,0,0],[1,0,0,0]]", kFaces), 1},
      {mesh("[[0,0,0],5]", kFaces), 1},
      {mesh("[[0,0,\"0\"]]", kFaces), 0},
      {mesh("[[0,0,null]]", kFaces), 0},
      {mesh("[[0,0,[0]]]", kFaces), 0},
      {mesh(kVertices, "[[0,1,2],[0,1]]"), 1},
      {mesh(kVertices, "[[]]"), 0},
      {mesh(kVertices, "[[0,1,2.5]]"), 0},
      {mesh(kVertices, "[[0,1,true]]"), 0},
      {mesh(kVertices, "[0,1,2]"), 0},
      {mesh(kVertices, kFaces, ",\"face_groups\":[1,2]"), {}},
      {mesh(kVertices, kFaces, ",\"face_groups\":[]"), {}},
      {mesh(kVertices, kFaces, ",\"face_groups\":[1.5]"), {}},
      {mesh(kVertices, kFaces, ",\"face_groups\":[\"a\"]"), {}},
      {R"({"vertices":[[0,0,0]]})", {}},
      {R"({"faces":[[0,1,2]]})", {}},
      {R"({"options":{}})", {}},
  };
  for (const Case& c : cases) {
    const Error error = error_of(c.text);
    EXPECT_EQ(error.code, Code::kInvalidMesh) << c.text;
    EXPECT_EQ(error.element, c.element) << c.text;
  }
}

TEST(json_reader, what_is_missing_is_told_with_the_last_line) {
  for (const std::string_view text : {"{\n\"faces\": [[0,1,2]]\n}", "{\n\"vertices\": [[0,0,0]]\n}", "{\n\n}"}) {
    const Error error = error_of(text);
    EXPECT_EQ(error.code, Code::kInvalidMesh) << text;
    EXPECT_EQ(error.line, 3u) << text;
  }
}

TEST(json_reader, an_index_out_of_range_names_its_face) {
  for (const std::string_view bad :
       {"3", "-1", "4294967295", "4294967296", "18446744073709551615", "99999999999999999999"}) {
    const Error error = error_of(mesh(kVertices, "[[0,1,2],[0,1," + std::string(bad) + "]]"));
    EXPECT_EQ(error.code, Code::kIndexOutOfRange) << bad;
    EXPECT_EQ(error.element, 1u) << bad;
  }
}

TEST(json_reader, indices_are_held_against_vertices_that_come_later) {
  EXPECT_EQ(read(R"({"faces":[[2,1,0]],"vertices":[[0,0,0],[1,0,0],[0,1,0]]})").result.mesh.face_count(), 1u);
  EXPECT_EQ(error_of(R"({"faces":[[3,1,0]],"vertices":[[0,0,0],[1,0,0],[0,1,0]]})").code, Code::kIndexOutOfRange);
}

TEST(json_reader, coordinates_that_are_not_finite_name_their_vertex) {
  for (const std::string_view bad : {"1e999", "-1e999", "NaN", "Infinity", "-Infinity"}) {
    const Error error = error_of(mesh("[[0,0,0],[0," + std::string(bad) + ",0]]", kFaces));
    EXPECT_EQ(error.code, Code::kNonfiniteCoordinate) << bad;
    EXPECT_EQ(error.element, 1u) << bad;
  }
}

TEST(json_reader, a_mesh_without_faces_is_empty) {
  EXPECT_EQ(error_of(mesh("[]", "[]")).code, Code::kEmptyMesh);
  EXPECT_EQ(error_of(mesh(kVertices, "[]")).code, Code::kEmptyMesh);
}

TEST(json_reader, limits_hold_exactly) {
  EXPECT_NO_THROW(read(kSquareAsJson, {4, 1}));
  const Error vertices = error_of(kSquareAsJson, {3, 1});
  EXPECT_EQ(vertices.code, Code::kMeshTooLarge);
  EXPECT_EQ(vertices.limit, 3u);
  const Error faces = error_of(kSquareAsJson, {4, 0});
  EXPECT_EQ(faces.code, Code::kMeshTooLarge);
  EXPECT_EQ(faces.limit, 0u);
}

TEST(json_reader, options_inside_are_checked_as_any_others) {
  const auto code = [](const std::string& options) { return error_of("{\"options\":" + options + "}").code; };
  EXPECT_EQ(code(R"({"plane_tol":1})"), RequestCode::kUnknownOption);
  EXPECT_EQ(code(R"({"plane_tolerance":"1"})"), Code::kInvalidOption);
  EXPECT_EQ(code(R"({"plane_tolerance":1e999})"), Code::kInvalidOption);
  EXPECT_EQ(code(R"({"plane_tolerance":{}})"), Code::kInvalidOption);
  EXPECT_EQ(code(R"({"nonsense":{}})"), RequestCode::kUnknownOption);
  EXPECT_EQ(code(R"({"repair":[["winding"]]})"), Code::kInvalidOption);
  EXPECT_EQ(code(R"({"repair":[true]})"), Code::kInvalidOption);
  for (const char* no_object : {"3", "null", "[]", "\"refine\""}) EXPECT_EQ(code(no_object), Code::kInvalidOption);
}

TEST(json_reader, options_beside_the_arrays_count_whether_the_mesh_is_bare_or_not) {
  const std::string with_options = mesh(kVertices, kFaces, R"(,"options":{"refine":false})");
  for (const std::string& text : {with_options, "{\"mesh\":" + with_options + "}"}) {
    const Read got = read(text);
    EXPECT_FALSE(got.options.core.refine) << text;
    EXPECT_TRUE(got.result.diagnostics.empty()) << text;
  }
  EXPECT_EQ(error_of("{\"mesh\":" + with_options + R"(,"options":{}})").code, RequestCode::kMalformedJson);
}

TEST(json_reader, an_options_document_alone_is_read) {
  RunControl control;
  OptionReader options;
  read_json_options(R"({"keep_boundary_vertices":true,"format":"json"})", control, options);
  EXPECT_TRUE(options.options().core.keep_boundary_vertices);
  EXPECT_EQ(options.options().format, Format::kJson);
  for (const std::string_view bad : {"[]", "3", "", "{"}) {
    OptionReader none;
    EXPECT_THROW(read_json_options(bad, control, none), Error) << bad;
  }
}

TEST(json_reader, any_single_changed_byte_gives_a_mesh_or_a_typed_error) {
  std::string text(
      R"({"mesh":{"vertices":[[0,0.5,0],[1e2,0,0],[0,1,-0]],"faces":[[0,1,2]],"face_groups":[4]},"options":{"repair":["winding"]}})");
  const std::string original = text;
  std::size_t read_whole = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char c : {'\0', '"', '[', ']', '{', '}', ',', ':', '9', '-', 'e', '.', '\xff', ' '}) {
      text[i] = c;
      try {
        const Read got = read(text);
        ++read_whole;
        for (const VertexId v : got.result.mesh.corners) EXPECT_LT(v.value, got.result.mesh.vertex_count());
      } catch (const Error& error) {
        EXPECT_NE(error.code, Code::kInternal);
      }
    }
    text[i] = original[i];
  }
  EXPECT_GT(read_whole, 0u);
}

/// Returns what a check without a mesh must say of a text: the error of reading it, unless it is one of the mesh.
std::string told_by_reading(std::string_view text) {
  try {
    const Read got = read(text);
    return "good, " + std::to_string(got.options.core.plane_tolerance.value_or(0));
  } catch (const Error& error) {
    for (const Code code : {Code::kInvalidMesh, Code::kIndexOutOfRange, Code::kNonfiniteCoordinate, Code::kEmptyMesh})
      if (error.code == code) return "an error of the mesh";
    return error.what() + std::to_string(error.line.value_or(0));
  }
}

std::string told_by_check(std::string_view text, std::string_view for_mesh_errors) {
  RunControl control;
  OptionReader options;
  try {
    check_json_text(text, {}, control, options);
    return for_mesh_errors.empty() ? "good, " + std::to_string(options.options().core.plane_tolerance.value_or(0))
                                   : std::string(for_mesh_errors);
  } catch (const Error& error) {
    return error.what() + std::to_string(error.line.value_or(0));
  }
}

TEST(json_reader, a_check_without_a_mesh_finds_what_reading_finds_but_for_errors_of_the_mesh) {
  std::string text(R"({"mesh": {"vertices": [[0,0.5,0],
    [1e2,0,0],[0,1,-0]], "faces": [[0,1,2]], "face_groups": [4]}, "other": ["x"],
    "options": {"plane_tolerance": 2e-3}})");
  const std::string original = text;
  std::map<std::string, int> seen;
  const auto compare = [&](std::string_view changed) {
    const std::string told = told_by_reading(changed);
    const bool is_of_mesh = told == "an error of the mesh";
    EXPECT_EQ(told_by_check(changed, is_of_mesh ? told : ""), told) << changed;
    ++seen[is_of_mesh || told.starts_with("good") ? told : "an error of the text"];
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char c : {'\0', '"', '[', ']', '{', '}', ',', ':', '9', '-', 'e', '.', '\xff', ' ', 'N'}) {
      text[i] = c;
      compare(text);
    }
    text[i] = original[i];
    compare(std::string_view(text).substr(0, i));
  }
  EXPECT_GT(seen["good, 0.002000"], 100);
  EXPECT_GT(seen["an error of the mesh"], 100);
  EXPECT_GT(seen["an error of the text"], 100);
}

TEST(json_reader, a_stop_is_obeyed) {
  std::string many = "{\"vertices\":[";
  for (int i = 0; i < 10000; ++i) many += "[0,0,0],";
  RunControl control;
  control.cancel();
  OptionReader options;
  try {
    read_json(many, {}, control, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kCancelled);
  }
}

}  // namespace
}  // namespace remesh::api
