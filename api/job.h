/// One remeshing or analysis from bytes to bytes. The daemon and the command line share it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/negotiation.h"
#include "api/operations.h"
#include "api/options.h"
#include "api/report_json.h"
#include "api/summary.h"
#include "core/base/run_control.h"
#include "core/io/common/format.h"
#include "core/remesh.h"

namespace remesh::api {

/// A remeshing or analysis to be done. `options` holds those known before the mesh is read; a JSON mesh may add more.
struct Job {
  std::string_view mesh;
  std::optional<Format> input_format;  ///< empty: the format is found from the content
  std::string accept;                  ///< the value of the Accept header; empty accepts anything
  OptionReader options;
  /// Called once the mesh has been read and its bytes are no longer needed.
  std::function<void()> release_mesh = nullptr;
  std::function<void(const std::string&)> trace = nullptr;  ///< see RunSettings
};

/// The answer to a remeshing: the mesh as bytes, and its report.
struct RemeshAnswer {
  Format format = Format::kObj;
  std::string body;
  Report report;
  RequestOptions options;  ///< the options that were used
  StageTimes times;
};

/// The answer to an analysis, which has only a report.
struct AnalysisAnswer {
  Report report;
  RequestOptions options;
  StageTimes times;
};

/// The remeshed surface before it is written. `options.format` is the format in which it will be written: that of
/// `wanted`, or its form as text if the format cannot hold the result.
struct Remeshed {
  Result result;
  RequestOptions options;  ///< the options that were used
  OutputFormat wanted;     ///< the format that was asked for
  StageTimes times;
};

/// The purpose that a result is computed for.
enum class Purpose {
  kAnswer,   ///< it is written at once, rounded and measured for the chosen format
  kKeeping,  ///< it is written later in any format, so it keeps doubles and all data that any format shows
};

/// The input of the writer of a mesh format. It refers to all arguments.
WriterInput writer_input(const Result& result, const std::vector<std::string>& comments, const Writing& writing);

/// Records in the report what is to be known of a written file: the names of labels that it has in another form, and
/// the lines that fill it.
/// Output: whether the report has changed.
bool record_file(Format format, const Writing& writing, Result& result, RunControl& control);

/// Checks everything that can be refused before the mesh is read.
/// Errors: those of options and of formats.
void check_job(const Job& job, const Limits& limits);

/// Makes the result of a job, but does not write it.
/// Errors: those of options, of the format, of reading and of the pipeline.
Remeshed remesh_for_job(Job job, const Limits& limits, Purpose purpose, RunControl& control);

/// Errors: those of options, of the format, of reading and of the pipeline.
RemeshAnswer run_remesh_job(Job job, const Limits& limits, RunControl& control);
AnalysisAnswer run_analyze_job(Job job, const Limits& limits, RunControl& control);

/// Writes the report alone as a JSON document, in pieces.
std::vector<std::string> report_document(const RemeshAnswer& answer, RunControl& control);
std::vector<std::string> report_document(const AnalysisAnswer& answer, RunControl& control);

}  // namespace remesh::api
