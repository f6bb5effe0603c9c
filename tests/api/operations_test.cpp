#include "api/operations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "api/negotiation.h"
#include "api/options.h"
#include "api/report_json.h"
#include "api/request_code.h"
#include "core/base/vec.h"
#include "core/io/gzip.h"
#include "tests/support/errors.h"

namespace remesh::api {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

// The listing in section 1.1 of J. Vermaak, The Surface Remeshing Module in ChiTech, 2018: a square ring.
constexpr std::string_view kRing = R"(# Blender v2.79 (sub 0) OBJ File: ''
o Plane_Plane.003
v -4.000000 -4.000000 1.000000
v 4.000000 -4.000000 1.000000
v -4.000000 4.000000 1.000000
v 4.000000 4.000000 1.000000
v -3.000000 -3.000000 1.000000
v 3.000000 -3.000000 1.000000
v -3.000000 3.000000 1.000000
v 3.000000 3.000000 1.000000
vn 0.0000 0.0000 1.0000
s off
f 5//1 3//1 1//1
f 4//1 7//1 8//1
f 1//1 2//1 6//1
f 5//1 7//1 3//1
f 1//1 6//1 5//1
f 6//1 2//1 4//1
f 4//1 3//1 7//1
f 8//1 6//1 4//1
)";

// A closed unit cube of quads.
constexpr std::string_view kCube = R"({"vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]],
"faces":[[3,2,1,0],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]})";

// A triangle with a corner of 10 degrees, and one of 30 and one of 140.
constexpr std::string_view kWedge = "v 0 0 0\nv 10 0 0\nv 7.9 1.393 0\nf 1 2 3\n";

Response remesh(const Request& request, const Limits& limits = {}) {
  RunControl control;
  return run_remesh(request, limits, control);
}

Request request_of(std::string_view body, std::string content_type = "", Fields query = {}, std::string accept = "") {
  return {body, std::move(content_type), "", std::move(accept), std::move(query)};
}

Code code_of(const Request& request, const Limits& limits = {}) {
  try {
    remesh(request, limits);
  } catch (const Error& error) {
    return error.code;
  }
  ADD_FAILURE() << "no error";
  return Code::kInternal;
}

