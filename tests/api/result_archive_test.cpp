// Tests results that are stored first and written later.
#include "api/result_archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "api/operations.h"
#include "api/request_code.h"

namespace remesh::api {
namespace {

/// Two squares in one plane, with objects, groups, materials and a library.
constexpr std::string_view kLabelled =
    "mtllib part.mtl\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\no left\ng a\nusemtl red\nf 1 2 5 6\n"
    "o right\ng b\nusemtl blue\nf 2 3 4 5\n";

Request request(std::string_view body, Fields query = {}, const std::string& accept = "") {
  Request made;
  made.body = body;
  made.query = std::move(query);
  made.accept = accept;
  return made;
}

StoredRemesh keep(const Request& asked) {
  RunControl control;
  return run_remesh_to_keep(asked, {}, control);
}

Response write(const StoredRemesh& kept, const Request& wanted) {
  RunControl control;
  return write_kept(
      kept.mesh, [&] { return kept.report; }, wanted, control);
}

/// Removes the times and the format that was asked for, since only these may differ.
nlohmann::json without_times(const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text);
  json["report"].erase("timing_ms");
  json["report"]["options"].erase("format");  // the one that the job asked for
  json["report"].erase("recipe");             // which follows from that format
  return json;
}

TEST(result_archive, a_kept_result_is_written_in_every_format_as_it_would_have_been_at_once) {
  const StoredRemesh kept = keep(request(kLabelled, {{"max_edge_length", "0.3"}}));
  for (const Format format : kFormats) {
    if (!is_written(format)) continue;
    const std::string name(format_name(format));
    RunControl control;
    const Response direct = run_remesh(request(kLabelled, {{"max_edge_length", "0.3"}, {"format", name}}), {}, control);
    const Response later = write(kept, request("", {{"format", name}}));
    EXPECT_EQ(later.content_type, direct.content_type);
    ASSERT_EQ(later.headers.size(), direct.headers.size());
    EXPECT_EQ(later.headers[0], direct.headers[0]) << "Remesh-Summary";
    if (format == Format::kJson) {
      EXPECT_TRUE(without_times(later.body) == without_times(direct.body)) << later.body.substr(0, 1000);
    } else {
      EXPECT_TRUE(later.body == direct.body) << name;
    }
  }
}

TEST(result_archive, what_the_job_asked_for_holds_where_nothing_else_is_asked) {
  const StoredRemesh as_stl = keep(request(kLabelled, {{"format", "stl"}}));
  EXPECT_EQ(write(as_stl, request("")).content_type, "model/stl");
  EXPECT_EQ(write(as_stl, request("", {}, "*/*")).content_type, "model/stl");
  EXPECT_EQ(write(as_stl, request("", {}, "model/obj")).content_type, "model/obj");
  const StoredRemesh accepted = keep(request(kLabelled, {}, "application/x-off"));
  EXPECT_EQ(write(accepted, request("")).content_type, "application/x-off");
  EXPECT_EQ(write(keep(request(kLabelled)), request("")).content_type, "model/obj");
}

TEST(result_archive, every_number_and_label_comes_back) {
  KeptResult kept;
  kept.format = Format::kPly;
  kept.local_origin = true;
  kept.writing = {LabelChoice::kMaterial, NameRule::kExact, StlSolids::kOne, MshVersion::k41, GlbColours::kQuality};
  kept.summary = {.input_faces = 1,
                  .output_faces = 2,
                  .patches = 3,
                  .kept = 4,
                  .min_angle_deg = 0.1,
                  .is_verified = true,
                  .warnings = {"", "two\nlines"},
                  .unrefined = {{UnrefinedReason::kEffort, 5}},
                  .distance_bound = DistanceBound{0.25, 0.125},
                  .origin = std::nullopt};
  kept.exact_report = "{}";
  RoundingInput& basis = kept.result.rounding_input;
  basis.normals.items() = {{0, 0, 1}, {0.6, -0.8, 0}};
  basis.allowed_move = 1e-300;
  basis.is_refined = true;
  basis.goals = {.min_angle_deg = 20,
                 .max_edge_length = std::numeric_limits<double>::infinity(),
                 .max_area = 3,
                 .min_edge_length = 4,
                 .proximity = 5,
                 .gradation = 6,
                 .max_faces = 7,
                 .split_boundaries = false};
  basis.unrefined = {{FaceId(0), FaceId(9)}, {UnrefinedReason::kSizeFloor, UnrefinedReason::kOutputRounding}, {1, 0}};
  basis.intersections = {{{PatchId(0), PatchId(1)}, {PatchId(4), PatchId(4)}}, false};
  basis.patch_labels = {{1, 0}, {0, 1, 3}, {0, 0, 1}};
  kept.result.mesh.positions.items() = {{-0.0, std::numeric_limits<double>::denorm_min(), 1e308}, {0.1, 0.2, 0.3}, {}};
  kept.result.mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  kept.result.mesh.labels.group.names = {"a", ""};
  kept.result.mesh.labels.group.of_face.push_back(1);
  kept.result.mesh.labels.material_libraries = {"x.mtl"};
  kept.result.mesh.faces.push_back({VertexId(2), VertexId(0xfffffffeu), VertexId(1)});
  kept.result.face_patch.push_back(PatchId(7));
  for (const std::uint32_t id : {0u, 0u, 70000u, 1u}) kept.result.report.surfaces.of_patch.push_back(SurfaceId(id));
  for (const std::uint32_t id : {0xffffffffu, 0u, 0x80000000u, 0x7fffffffu, 63u, 64u, 127u, 128u})
    kept.result.face_source.push_back(FaceId(id));
  kept.result.input_face_patch.push_back(PatchId(3));
  kept.result.report.input_up_axis = "y";
  const KeptResult back = unpack_result(pack_result(kept));
  EXPECT_EQ(back.format, kept.format);
  EXPECT_EQ(back.summary, kept.summary);
  EXPECT_EQ(back.local_origin, kept.local_origin);
  EXPECT_EQ(back.writing, kept.writing);
  EXPECT_EQ(back.exact_report, kept.exact_report);
  EXPECT_EQ(back.result.rounding_input.normals, basis.normals);
  EXPECT_EQ(back.result.rounding_input.allowed_move, basis.allowed_move);
  EXPECT_EQ(back.result.rounding_input.is_refined, basis.is_refined);
  const auto numbers = [](const Goals& g) {
    return std::tuple(g.min_angle_deg, g.max_edge_length, g.max_area, g.min_edge_length, g.proximity, g.gradation,
                      g.max_faces, g.split_boundaries);
  };
  EXPECT_EQ(numbers(back.result.rounding_input.goals), numbers(basis.goals));
  EXPECT_EQ(back.result.rounding_input.unrefined.faces, basis.unrefined.faces);
  EXPECT_EQ(back.result.rounding_input.patch_labels, basis.patch_labels);
  EXPECT_EQ(back.result.rounding_input.unrefined.reasons, basis.unrefined.reasons);
  EXPECT_EQ(back.result.rounding_input.unrefined.misses_sizes, basis.unrefined.misses_sizes);
  EXPECT_EQ(back.result.rounding_input.intersections.patches, basis.intersections.patches);
  EXPECT_EQ(back.result.rounding_input.intersections.is_complete, basis.intersections.is_complete);
  EXPECT_EQ(back.result.mesh.positions, kept.result.mesh.positions);
  EXPECT_TRUE(std::signbit(back.result.mesh.positions[VertexId(0)].x));
  EXPECT_EQ(back.result.mesh.faces, kept.result.mesh.faces);
  EXPECT_EQ(back.result.mesh.labels, kept.result.mesh.labels);
  EXPECT_EQ(back.result.face_patch, kept.result.face_patch);
  EXPECT_EQ(back.result.report.surfaces.of_patch, kept.result.report.surfaces.of_patch);
  EXPECT_EQ(back.result.face_source, kept.result.face_source);
  EXPECT_EQ(back.result.input_face_patch, kept.result.input_face_patch);
  EXPECT_EQ(back.result.report.input_up_axis, "y");
}

TEST(result_archive, results_that_older_versions_have_kept_are_read) {
  KeptResult kept;
  kept.writing.label = LabelChoice::kMaterial;
  kept.result.report.input_up_axis = "upwards";
  kept.result.face_patch.push_back(PatchId(7));
  kept.file_name = "part.obj";
  const std::string now = pack_result(kept);
  // Behind the magic come a text of three letters with its length, a number, and five choices.
  constexpr std::size_t kNumber = 8, kChoices = 8 + kNumber + 3 + kNumber;
  ASSERT_EQ(kept.format, Format::kObj);

  std::string seventh = now;
  seventh[7] = '7';
  seventh.erase(kChoices + 4 * kNumber, kNumber);
  EXPECT_EQ(unpack_result(seventh).writing, kept.writing);
  EXPECT_EQ(unpack_result(seventh).result.report.input_up_axis, "upwards");

  std::string sixth = now;
  sixth[7] = '6';
  sixth.erase(sixth.find("upwards") - kNumber, kNumber + std::string_view("upwards").size());
  sixth.erase(kChoices, 5 * kNumber);
  const KeptResult back = unpack_result(sixth);
  EXPECT_EQ(back.writing, Writing());
  EXPECT_EQ(back.result.face_patch, kept.result.face_patch);
  EXPECT_EQ(back.file_name, "part.obj");

  for (const char other : {'5', '9', 'x'}) {
    std::string unknown = now;
    unknown[7] = other;
    EXPECT_THROW(unpack_result(unknown), Error) << other;
  }
}

TEST(result_archive, damaged_bytes_are_refused) {
  const std::string good = pack_result({});
  EXPECT_NO_THROW(unpack_result(good));
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_THROW(unpack_result(good.substr(0, length)), Error) << length;
  EXPECT_THROW(unpack_result(good + "x"), Error);
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = '\xff';  // a magic that is none, a length that is beyond the end, or another number
    try {
      unpack_result(bad);
      EXPECT_GE(at, 8u) << "the magic";
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kInternal) << at;
    }
  }
}

