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
#include "api/summary.h"
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

/// A result is made for one of two purposes.
enum class Purpose {
  kAnswer,   ///< it is written at once: in the numbers of the job's format, and with what that format tells
  kKeeping,  ///< it is written in any format, later: in doubles, with all that some format tells
};

/// What can be refused before the mesh is read. Errors: of options, of the formats.
void check_job(const Job& job, const Limits& limits);

/// All of a job but the writing. Errors: of options, of the format, of reading, of the pipeline.
Remeshed remesh_for_job(Job job, const Limits& limits, Purpose purpose, RunControl& control);

/// Errors: of options, of the format, of reading, of the pipeline.
RemeshAnswer run_remesh_job(Job job, const Limits& limits, RunControl& control);
AnalysisAnswer run_analyze_job(Job job, const Limits& limits, RunControl& control);

/// The report object alone, as a document.
std::string report_document(const RemeshAnswer& answer, RunControl& control);

}  // namespace remesh::api