std::string header(const Response& response, std::string_view name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

TEST(run_remesh, the_listing_of_the_specification_is_one_ring) {
  const Response response = remesh(request_of(kRing, "model/obj", {{"format", "json"}, {"refine", "false"}}));
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.content_type, "application/json");
  const json answer = json::parse(response.body);
  const json& report = answer["report"];
  ASSERT_EQ(report["patches"].size(), 1u);
  EXPECT_EQ(report["patches"][0]["loops"], 2);
  EXPECT_EQ(report["patches"][0]["essential_vertices"], 8);
  EXPECT_EQ(report["patches"][0]["status"], "remeshed");
  EXPECT_TRUE(report["patches"][0]["reason"].is_null());
  EXPECT_EQ(report["output"]["faces"], 8);
  EXPECT_EQ(report["output"]["area"], 28.0);
  EXPECT_EQ(report["output"]["euler"], 0);
  EXPECT_TRUE(report["output"]["volume"].is_null());
  EXPECT_EQ(report["verified"]["surface"], true);
  EXPECT_EQ(report["verified"]["conforming"], true);
  EXPECT_EQ(report["verified"]["delaunay"], true);
  EXPECT_TRUE(report["verified"]["quality"].is_null());
  EXPECT_EQ(answer["mesh"]["faces"].size(), 8u);
  EXPECT_EQ(answer["mesh"]["face_patch"].size(), 8u);
  EXPECT_EQ(answer["mesh"]["face_source"].size(), 8u);
  EXPECT_EQ(answer["mesh"]["input_face_patch"], json::array({0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(answer["mesh"]["labels"]["object"]["names"], json({"Plane_Plane.003"}));
}

/// Returns a form with a mesh as a file of this name. A quote in the name is escaped.
Request upload_of(std::string& form, std::string_view mesh, std::string_view file_name) {
  form = "--B\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"";
  form.append(file_name).append("\"\r\n\r\n").append(mesh).append("\r\n--B--\r\n");
  return request_of(form, "multipart/form-data; boundary=B", {{"refine", "false"}}, "*/*");
}

TEST(run_remesh, an_obj_comes_back_as_an_obj_with_its_summary) {
  std::string form;
  const Request request = upload_of(form, kRing, "/tmp/../my ring.OBJ");
  const Response response = remesh(request);
  EXPECT_EQ(response.content_type, "model/obj");
  EXPECT_THAT(header(response, "Remesh-Summary"),
              StartsWith("input_faces=8, output_faces=8, patches=1, kept=0, min_angle_deg="));
  EXPECT_THAT(header(response, "Remesh-Summary"), HasSubstr("verified=1, warnings="));
  EXPECT_THAT(header(response, "Server-Timing"), StartsWith("read;dur="));
  EXPECT_THAT(header(response, "Server-Timing"), HasSubstr("total;dur="));
  EXPECT_EQ(header(response, "Content-Disposition"), "attachment; filename=\"my_ring.obj\"");
  EXPECT_THAT(response.body, StartsWith("# remeshd "));
  EXPECT_THAT(response.body, HasSubstr("# " + header(response, "Remesh-Summary") + "\n"));
  EXPECT_EQ(remesh(request).body, response.body);
}

TEST(run_remesh, the_report_has_every_field_of_the_contract) {
  const json report = json::parse(remesh(request_of(kCube, "", {{"refine", "false"}})).body)["report"];
  const auto keys = [](const json& object) {
    std::set<std::string> names;
    for (const auto& [name, value] : object.items()) names.insert(name);
    return names;
  };
  EXPECT_EQ(keys(report),
            (std::set<std::string>{"version", "options", "tolerance", "input", "output", "patches", "surfaces",
                                   "distance_bound", "solids", "diagnostics", "renamed_labels", "recipe",
                                   "volume_ready", "smallest_gap", "largest_edge_for_target", "unrefined",
                                   "refinement_rounds", "verified", "timing_ms"}));
  for (const char* side : {"input", "output"}) {
    std::set<std::string> expected{"vertices",     "faces",  "components", "boundary_edges", "non_manifold_edges",
                                   "closed",       "euler",  "area",       "volume",         "intersecting_pairs",
                                   "bounding_box", "quality"};
    if (side == std::string("output")) expected.insert({"rounding", "origin"});
    if (side == std::string("input")) expected.insert("mended_euler");
    EXPECT_EQ(keys(report[side]), expected);
    EXPECT_EQ(keys(report[side]["quality"]),
              (std::set<std::string>{"min_angle_deg", "max_angle_deg", "radius_edge_ratio", "aspect_ratio",
                                     "edge_length", "area", "angle_histogram_deg", "radius_edge_histogram"}));
    EXPECT_EQ(report[side]["bounding_box"], (json{{"min", {0, 0, 0}}, {"max", {1, 1, 1}}}));
    EXPECT_EQ(report[side]["closed"], true);
    EXPECT_DOUBLE_EQ(report[side]["volume"].get<double>(), 1);
  }
  EXPECT_EQ(keys(report["patches"][0]),
            (std::set<std::string>{"id", "kind", "surface", "normal", "offset", "area", "input_faces", "output_faces",
                                   "loops", "essential_vertices", "status", "reason", "deviation", "bound"}));
  EXPECT_EQ(report["patches"].size(), 6u);
  EXPECT_EQ(report["output"]["faces"], 12);
  EXPECT_EQ(report["volume_ready"], (json{{"ready", true}, {"reasons", json::array()}}));
  std::set<std::string> options;
  for (const OptionSpec& spec : option_table()) options.insert(std::string(spec.name));
  EXPECT_EQ(keys(report["options"]), options);
  EXPECT_GT(report["options"]["plane_tolerance"].get<double>(), 0);
  EXPECT_TRUE(report["timing_ms"].contains("read"));
  EXPECT_TRUE(report["timing_ms"].contains("total"));
}

// The angles of a triangle of an answer's mesh, in degrees, by the law of cosines.
std::array<double, 3> angles_deg(const json& mesh, const json& face) {
  std::array<Vec3, 3> p;
  for (std::size_t i = 0; i < 3; ++i) {
    const json& v = mesh["vertices"][face[i].get<std::size_t>()];
    p[i] = {v[0], v[1], v[2]};
  }
  std::array<double, 3> angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = norm(p[(i + 2) % 3] - p[(i + 1) % 3]);
    const double b = norm(p[(i + 1) % 3] - p[i]);
    const double c = norm(p[(i + 2) % 3] - p[i]);
    angles[i] = std::acos((b * b + c * c - a * a) / (2 * b * c)) * 180 / std::numbers::pi;
  }
  return angles;
}

std::size_t count_below(const json& mesh, double degrees) {
  const json& faces = mesh["faces"];
  return static_cast<std::size_t>(std::count_if(faces.begin(), faces.end(), [&](const json& face) {
    const auto angles = angles_deg(mesh, face);
    return *std::min_element(angles.begin(), angles.end()) < degrees;
  }));
}

TEST(run_remesh, refinement_is_on_at_25_degrees_unless_it_is_turned_off) {
  const json answer = json::parse(remesh(request_of(kRing, "", {{"format", "json"}})).body);
  const json& report = answer["report"];
  EXPECT_EQ(report["options"]["refine"], true);
  EXPECT_EQ(report["options"]["min_angle_deg"], 25);
  EXPECT_TRUE(report["options"]["gradation"].is_null());
  EXPECT_EQ(report["verified"]["quality"], true);
  EXPECT_EQ(report["unrefined"], json::array());
  EXPECT_NEAR(report["output"]["area"].get<double>(), 28, 1e-11);
  EXPECT_EQ(count_below(answer["mesh"], 25), 0u);
  EXPECT_GE(report["output"]["quality"]["min_angle_deg"].get<double>(), 25);
}

TEST(run_remesh, the_sizes_asked_for_hold) {
  const Fields query{{"max_edge_length", "0.1"}, {"min_angle_deg", "30"}};
  const json answer = json::parse(remesh(request_of(kCube, "", query)).body);
  const json& output = answer["report"]["output"];
  EXPECT_EQ(answer["report"]["verified"]["quality"], true);
  EXPECT_LE(output["quality"]["edge_length"]["max"].get<double>(), 0.1 * (1 + 1e-11));
  EXPECT_EQ(count_below(answer["mesh"], 30), 0u);
  EXPECT_EQ(output["closed"], true);
  EXPECT_NEAR(output["volume"].get<double>(), 1, 1e-12);

  const Fields by_area{{"max_area", "0.01"}};
  EXPECT_LE(json::parse(remesh(request_of(kCube, "", by_area)).body)["report"]["output"]["quality"]["area"]["max"]
                .get<double>(),
            0.01);
  const Fields by_fraction{{"max_edge_fraction", "0.1"}};
  EXPECT_LE(
      json::parse(remesh(request_of(kCube, "", by_fraction)).body)["report"]["output"]["quality"]["edge_length"]["max"]
          .get<double>(),
      0.1 * std::sqrt(3.0) * (1 + 1e-11));
}

TEST(run_remesh, what_misses_the_bound_is_listed_with_reason_and_place) {
  const json answer = json::parse(remesh(request_of(kWedge, "", {{"format", "json"}})).body);
  const json& unrefined = answer["report"]["unrefined"];
  EXPECT_EQ(answer["report"]["verified"]["quality"], true);
  std::size_t listed = 0;
  for (const json& entry : unrefined) {
    EXPECT_THAT(entry["reason"].get<std::string>(), testing::AnyOf("input_angle", "across_input_angle"));
    EXPECT_EQ(entry["places"].size(), std::min(entry["count"].get<std::size_t>(), std::size_t{100}));
    listed += entry["count"].get<std::size_t>();
    for (const json& place : entry["places"]) {
      EXPECT_GT(place[0].get<double>(), 0);
      EXPECT_LT(place[0].get<double>(), 10);
      EXPECT_EQ(place[2].get<double>(), 0);
    }
  }
  EXPECT_GT(listed, 0u);
  EXPECT_EQ(listed, count_below(answer["mesh"], 25));
}

TEST(run_remesh, a_mesh_format_tells_what_misses_the_bound_in_its_comments) {
  const Response response = remesh(request_of(kWedge));
  EXPECT_THAT(response.body, HasSubstr("\n# unrefined: input_angle: 1\n"));
  EXPECT_THAT(header(response, "Remesh-Summary"), StartsWith("input_faces=1, output_faces="));
  EXPECT_THAT(header(response, "Remesh-Summary"), HasSubstr(", patches=1, kept=0, min_angle_deg="));
  EXPECT_THAT(header(response, "Remesh-Summary"), HasSubstr("verified=1, warnings="));
}

TEST(run_remesh, a_thin_plate_is_meshed_as_fine_as_it_is_thin) {
  const std::string plate =
      R"({"vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,0.1],[1,0,0.1],[1,1,0.1],[0,1,0.1]],
          "faces":[[3,2,1,0],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]})";
  const json report = json::parse(remesh(request_of(plate, "", {{"proximity", "1"}})).body)["report"];
  EXPECT_NEAR(report["smallest_gap"].get<double>(), 0.1, 1e-12);
  EXPECT_EQ(report["options"]["proximity"], 1);
  EXPECT_EQ(report["options"]["gradation"], 1.5);
  const json plain = json::parse(remesh(request_of(plate)).body)["report"];
  EXPECT_TRUE(plain["smallest_gap"].is_null());
  EXPECT_TRUE(plain["options"]["gradation"].is_null());
  EXPECT_GT(report["output"]["faces"], plain["output"]["faces"]);
  RunControl control;
  const json analysis = json::parse(run_analyze(request_of(plate), {}, control).body)["report"];
  EXPECT_NEAR(analysis["smallest_gap"].get<double>(), 0.1, 1e-12);
}