TEST(result_archive, a_request_is_checked_before_its_mesh_is_read) {
  EXPECT_NO_THROW(check_remesh(request("not looked at"), {}));
  const auto code = [](const Request& asked) {
    try {
      check_remesh(asked, {});
    } catch (const Error& error) {
      return std::string(error_name(error));
    }
    return std::string();
  };
  EXPECT_EQ(code(request("", {{"refin", "true"}})), "unknown_option");
  EXPECT_EQ(code(request("", {{"max_area", "-1"}})), "invalid_option");
  EXPECT_EQ(code(request("", {{"max_output_faces", std::to_string(Limits{}.max_output_faces + 1)}})), "invalid_option");
  EXPECT_EQ(code(request("", {}, "image/png")), "not_acceptable");
  Request written_only = request("");
  written_only.content_type = "application/x-tetgen";
  EXPECT_EQ(code(written_only), "unsupported_media_type");
  Request coded = request("");
  coded.content_encoding = "br";
  EXPECT_EQ(code(coded), "unsupported_media_type");
  coded.content_encoding = "gzip";
  EXPECT_EQ(code(coded), "") << "it is decompressed where it is read";
}

TEST(result_archive, json_is_checked_for_its_form_and_its_options_before_it_is_worked_on) {
  const auto code = [](std::string_view body, const std::string& content_type = "application/json") {
    Request asked = request(body);
    asked.content_type = content_type;
    try {
      if (!check_remesh(asked, {})) return std::string("no JSON");
      RunControl control;
      check_json(asked, {}, control);
    } catch (const Error& error) {
      return std::string(error_name(error));
    }
    return std::string();
  };
  const std::string mesh = R"({"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]})";
  EXPECT_EQ(code(mesh), "");
  EXPECT_EQ(code(mesh, ""), "") << "found by its content";
  EXPECT_EQ(code(R"({"mesh": )" + mesh + R"(, "options": {"max_area": 1}})"), "");
  EXPECT_EQ(code(R"({"mesh": )" + mesh + R"(, "options": {"refin": 1}})"), "unknown_option");
  EXPECT_EQ(code(R"({"options": {"max_area": -1}, "mesh": )" + mesh + "}"), "invalid_option");
  EXPECT_EQ(code(R"({"mesh": )" + mesh + R"(, "options": {"format": "dwg"}})"), "invalid_option");
  for (std::size_t length = 1; length < mesh.size(); ++length)
    EXPECT_EQ(code(mesh.substr(0, length)), "malformed_json") << length;
  EXPECT_EQ(code(R"({"vertices": [[0,0,0]], "faces": [[0,1,2]]})"), "") << "an error of the mesh is for the job";
  EXPECT_EQ(code("v 0 0 0", "model/obj"), "no JSON");
}

}  // namespace
}  // namespace remesh::api
