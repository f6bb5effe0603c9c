#include "api/report_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace remesh::api {
namespace {

using nlohmann::json;

json written(const Report& report, ReportKind kind = ReportKind::kRemesh) {
  JsonWriter writer;
  RunControl control;
  write_report(writer, report, {}, kind, {}, control);
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
  const char* names[] = {"input_angle", "across_input_angle", "size_floor", "min_edge_length",
                         "budget",      "boundary_locked",    "effort",     "output_rounding"};
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
  report.plane_tolerance = 0.25;
  const json options = written(report)["options"];
  EXPECT_EQ(options["refine"], true);
  EXPECT_EQ(options["min_angle_deg"], 25);
  EXPECT_TRUE(options["max_radius_edge_ratio"].is_null());
  EXPECT_EQ(options["gradation"], 1.5);
  EXPECT_EQ(options["plane_tolerance"], 0.25);
}

}  // namespace
}  // namespace remesh::api