TEST(run_remesh, a_result_that_must_be_too_large_is_refused_before_the_work) {
  try {
    // Six unit squares in triangles of at most 4.4e-9: over a thousand million of them.
    remesh(request_of(kCube, "", {{"max_edge_length", "0.0001"}, {"max_output_faces", "1000"}}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kOutputTooLarge);
    EXPECT_EQ(error.option, "max_output_faces");
    EXPECT_EQ(error.limit, 1000u);
  }
}

TEST(run_remesh, boundaries_are_not_split_where_they_must_not_be) {
  const Fields query{{"format", "json"}, {"split_boundaries", "false"}, {"max_edge_length", "1"}};
  const json answer = json::parse(remesh(request_of(kRing, "", query)).body);
  EXPECT_EQ(answer["report"]["output"]["boundary_edges"], 8);
  EXPECT_EQ(answer["report"]["verified"]["quality"], true);
  ASSERT_FALSE(answer["report"]["unrefined"].empty());
  EXPECT_EQ(answer["report"]["unrefined"][0]["reason"], "boundary_locked");
}

TEST(run_remesh, an_open_surface_is_not_ready_for_a_volume_mesher) {
  const json ready = json::parse(
      remesh(request_of(kRing, "", {{"format", "json"}, {"refine", "false"}})).body)["report"]["volume_ready"];
  EXPECT_EQ(ready["ready"], false);
  ASSERT_EQ(ready["reasons"].size(), 1u);
  EXPECT_EQ(ready["reasons"][0]["code"], "open_boundary");
  EXPECT_EQ(ready["reasons"][0]["count"], 8);
  std::set<json> places(ready["reasons"][0]["places"].begin(), ready["reasons"][0]["places"].end());
  EXPECT_EQ(places, (std::set<json>{
                        {-4, 0, 1}, {4, 0, 1}, {0, -4, 1}, {0, 4, 1}, {-3, 0, 1}, {3, 0, 1}, {0, -3, 1}, {0, 3, 1}}));
}

TEST(run_remesh, the_options_of_a_report_can_be_sent_again) {
  // A thin plate with one short edge: all that sizes can depend on.
  const std::string plate =
      R"({"vertices":[[0,0,0],[4,0,0],[4,3.9,0],[3.9,4,0],[0,4,0],[0,0,0.5],[4,0,0.5],[4,3.9,0.5],[3.9,4,0.5],[0,4,0.5]],
          "faces":[[4,3,2,1,0],[5,6,7,8,9],[0,1,6,5],[1,2,7,6],[2,3,8,7],[3,4,9,8],[4,0,5,9]]})";
  for (const Fields& query :
       {Fields{}, Fields{{"refine", "false"}}, Fields{{"max_radius_edge_ratio", "1.1"}}, Fields{{"proximity", "1"}},
        Fields{{"proximity", "1"}, {"gradation", "1.5"}}, Fields{{"max_edge_fraction", "0.2"}}}) {
    const json first = json::parse(remesh(request_of(plate, "", query)).body);
    const json again{{"mesh", json::parse(plate)}, {"options", first["report"]["options"]}};
    const json second = json::parse(remesh(request_of(again.dump())).body);
    EXPECT_EQ(second["report"]["options"], first["report"]["options"]);
    EXPECT_EQ(second["mesh"], first["mesh"]);
  }
}

