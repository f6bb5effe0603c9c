#include "api/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/io/gzip.h"
#include "tests/support/errors.h"

namespace remesh::api {
namespace {

using nlohmann::json;
using test::error_of;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

Job job_of(std::string_view mesh, const Fields& options = {}, std::string accept = "") {
  Job job;
  job.mesh = mesh;
  job.accept = std::move(accept);
  job.options.add("refine", "false");
  for (const auto& [name, value] : options) job.options.add(name, value);
  return job;
}

RemeshAnswer remesh(Job job, const Limits& limits = {}) {
  RunControl control;
  return run_remesh_job(std::move(job), limits, control);
}

TEST(remesh_job, the_answer_is_the_mesh_in_the_inputs_format_and_its_report) {
  const RemeshAnswer answer = remesh(job_of(kSquare));
  EXPECT_EQ(answer.format, Format::kObj);
  EXPECT_EQ(answer.options.format, Format::kObj);
  EXPECT_EQ(answer.report.input.faces, 2u);
  EXPECT_DOUBLE_EQ(answer.report.output.area, 1);
  const RemeshAnswer again = remesh(job_of(answer.body));
  EXPECT_EQ(again.report.input.faces, answer.report.output.faces);
  EXPECT_DOUBLE_EQ(again.report.input.area, 1);
}

TEST(remesh_job, the_option_goes_before_accept_and_accept_before_the_inputs_format) {
  EXPECT_EQ(remesh(job_of(kSquare, {}, "model/stl")).format, Format::kStl);
  EXPECT_EQ(remesh(job_of(kSquare, {{"format", "off"}}, "model/stl")).format, Format::kOff);
}

TEST(remesh_job, reading_and_writing_are_among_the_times) {
  for (const char* format : {"obj", "json"}) {
    const StageTimes times = remesh(job_of(kSquare, {{"format", format}})).times;
    for (const Stage stage : {Stage::kRead, Stage::kTriangulation, Stage::kWrite}) {
      EXPECT_TRUE(times.ran(stage)) << format << " " << stage_name(stage);
    }
    EXPECT_FALSE(times.ran(Stage::kRefinement)) << format;
  }
}

TEST(remesh_job, a_compressed_mesh_is_the_mesh) {
  RunControl control;
  EXPECT_EQ(remesh(job_of(gzip(kSquare, control))).body, remesh(job_of(kSquare)).body);
}

std::string refusal_of(std::string_view mesh, std::optional<Format> named = {}) {
  Job job = job_of(mesh);
  job.input_format = named;
  return error_of([&] { remesh(std::move(job)); }).what();
}

TEST(remesh_job, what_is_no_mesh_is_told_as_what_it_was_read_unless_that_was_said) {
  EXPECT_THAT(refusal_of("some\ntext\n"), EndsWith("; it was read as obj, because its content fits no other format"));
  EXPECT_THAT(refusal_of("ply\nformat text\n"),
              EndsWith("; it was read as ply, because its content looks like this format"));
  EXPECT_THAT(refusal_of(std::string_view("a\0b", 3)),
              EndsWith("; it was read as stl, because its content looks like this format"));
  EXPECT_EQ(refusal_of("some\ntext\n", Format::kObj), "the text has no face");
  EXPECT_EQ(refusal_of("v 0 0 0\nf 1 2 9\n"), "a face refers to vertex 2, but the mesh has only 1") << "it is OBJ";
}

TEST(remesh_job, a_mesh_whose_line_ends_were_lost_on_the_way_is_told_so) {
  std::string one_line(kSquare);
  std::erase(one_line, '\n');
  for (const std::string& text : {one_line, "# a comment" + one_line}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("--data-binary"));
    EXPECT_THAT(refusal_of(text, Format::kObj), HasSubstr("--data-binary"));
  }
  for (const std::string_view text : {"", "v 0 0 0\n", "v 0 0 0\rv 1 0 0"})
    EXPECT_THAT(refusal_of(text), Not(HasSubstr("--data-binary"))) << text;
}

TEST(remesh_job, the_bound_of_faces_is_the_servers_unless_a_lower_one_is_asked_for) {
  Limits limits;
  limits.max_output_faces = 50;
  EXPECT_EQ(remesh(job_of(kSquare), limits).options.core.max_output_faces, 50u);
  EXPECT_EQ(remesh(job_of(kSquare, {{"max_output_faces", "10"}}), limits).options.core.max_output_faces, 10u);
  const Error above = error_of([&] { remesh(job_of(kSquare, {{"max_output_faces", "51"}}), limits); });
  EXPECT_EQ(above.code, Code::kInvalidOption);
  EXPECT_EQ(above.option, "max_output_faces");
  EXPECT_EQ(above.limit, 50u);
  limits.max_output_faces = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(remesh(job_of(kSquare), limits).options.core.max_output_faces, std::nullopt);
  limits.usual_output_faces = 20;
  EXPECT_EQ(remesh(job_of(kSquare), limits).options.core.max_output_faces, 20u);
  EXPECT_EQ(remesh(job_of(kSquare, {{"max_output_faces", "51"}}), limits).options.core.max_output_faces, 51u);
  limits.max_output_faces = 10;
  EXPECT_EQ(remesh(job_of(kSquare), limits).options.core.max_output_faces, 10u);
}

TEST(remesh_job, the_face_under_each_face_is_found_where_it_is_told_or_asked_for) {
  const auto sources = [](const char* format, Purpose wanted) {
    RunControl control;
    return remesh_for_job(job_of(kSquare, {{"format", format}}), {}, wanted, control).result.face_source.size();
  };
  EXPECT_EQ(sources("json", Purpose::kAnswer), 2u);
  EXPECT_EQ(sources("obj", Purpose::kAnswer), 0u);
  EXPECT_EQ(sources("obj", Purpose::kKeeping), 2u);
}

TEST(remesh_job, a_stop_ends_it) {
  RunControl control;
  control.cancel();
  EXPECT_EQ(error_of([&] { run_remesh_job(job_of(kSquare), {}, control); }).code, Code::kCancelled);
}

TEST(analyze_job, an_analysis_remeshes_nothing_and_is_json_whatever_the_input) {
  RunControl control;
  const AnalysisAnswer answer = run_analyze_job(job_of(kSquare), {}, control);
  EXPECT_EQ(answer.options.format, Format::kJson);
  EXPECT_EQ(answer.report.input.faces, 2u);
  EXPECT_EQ(answer.report.output.faces, 0u);
  EXPECT_FALSE(answer.times.ran(Stage::kWrite));
  for (const Job& job : {job_of(kSquare, {{"format", "obj"}}), job_of(kSquare, {}, "model/obj")}) {
    EXPECT_EQ(error_of([&] { run_analyze_job(job, {}, control); }).code, Code::kNotAcceptable);
  }
}

/// Returns a report of three patches, one of which is kept, with a warning over two lines and with triangles below the
/// bound.
Report told_report() {
  Report report;
  report.input.faces = 12;
  report.output.faces = 3456;
  report.output.quality.min_angle_deg = 17.25;
  report.patches.resize(3);
  report.patches[1].status = PatchStatus::kKept;
  report.patches[2].status = PatchStatus::kReduced;
  report.verified.surface = report.verified.conforming = report.verified.delaunay = true;
  report.verified.quality = false;
  report.diagnostics.push_back({DiagnosticCode::kDuplicateFace, 4, {}, "first\nsecond\tthird"});
  report.unrefined.push_back({UnrefinedReason::kSizeFloor, 7, {}});
  return report;
}

TEST(summary, it_counts_faces_patches_and_warnings_in_one_line) {
  EXPECT_EQ(summary_line(summary_of(told_report())),
            "input_faces=12, output_faces=3456, patches=3, kept=1, min_angle_deg=17.25, verified=0, warnings=1");
}

TEST(summary, it_names_the_origin_last_and_without_commas) {
  Report report = told_report();
  report.output_origin = Vec3{453016, -0.25, 0};
  EXPECT_THAT(summary_line(summary_of(report)), EndsWith(", warnings=1, origin=453016 -0.25 0"));
  EXPECT_EQ(summary_comments(summary_of(report))[0], "remeshd " + std::string(version()) + ", origin 453016 -0.25 0");
}

TEST(summary, only_what_holds_in_every_respect_is_verified) {
  Report report = told_report();
  report.verified.quality = std::nullopt;
  EXPECT_THAT(summary_line(summary_of(report)), HasSubstr("verified=1,"));
  report.verified.delaunay = false;
  EXPECT_THAT(summary_line(summary_of(report)), HasSubstr("verified=0,"));
}

TEST(summary, comments_are_a_line_each_whatever_a_message_holds) {
  EXPECT_THAT(summary_comments(summary_of(told_report())),
              ElementsAre("remeshd " + std::string(version()), summary_line(summary_of(told_report())),
                          "warning: duplicate_face: 4: first second third", "unrefined: size_floor: 7"));
}

TEST(summary, comments_tell_the_proven_distance_in_words) {
  Report report = told_report();
  report.distance_bound = DistanceBound{0.25, 0.125};
  EXPECT_EQ(summary_comments(summary_of(report))[2],
            "proven: no point of the result is more than 0.25 from the input, and no point of the input more than "
            "0.125 from the result");
  report.distance_bound = DistanceBound{1e-9, 1e-9};
  EXPECT_EQ(summary_comments(summary_of(report))[2], "proven: input and result are nowhere more than 1e-09 apart");
}

TEST(summary, the_report_by_itself_is_the_one_of_the_json_answer_but_for_its_times) {
  RunControl control;
  const RemeshAnswer answer = remesh(job_of(kSquare, {{"format", "json"}}));
  std::string document;
  for (const std::string& piece : report_document(answer, control)) document += piece;
  EXPECT_EQ(document.back(), '\n');
  json alone = json::parse(document), within = json::parse(answer.body)["report"];
  for (json* report : {&alone, &within}) report->erase("timing_ms");
  EXPECT_EQ(alone, within);
}

}  // namespace
}  // namespace remesh::api
