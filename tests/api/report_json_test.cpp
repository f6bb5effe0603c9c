#include "api/report_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

namespace remesh::api {
namespace {

using nlohmann::json;

json written(const Report& report, ReportKind kind = ReportKind::kRemesh, const RequestOptions& options = {}) {
  JsonWriter writer;
  RunControl control;
  write_report(writer, report, options, kind, {}, control);
  return json::parse(writer.take());
}

TEST(report_json, what_is_unrefined_has_its_reason_its_count_and_its_places) {
  Unrefined corner{UnrefinedReason::kInputAngle, 0, {}};
  corner.add({1, 2, 3});
  corner.add({0.5, -0.25, 1e-9});
  Unrefined many{UnrefinedReason::kBudget, 0, {}};
  for (int i = 0; i < 250; ++i) many.add({double(i), 0, 0});
  Report report;
  report.unrefined = {corner, many};

  const json unrefined = written(report)["unrefined"];
  ASSERT_EQ(unrefined.size(), 2u);
  EXPECT_EQ(unrefined[0], (json{{"reason", "input_angle"}, {"count", 2}, {"places", {{1, 2, 3}, {0.5, -0.25, 1e-9}}}}));
  EXPECT_EQ(unrefined[1]["reason"], "budget");
  EXPECT_EQ(unrefined[1]["count"], 250);
  EXPECT_EQ(unrefined[1]["places"].size(), 100u);
}

TEST(report_json, every_reason_has_its_name_of_the_contract) {
  const char* names[] = {"input_angle",      "across_input_angle", "size_floor", "min_edge_length",
                         "budget",           "boundary_locked",    "effort",     "output_rounding",
                         "surface_tolerance"};
  Report report;
  for (int reason = 0; reason < kUnrefinedReasonCount; ++reason)
    report.unrefined.push_back({static_cast<UnrefinedReason>(reason), 1, {{0, 0, 0}}});
  const json unrefined = written(report)["unrefined"];
  ASSERT_EQ(unrefined.size(), std::size(names));
  for (std::size_t i = 0; i < unrefined.size(); ++i) EXPECT_EQ(unrefined[i]["reason"], names[i]);
}

TEST(report_json, the_verdict_on_quality_is_null_without_refinement) {
  Report report;
  EXPECT_TRUE(written(report)["verified"]["quality"].is_null());
  report.verified.quality = true;
  EXPECT_EQ(written(report)["verified"]["quality"], true);
  report.verified.quality = false;
  EXPECT_EQ(written(report)["verified"]["quality"], false);
}

TEST(report_json, the_smallest_gap_is_null_where_there_is_none) {
  Report report;
  for (const ReportKind kind : {ReportKind::kRemesh, ReportKind::kAnalysis}) {
    report.smallest_gap.reset();
    EXPECT_TRUE(written(report, kind)["smallest_gap"].is_null());
    report.smallest_gap = 0.125;
    EXPECT_EQ(written(report, kind)["smallest_gap"], 0.125);
  }
}

TEST(report_json, options_are_shown_as_they_were_used) {
  Report report;
  report.options.refine = true;
  report.options.proximity = 1;
  report.plane_tolerance = report.first_plane_tolerance = 0.25;
  const json options = written(report)["options"];
  EXPECT_EQ(options["refine"], true);
  EXPECT_EQ(options["min_angle_deg"], 25);
  EXPECT_TRUE(options["max_radius_edge_ratio"].is_null());
  EXPECT_EQ(options["gradation"], 1.5);
  EXPECT_EQ(options["plane_tolerance"], 0.25);
  EXPECT_TRUE(options["surface_tolerance"].is_null());
  EXPECT_TRUE(options["preset"].is_null());
}

TEST(report_json, a_preset_is_shown_with_the_values_that_were_in_force) {
  OptionReader reader;
  reader.add("preset", "exact");
  reader.add("split_boundaries", "true");
  reader.add("elements_per_circle", "16");
  reader.add("surface_tolerance_fraction", "0.001");
  Report report;
  report.options = reader.options().core;
  const json options = written(report, ReportKind::kRemesh, reader.options())["options"];
  EXPECT_EQ(options["preset"], "exact");
  EXPECT_EQ(options["feature_angle_deg"], 0);
  EXPECT_EQ(options["split_boundaries"], true);
  EXPECT_EQ(options["elements_per_circle"], 16);
  EXPECT_EQ(options["surface_tolerance_fraction"], 0.001);
}

TEST(report_json, the_distance_bound_is_told_both_ways_and_is_null_where_nothing_is_proven) {
  Report report;
  report.distance_bound = DistanceBound{0.25, 0.125};
  EXPECT_EQ(written(report)["distance_bound"], (json{{"output_to_input", 0.25}, {"input_to_output", 0.125}}));
  report.distance_bound.reset();
  const json analysis = written(report, ReportKind::kAnalysis);
  ASSERT_TRUE(analysis.contains("distance_bound"));
  EXPECT_TRUE(analysis["distance_bound"].is_null());
}

TEST(report_json, an_analysis_predicts_faces_by_elements_per_circle_in_their_order) {
  Report report;
  const char* const name = "predicted_faces_by_elements_per_circle";
  ASSERT_TRUE(written(report, ReportKind::kAnalysis).contains(name));
  EXPECT_TRUE(written(report, ReportKind::kAnalysis)[name].is_null()) << "nothing is curved";
  report.predicted_faces_by_elements_per_circle = {{8, 120}, {12, 150}, {16, 200}, {24, 280}, {36, 400}};
  EXPECT_FALSE(written(report).contains(name)) << "a remeshing predicts nothing";
  EXPECT_EQ(written(report, ReportKind::kAnalysis)[name],
            (json{{"8", 120}, {"12", 150}, {"16", 200}, {"24", 280}, {"36", 400}}));
  JsonWriter writer;
  RunControl control;
  write_report(writer, report, {}, ReportKind::kAnalysis, {}, control);
  const std::string text = writer.take();
  EXPECT_NE(text.find(R"({"8":120,"12":150,"16":200,"24":280,"36":400})"), std::string::npos) << "8 before 12";
}

/// A report with one surface of each kind. Each has two patches.
Report report_of_all_kinds() {
  Report report;
  for (const SurfaceKind kind : {SurfaceKind::kPlane, SurfaceKind::kCylinder, SurfaceKind::kCone, SurfaceKind::kSphere,
                                 SurfaceKind::kTorus, SurfaceKind::kRevolution, SurfaceKind::kFree}) {
    RecognisedSurface surface;
    surface.shape = {kind, {1, 2, 3}, {0, 0, -1}, 5, 0.5, std::numbers::pi / 4};
    if (kind == SurfaceKind::kRevolution) surface.profile = {{1, 0}, {2, 0.5}};
    surface.patches = 2;
    surface.faces = 4;
    surface.area = 1.5;
    surface.input_chord_height = 0.125;
    surface.input_turn_deg = 10;
    surface.facets_per_turn = 36;
    surface.is_remeshed = true;
    if (kind != SurfaceKind::kCone) surface.elements_per_circle = 24;
    surface.sweep_deg = 90;
    surface.tolerance = 1e-9;
    surface.deviation = 1e-10;
    surface.allowed = 0.0625;
    if (kind == SurfaceKind::kCone) surface.outside = 0.0078125;
    surface.bound = 0.03125;
    surface.side = SurfaceSide::kConcave;
    surface.extent = {{0, 0, 0}, {1, 2, 4}};
    surface.reason = FreeReason::kNoKindFits;
    const SurfaceId id = report.surfaces.surfaces.push_back(surface);
    for (int patch = 0; patch < 2; ++patch) {
      report.surfaces.of_patch.push_back(id);
      report.patches.emplace_back().bound = 0.015625 * (patch + 1);
    }
  }
  return report;
}

TEST(report_json, a_surface_has_the_members_of_its_kind) {
  const Report report = report_of_all_kinds();
  const json point = {1, 2, 3}, axis = {0, 0, -1}, box = {{"min", {0, 0, 0}}, {"max", {1, 2, 4}}};
  json all{{"patches", 2}, {"faces", 4}, {"area", 1.5}, {"bounding_box", box}};
  all["bound"] = 0.03125;
  json fitted = all;
  fitted.update(json{{"point", point}, {"fit_tolerance", 1e-9}, {"fit_deviation", 1e-10}});
  json curved = fitted;
  curved.update(json{{"side", "concave"},
                     {"sweep_deg", 90},
                     {"input_chord_height", 0.125},
                     {"input_turn_deg", 10},
                     {"facets_per_turn", 36},
                     {"remeshed", true},
                     {"elements_per_circle", 24},
                     {"tolerance", 0.0625},
                     {"volume_offset", nullptr}});
  const auto with = [](json members, const json& more) {
    members.update(more);
    return members;
  };
  const json expected{
      with(fitted, {{"id", 0}, {"kind", "plane"}, {"normal", axis}, {"offset", -3}}),
      with(curved, {{"id", 1}, {"kind", "cylinder"}, {"axis", axis}, {"radius", 5}}),
      with(curved, {{"id", 2},
                    {"kind", "cone"},
                    {"axis", axis},
                    {"half_angle_deg", 45},
                    {"volume_offset", 0.0078125},
                    {"elements_per_circle", nullptr}}),
      with(curved, {{"id", 3}, {"kind", "sphere"}, {"radius", 5}}),
      with(curved, {{"id", 4}, {"kind", "torus"}, {"axis", axis}, {"major_radius", 5}, {"minor_radius", 0.5}}),
      with(curved, {{"id", 5}, {"kind", "revolution"}, {"axis", axis}, {"profile", {{1, 0}, {2, 0.5}}}}),
      with(all, {{"id", 6},
                 {"kind", "free"},
                 {"reason", "no_kind_fits"},
                 {"nearest_kind", nullptr},
                 {"nearest_deviation", nullptr}})};
  EXPECT_EQ(written(report)["surfaces"], expected);
  json unproven = expected;
  for (json& surface : unproven) surface["bound"] = nullptr;
  EXPECT_EQ(written(report, ReportKind::kAnalysis)["surfaces"], unproven);
}

TEST(report_json, a_free_region_has_its_reason_and_the_nearest_kind) {
  Report report;
  RecognisedSurface region;
  region.reason = FreeReason::kNoKindFits;
  region.nearest_kind = SurfaceKind::kTorus;
  region.nearest_deviation = 1.1e-4;
  report.surfaces.surfaces.push_back(region);
  region.reason = FreeReason::kFewFacets;
  report.surfaces.surfaces.push_back(region);
  region.reason = FreeReason::kUnevenFacets;
  report.surfaces.surfaces.push_back(region);
  const json surfaces = written(report)["surfaces"];
  EXPECT_EQ(surfaces[0]["reason"], "no_kind_fits");
  EXPECT_EQ(surfaces[0]["nearest_kind"], "torus");
  EXPECT_EQ(surfaces[0]["nearest_deviation"], 1.1e-4);
  EXPECT_EQ(surfaces[1]["reason"], "few_facets");
  EXPECT_EQ(surfaces[2]["reason"], "uneven_facets");
}

TEST(report_json, a_patch_names_its_surface_and_the_kind_of_it) {
  const json patches = written(report_of_all_kinds())["patches"];
  ASSERT_EQ(patches.size(), 14u);
  EXPECT_EQ(patches[0]["kind"], "plane");
  EXPECT_EQ(patches[0]["surface"], 0);
  EXPECT_EQ(patches[9]["kind"], "torus");
  EXPECT_EQ(patches[9]["surface"], 4);
  EXPECT_EQ(patches[13]["kind"], "free");
  EXPECT_EQ(patches[13]["surface"], 6);
}

TEST(report_json, a_patch_has_its_proven_bound_and_none_in_an_analysis) {
  const Report report = report_of_all_kinds();
  const json patches = written(report)["patches"], analysed = written(report, ReportKind::kAnalysis)["patches"];
  EXPECT_EQ(patches[0]["bound"], 0.015625);
  EXPECT_EQ(patches[1]["bound"], 0.03125);
  ASSERT_TRUE(analysed[1].contains("bound"));
  EXPECT_TRUE(analysed[1]["bound"].is_null());
}

}  // namespace
}  // namespace remesh::api