TEST(run_remesh, an_answer_can_be_sent_again) {
  const Fields query{{"refine", "false"}};
  const Response first = remesh(request_of(kCube, "", query));
  const json second = json::parse(remesh(request_of(first.body, "", query)).body);
  EXPECT_EQ(second["mesh"]["vertices"], json::parse(first.body)["mesh"]["vertices"]);
  EXPECT_EQ(second["report"]["diagnostics"][0]["code"], "attribute_dropped");
}

TEST(run_remesh, groups_given_as_numbers_come_back_as_numbers) {
  const json request{{"vertices", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}}},
                     {"faces", {{0, 1, 4, 5}, {1, 2, 3, 4}}},
                     {"face_groups", {40, -2}}};
  const json mesh = json::parse(remesh(request_of(request.dump(), "", {{"refine", "false"}})).body)["mesh"];
  ASSERT_EQ(mesh["faces"].size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_EQ(mesh["face_groups"][f], mesh["face_source"][f] == 0 ? 40 : -2);
  }
  EXPECT_FALSE(mesh.contains("labels"));
}

TEST(run_remesh, a_form_takes_a_mesh_and_options) {
  const std::string form =
      "--B\r\nContent-Disposition: form-data; name=\"options\"\r\nContent-Type: "
      "application/json\r\n\r\n{\"format\":\"json\"}\r\n"
      "--B\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"part.obj\"\r\nContent-Type: "
      "application/octet-stream\r\n\r\n" +
      std::string(kRing) + "\r\n--B--\r\n";
  const std::string type = "multipart/form-data; boundary=B";
  EXPECT_EQ(remesh(request_of(form, type)).content_type, "application/json");
  EXPECT_EQ(code_of(request_of(form, type, {{"format", "obj"}})), Code::kInvalidOption);
  EXPECT_EQ(code_of(request_of("--B\r\nContent-Disposition: form-data; name=\"refine\"\r\n\r\ntrue\r\n--B--", type)),
            RequestCode::kMalformedMultipart);
  EXPECT_EQ(code_of(request_of("--B\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{}\r\n--B--", type)),
            RequestCode::kMalformedMultipart);
}

