/// One remeshing from bytes to bytes: what the daemon and the command line share.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/options.h"
#include "api/report_json.h"
#include "api/service.h"
#include "core/base/run_control.h"
#include "core/remesh.h"

namespace remesh::api {

/// What is to be done. `options` holds those known before the mesh is read; a JSON mesh may bring more.
struct Job {
  std::string_view mesh;
  std::optional<Format> input_format;  ///< nothing: the content tells
  std::string accept;                  ///< as in the header of that name; empty: anything
  OptionReader options;
  std::function<void()> release_mesh = nullptr;  ///< called once the mesh is read and its bytes not needed any more
};

/// The remeshed surface and its report, and the mesh as bytes.
struct RemeshAnswer {
  Format format = Format::kObj;
  std::string body;
  Report report;
  RequestOptions options;  ///< as used
  StageTimes times;
};

/// An analysis has only a report.
struct AnalysisAnswer {
  Report report;
  RequestOptions options;
  StageTimes times;
};

/// The remeshed surface before it is written. `options.format` is the format that the job asks for.
struct Remeshed {
  Result result;
  RequestOptions options;  ///< as used
  StageTimes times;
};

/// Whether the input face under each output face is found, which only JSON tells.
enum class FaceSource { kWhereJson, kAlways };

/// What can be refused before the mesh is read. Errors: of options, of the formats.
void check_job(const Job& job, const Limits& limits);

/// All of a job but the writing. Errors: of options, of the format, of reading, of the pipeline.
Remeshed remesh_for_job(Job job, const Limits& limits, FaceSource face_source, RunControl& control);

/// Errors: of options, of the format, of reading, of the pipeline.
RemeshAnswer run_remesh_job(Job job, const Limits& limits, RunControl& control);
AnalysisAnswer run_analyze_job(Job job, const Limits& limits, RunControl& control);

/// `input_faces=..., output_faces=..., patches=..., kept=..., min_angle_deg=..., verified=1, warnings=...`
std::string remesh_summary(const Report& report);

/// That, and in lines of their own the warnings and what refinement left: what a mesh format has no other place for. No
/// times and no id: the same in every run.
std::vector<std::string> summary_comments(const Report& report);

/// The report object alone, as a document.
std::string report_document(const RemeshAnswer& answer, RunControl& control);

}  // namespace remesh::api
