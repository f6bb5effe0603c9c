/// One remeshing from bytes to bytes: what the daemon and the command line share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

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

/// Errors: of options, of the format, of reading, of the pipeline.
RemeshAnswer run_remesh_job(Job job, const Limits& limits, RunControl& control);
AnalysisAnswer run_analyze_job(Job job, const Limits& limits, RunControl& control);

/// `input_faces=..., output_faces=..., patches=..., kept=..., min_angle_deg=..., verified=1, warnings=...`
std::string remesh_summary(const Report& report);

/// The report object alone, as a document.
std::string report_document(const RemeshAnswer& answer, RunControl& control);

}  // namespace remesh::api