TEST(run_remesh, a_part_without_a_file_name_is_an_option_and_does_what_it_does_in_a_query) {
  const auto form_of = [](const std::string& parts) {
    return "--B\r\nContent-Disposition: form-data; name=\"upload\"; filename=\"ring.obj\"\r\n\r\n" +
           std::string(kRing) + parts + "\r\n--B--";
  };
  const std::string type = "multipart/form-data; boundary=B";
  std::string parts;
  Fields query;
  for (const OptionSpec& spec : option_table()) {
    if (!spec.excludes.empty() || spec.name == "max_hole_edges" || spec.name == "max_output_faces") continue;
    query.emplace_back(spec.name, spec.example);
    parts += "\r\n--B\r\nContent-Disposition: form-data; name=\"" + std::string(spec.name) + "\"\r\n\r\n" +
             std::string(spec.example);
  }
  ASSERT_GT(query.size(), 15u);
  const auto options_of = [](const Response& response) { return json::parse(response.body)["report"]["options"]; };
  EXPECT_EQ(options_of(remesh(request_of(form_of(parts), type))), options_of(remesh(request_of(kRing, "", query))));
  // An option that is there twice is refused by its name, wherever the two stand.
  const std::string twice = "\r\n--B\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n{\"refine\": false}" +
                            std::string("\r\n--B\r\nContent-Disposition: form-data; name=\"refine\"\r\n\r\nfalse");
  const Error error = test::error_of([&] { remesh(request_of(form_of(twice), type)); });
  EXPECT_EQ(error.code, Code::kInvalidOption);
  EXPECT_EQ(error.option, "refine");
}

TEST(run_remesh, bad_input_has_its_code) {
  EXPECT_EQ(code_of(request_of("")), Code::kEmptyMesh);
  EXPECT_EQ(code_of(request_of("", "application/json")), RequestCode::kMalformedJson);
  EXPECT_EQ(code_of(request_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")), Code::kIndexOutOfRange);
  EXPECT_EQ(code_of(request_of("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), Code::kNonfiniteCoordinate);
  EXPECT_EQ(code_of(request_of(kRing, "model/stl")), Code::kInvalidMesh);
  EXPECT_EQ(code_of(request_of("ply\nformat ascii 1.0\n")), Code::kInvalidMesh);
  EXPECT_EQ(code_of(request_of(kRing, "application/x-tetgen")), Code::kUnsupportedMediaType);
  EXPECT_EQ(code_of(request_of(kRing, "", {}, "model/step")), Code::kNotAcceptable);
  EXPECT_EQ(code_of(request_of(kRing, "", {{"max_edge", "1"}})), RequestCode::kUnknownOption);
  EXPECT_EQ(code_of(request_of(kRing, "", {{"weld_tolerance", "-1"}})), Code::kInvalidOption);
}

TEST(run_remesh, a_mesh_that_floats_make_flat_is_no_stl_and_everything_else) {
  for (const std::string mesh :
       {"v 0 0 0\nv 1e-50 0 0\nv 0 1e-50 0\nf 1 2 3\n", "v 1e8 0 0\nv 100000001 0 0\nv 1e8 1 0\nf 1 2 3\n"}) {
    EXPECT_EQ(code_of(request_of(mesh, "", {{"format", "stl"}})), Code::kNotAcceptable) << mesh;
    EXPECT_EQ(remesh(request_of(mesh, "", {{"format", "ply"}})).status, 200) << mesh;
  }
}

TEST(run_remesh, a_repeated_corner_is_dropped_and_told_with_its_face) {
  const std::string mesh = "v 0 0 0\nv 2 0 0\nv 2 2 0\nf 1 1 2 3\n";
  const json report = json::parse(remesh(request_of(mesh, "", {{"format", "json"}})).body)["report"];
  const json& found = report["diagnostics"];
  const auto repeated =
      std::find_if(found.begin(), found.end(), [](const json& d) { return d["code"] == "duplicate_vertex"; });
  ASSERT_NE(repeated, found.end());
  EXPECT_EQ((*repeated)["elements"], json::array({0}));
}

TEST(run_remesh, options_are_refused_before_the_mesh_is_read) {
  EXPECT_EQ(code_of(request_of("no mesh at all", "", {{"weld_tolerance", "-1"}})), Code::kInvalidOption);
}

TEST(run_remesh, every_format_goes_out_and_what_is_read_comes_in_again_as_the_same_mesh) {
  const json as_json = json::parse(remesh(request_of(kCube, "", {{"format", "json"}})).body)["mesh"];
  for (const Format format : kFormats) {
    if (!is_written(format)) continue;
    SCOPED_TRACE(format_name(format));
    const Response response = remesh(request_of(kCube, "", {}, std::string(media_type(format))));
    EXPECT_EQ(response.content_type, media_type(format));
    if (format == Format::kJson) continue;
    EXPECT_THAT(header(response, "Content-Disposition"), HasSubstr("." + std::string(file_ending(format)) + "\""));
    if (!can_read(format)) continue;
    const Response again = remesh(request_of(response.body, "", {{"format", "json"}}));
    EXPECT_EQ(json::parse(again.body)["mesh"]["faces"].size(), as_json["faces"].size());
  }
}

TEST(run_remesh, a_compressed_body_and_a_compressed_mesh_are_what_is_in_them) {
  RunControl control;
  const std::string expected = remesh(request_of(kRing)).body;
  const std::string compressed = gzip(kRing, control);
  EXPECT_EQ(remesh(request_of(compressed)).body, expected);
  EXPECT_EQ(remesh(request_of(compressed, "model/obj")).body, expected);

  Request coded = request_of(compressed, "model/obj");
  for (const char* coding : {"gzip", "GZIP", "x-gzip"}) {
    coded.content_encoding = coding;
    EXPECT_EQ(remesh(coded).body, expected);
  }
  const std::string form = gzip(
      "--B\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a.obj.gz\"\r\n\r\n" + compressed + "\r\n--B--",
      control);
  Request coded_form = request_of(form, "multipart/form-data; boundary=B");
  coded_form.content_encoding = "gzip";
  const Response of_form = remesh(coded_form);
  EXPECT_EQ(of_form.body, expected);
  EXPECT_EQ(header(of_form, "Content-Disposition"), "attachment; filename=\"a.obj\"");
}

TEST(run_remesh, what_cannot_be_decompressed_has_its_code) {
  RunControl control;
  const std::string compressed = gzip(kRing, control);
  const auto with_coding = [&](std::string_view body, const char* coding) {
    Request request = request_of(body);
    request.content_encoding = coding;
    return request;
  };
  EXPECT_EQ(code_of(with_coding(kRing, "gzip")), RequestCode::kMalformedRequest);
  EXPECT_EQ(code_of(with_coding(std::string_view(compressed).substr(0, 30), "gzip")), RequestCode::kMalformedRequest);
  EXPECT_EQ(code_of(request_of(std::string_view(compressed).substr(0, 30))), Code::kInvalidMesh);
  EXPECT_EQ(code_of(with_coding(kRing, "br")), Code::kUnsupportedMediaType);

  Limits limits;
  limits.decompression.max_bytes = kRing.size() - 1;
  EXPECT_EQ(code_of(request_of(compressed), limits), Code::kDecompressedTooLarge);
  EXPECT_EQ(code_of(with_coding(compressed, "gzip"), limits), Code::kDecompressedTooLarge);
  limits.decompression.max_bytes = kRing.size();
  EXPECT_EQ(remesh(request_of(compressed), limits).status, 200);
}

TEST(run_remesh, a_bomb_within_a_bomb_has_the_ratio_once) {
  RunControl control;
  const std::string once = gzip(std::string(20'000'000, '#'), control);
  const std::string twice = gzip(once, control);
  ASSERT_LT(twice.size(), 1000u);
  Limits limits;
  limits.decompression.max_ratio = 2000;  // what each of the two keeps to
  Request request = request_of(twice, "model/obj");
  request.content_encoding = "gzip";
  EXPECT_EQ(code_of(request, limits), Code::kDecompressedTooLarge);
  request.body = once;
  EXPECT_EQ(code_of(request, limits), Code::kEmptyMesh) << "one alone is let in";
}

TEST(run_remesh, limits_hold) {
  Limits limits;
  limits.max_body = 10;
  EXPECT_EQ(code_of(request_of(kRing), limits), RequestCode::kBodyTooLarge);
  limits = {};
  limits.input.max_faces = 7;
  EXPECT_EQ(code_of(request_of(kRing), limits), Code::kMeshTooLarge);
  EXPECT_EQ(code_of(request_of(kCube, "", {{"max_output_faces", "50000001"}})), Code::kInvalidOption);
  limits = {};
  limits.max_output_faces = 11;
  EXPECT_EQ(code_of(request_of(kCube), limits), Code::kOutputTooLarge);
}

TEST(run_remesh, a_stopped_request_ends_at_once) {
  RunControl control;
  control.expire();
  try {
    run_remesh(request_of(kRing), {}, control);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kTimeout);
  }
}

TEST(run_remesh, an_upload_cannot_choose_an_unsafe_name) {
  const std::pair<std::string, std::string> names[] = {{"", "remeshed.obj"},
                                                       {"..", "remeshed.obj"},
                                                       {"C:\\parts\\a.stl", "a.obj"},
                                                       {"a.stl.gz", "a.obj"},
                                                       {"a\\\"; x=\ty.obj", "a___x__y.obj"},
                                                       {".hidden", "hidden.obj"},
                                                       {"part.v2", "part.v2.obj"},
                                                       {std::string(500, 'a'), std::string(100, 'a') + ".obj"}};
  for (const auto& [given, safe] : names) {
    std::string form;
    EXPECT_EQ(header(remesh(upload_of(form, kRing, given)), "Content-Disposition"),
              "attachment; filename=\"" + safe + "\"");
  }
  EXPECT_EQ(header(remesh(request_of(kRing)), "Content-Disposition"), "attachment; filename=\"remeshed.obj\"");
}

TEST(run_remesh, a_name_beyond_ascii_comes_back) {
  const std::pair<std::string, std::string> names[] = {
      {"Räder.stl", "attachment; filename=\"R_der.obj\"; filename*=UTF-8''R%C3%A4der.obj"},
      {"部品 1.obj", "attachment; filename=\"___1.obj\"; filename*=UTF-8''%E9%83%A8%E5%93%81_1.obj"},
      {"a\xff.obj", "attachment; filename=\"a_.obj\""},
      {"a\xe2\x80\xaejbo.exe", "attachment; filename=\"a_jbo.exe.obj\""}};
  for (const auto& [given, value] : names) {
    std::string form;
    EXPECT_EQ(header(remesh(upload_of(form, kRing, given)), "Content-Disposition"), value) << given;
  }
}

TEST(run_remesh, a_name_may_come_in_the_extended_form) {
  const std::string type = "multipart/form-data; boundary=B";
  const auto form = [](const std::string& parameter) {
    return "--B\r\nContent-Disposition: form-data; name=\"mesh\"; " + parameter + "\r\n\r\n" + std::string(kRing) +
           "\r\n--B--";
  };
  const std::string named = form("filename*=utf-8''R%c3%a4der.obj");
  EXPECT_THAT(header(remesh(request_of(named, type)), "Content-Disposition"), HasSubstr("R%C3%A4der.obj"));
  const std::string unknown = form("filename=\"a.obj\"; filename*=latin1''b.obj");
  EXPECT_EQ(header(remesh(request_of(unknown, type)), "Content-Disposition"), "attachment; filename=\"a.obj\"");
}

TEST(run_remesh, what_is_wrong_in_the_options_of_a_form_is_told_with_their_part) {
  const std::string type = "multipart/form-data; boundary=B";
  for (const char* options : {"{\"refine\": }", "{\"refine\": 1}", "{\"refin\": true}", "refine=true"}) {
    const std::string form = std::string("--B\r\nContent-Disposition: form-data; name=\"options\"\r\n\r\n") + options +
                             "\r\n--B\r\nContent-Disposition: form-data; name=\"mesh\"\r\n\r\n" + std::string(kRing) +
                             "\r\n--B--";
    const Error error = test::error_of([&] { remesh(request_of(form, type)); });
    EXPECT_THAT(error.what(), HasSubstr("in the part \"options\"")) << options;
  }
}

TEST(run_remesh, a_urlencoded_form_is_told_apart_from_a_mesh_of_that_type) {
  const std::string type = "application/x-www-form-urlencoded";
  EXPECT_EQ(remesh(request_of(kRing, type)).status, 200);
  for (const char* body : {"mesh=v+0+0+0&refine=false", "file%5B0%5D=x", "a.b=c"}) {
    const Error error = test::error_of([&] { remesh(request_of(body, type)); });
    EXPECT_EQ(error.code, Code::kUnsupportedMediaType) << body;
    EXPECT_THAT(error.what(), HasSubstr("urlencoded")) << body;
  }
}

TEST(run_analyze, an_analysis_is_a_report_without_an_output) {
  RunControl control;
  const Response response = run_analyze(request_of(kCube), {}, control);
  EXPECT_EQ(response.content_type, "application/json");
  const json answer = json::parse(response.body);
  EXPECT_EQ(answer["report"]["input"]["faces"], 6);
  EXPECT_EQ(answer["report"]["patches"].size(), 6u);
  EXPECT_TRUE(answer["report"].contains("predicted_faces"));
  EXPECT_FALSE(answer["report"].contains("output"));
  EXPECT_FALSE(answer["report"].contains("verified"));
  RunControl again;
  EXPECT_THROW(run_analyze(request_of(kCube, "", {{"format", "obj"}}), {}, again), Error);
}

TEST(openapi, the_report_schema_names_what_a_report_has) {
  const json document = json::parse(openapi().body);
  // A wedge: its corner of 10 degrees cannot reach the bound.
  const Response answer = remesh(request_of(kWedge, "", {{"format", "json"}, {"proximity", "1"}}));
  const json report = json::parse(answer.body)["report"];
  const json& schemas = document["components"]["schemas"];
  const auto expect_same_keys = [](const json& schema, const json& value) {
    for (const auto& [key, member] : value.items()) EXPECT_TRUE(schema["properties"].contains(key)) << key;
    for (const json& key : schema["required"]) EXPECT_TRUE(value.contains(key.get<std::string>())) << key;
  };
  expect_same_keys(schemas["Report"], report);
  json input = report["input"];
  for (const auto& [key, member] : schemas["InputStatistics"]["allOf"][1]["properties"].items()) {
    // Only some formats tell these two.
    EXPECT_EQ(input.contains(key), key != "unit" && key != "up_axis") << key;
    input.erase(key);
  }
  expect_same_keys(schemas["Statistics"], input);
  // The output has what the input has, and members of its own.
  json output = report["output"];
  for (const auto& [key, member] : schemas["OutputStatistics"]["allOf"][1]["properties"].items()) {
    EXPECT_EQ(output.count(key), 1u) << key;
    output.erase(key);
  }
  expect_same_keys(schemas["Statistics"], output);
  expect_same_keys(schemas["Quality"], report["output"]["quality"]);
  expect_same_keys(schemas["Patch"], report["patches"][0]);
  expect_same_keys(schemas["Surface"], report["surfaces"][0]);
  expect_same_keys(schemas["Verified"], report["verified"]);
  expect_same_keys(schemas["Tolerance"], report["tolerance"]);
  ASSERT_FALSE(report["unrefined"].empty());
  expect_same_keys(schemas["Unrefined"], report["unrefined"][0]);

  RunControl control;
  expect_same_keys(schemas["AnalysisReport"], json::parse(run_analyze(request_of(kCube), {}, control).body)["report"]);
  Report told;
  told.distance_bound = DistanceBound{1, 2};
  JsonWriter writer;
  write_report(writer, told, {}, ReportKind::kRemesh, {}, control);
  expect_same_keys(schemas["DistanceBound"], json::parse(writer.take())["distance_bound"]);
}

TEST(openapi, its_examples_are_answered) {
  const json document = json::parse(openapi().body);
  const json& content = document["components"]["requestBodies"]["Mesh"]["content"];
  EXPECT_EQ(remesh(request_of(content["model/obj"]["example"].get<std::string>(), "model/obj")).status, 200);
  const std::map<std::string, std::size_t> patches{
      {"bare", 1}, {"with_options", 2}, {"for_a_volume_mesher", 6}, {"for_a_size", 1}};
  const json& examples = content["application/json"]["examples"];
  EXPECT_EQ(examples.size(), patches.size());
  for (const auto& [name, count] : patches) {
    const json report = json::parse(remesh(request_of(examples[name]["value"].dump())).body)["report"];
    EXPECT_EQ(report["patches"].size(), count) << name;
    EXPECT_EQ(report["verified"]["quality"], true) << name;
  }
}

}  // namespace
}  // namespace remesh::api
