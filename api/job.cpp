#include "api/job.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include "api/comparison.h"
#include "api/file_name.h"
#include "api/json_reader.h"
#include "api/quoting.h"
#include "core/base/error.h"
#include "core/io/gzip.h"
#include "core/io/mesh_files.h"

namespace remesh::api {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The mesh that was read, and the options, including those from the mesh file.
struct Input {
  Format format = Format::kObj;
  ReadResult read;
  RequestOptions options;
  double read_ms = 0;
};

/// Applies a server's limit to the options.
RequestOptions bounded(RequestOptions options, const Limits& limits) {
  std::optional<std::uint64_t>& faces = options.core.max_output_faces;
  if (faces && *faces > limits.max_output_faces) {
    throw Error(Code::kInvalidOption, Stage::kRead,
                "max_output_faces is above the limit of " + std::to_string(limits.max_output_faces))
        .for_option("max_output_faces")
        .with_limit(limits.max_output_faces);
  }
  if (options.core.target_faces && *options.core.target_faces > limits.max_output_faces) {
    throw Error(Code::kInvalidOption, Stage::kRead,
                "target_faces is above the limit of " + std::to_string(limits.max_output_faces))
        .for_option("target_faces")
        .with_limit(limits.max_output_faces);
  }
  const std::uint64_t usual = std::min(limits.max_output_faces, limits.usual_output_faces);
  if (!faces && usual != std::numeric_limits<std::uint64_t>::max()) faces = usual;
  return options;
}

/// The remark that is added to a reader's message: whether the format was a guess, or why a text may have only one
/// line.
std::string remark(Format format, bool is_named, std::string_view mesh) {
  std::string text;
  if (!is_named) {
    text = format == Format::kObj ? "; it was read as obj, because its content fits no other format"
                                  : "; it was read as " + std::string(format_name(format)) +
                                        ", because its content looks like this "
                                        "format";
  }
  if (is_file_name(mesh))
    return text +
           "; it is only the name of a file: with curl, an @ in front of the name sends the file, as in "
           "--data-binary @" +
           std::string(mesh);
  const bool is_one_line = !mesh.empty() && mesh.find_first_of(std::string_view("\n\r\0", 3)) == std::string_view::npos;
  if (is_one_line && format != Format::kJson)
    text += "; it has only one line: if its line ends were lost on the way, use curl --data-binary, which keeps them";
  return text;
}

/// Reads a mesh in any format except JSON.
/// Errors: as read_mesh; if the content is not a mesh, the message gets a remark.
ReadResult read_with_remarks(Format format, const Job& job, const ReadLimits& limits, RunControl& control) {
  try {
    return read_mesh(format, job.mesh, limits, control);
  } catch (Error& error) {
    if (error.code != Code::kInvalidMesh && error.code != Code::kEmptyMesh) throw;
    static_cast<std::runtime_error&>(error) =
        std::runtime_error(error.what() + remark(format, job.input_format.has_value(), job.mesh));
    throw;
  }
}

Input read_input(Job& job, const Limits& limits, RunControl& control) {
  const Clock::time_point start = Clock::now();
  control.enter(Stage::kRead);
  job.options.check();
  Input input;
  std::string decompressed;
  if (is_gzip(job.mesh)) {
    decompressed = gunzip(job.mesh, limits.decompression, control);
    job.mesh = decompressed;
  }
  input.format = choose_input_format(job.input_format, job.mesh);
  if (input.format == Format::kJson) {
    input.read = read_json(job.mesh, limits.input, control, job.options);
    job.options.check();
  } else {
    ReadLimits of_mesh = limits.input;
    of_mesh.decompression = limits.decompression;
    of_mesh.ply_labels = job.options.options().ply_labels;
    input.read = read_with_remarks(input.format, job, of_mesh, control);
  }
  job.mesh = {};
  if (job.release_mesh) job.release_mesh();
  input.options = bounded(job.options.options(), limits);
  input.read_ms = ms_since(start);
  return input;
}

/// Passes on what the file tells of its coordinates.
void tell_axes(const ReadResult& read, Report& report) {
  report.input_unit = read.unit;
  report.input_up_axis = read.up_axis;
}

StageTimes stage_times(const Input& input, const Report& report) {
  StageTimes times;
  times.add(Stage::kRead, input.read_ms);
  for (const StageTime& time : report.timing_ms) times.add(time.stage, time.ms);
  return times;
}

/// Writes {"mesh": ..., "report": ...}. The mesh comes first, so that the report can say how long writing it took.
std::string write_json_answer(const Result& result, const RequestOptions& options, StageTimes& times,
                              RunControl& control) {
  constexpr std::size_t kBytesPerVertex = 60;
  constexpr std::size_t kBytesPerFace = 40;
  const Clock::time_point start = Clock::now();
  JsonWriter json;
  json.reserve(result.mesh.positions.size() * kBytesPerVertex + result.mesh.faces.size() * kBytesPerFace);
  json.begin_object();
  json.key("mesh");
  write_mesh(json, result, control);
  times.add(Stage::kWrite, ms_since(start));
  json.key("report");
  write_report(json, result.report, options, ReportKind::kRemesh, times, control);
  json.end_object();
  return json.take();
}

std::string write_mesh_answer(Format format, const Result& result, const Writing& writing, StageTimes& times,
                              RunControl& control) {
  const Clock::time_point start = Clock::now();
  const std::vector<std::string> comments = summary_comments(summary_of(result.report));
  std::string body = write_mesh(format, writer_input(result, comments, writing), control);
  times.add(Stage::kWrite, ms_since(start));
  return body;
}

std::vector<std::string> report_document(const Report& report, const RequestOptions& options, ReportKind kind,
                                         const StageTimes& times, RunControl& control) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  JsonWriter json(kPiece);
  write_report(json, report, options, kind, times, control);
  std::vector<std::string> pieces = json.take_pieces();
  pieces.back() += '\n';
  return pieces;
}

}  // namespace

WriterInput writer_input(const Result& result, const std::vector<std::string>& comments, const Writing& writing) {
  return {result.mesh, result.face_patch,
          comments,    result.report.surfaces.of_patch.items(),
          writing,     result.report.input_up_axis == "y"};
}

bool record_file(Format format, const Writing& writing, Result& result, RunControl& control) {
  Report& report = result.report;
  const std::vector<std::string> comments;
  const WriterInput input = writer_input(result, comments, writing);
  report.renamed_labels = renamed_labels(format, input, control);
  report.filling_lines = filling_lines(format, input, control);
  if (!report.renamed_labels.empty()) report.diagnostics.push_back(renamed_diagnostic(report.renamed_labels));
  return !report.renamed_labels.empty() || !report.filling_lines.empty();
}

void check_job(const Job& job, const Limits& limits) {
  job.options.check();
  const RequestOptions options = bounded(job.options.options(), limits);
  if (job.input_format) choose_input_format(job.input_format, job.mesh);
  choose_output_format(options.format, job.accept, Format::kObj);
}

Remeshed remesh_for_job(Job job, const Limits& limits, Purpose purpose, RunControl& control) {
  Input input = read_input(job, limits, control);
  Remeshed remeshed;
  remeshed.options = input.options;
  remeshed.wanted = choose_output_format(input.options.format, job.accept, input.format);
  const Format format = remeshed.wanted.format;
  RunSettings settings{.workers = limits.workers, .serial_corners = limits.serial_corners};
  settings.want_face_source = purpose == Purpose::kKeeping || format == Format::kJson;
  settings.storage = storage_of(format);
  settings.trace = job.trace;
  settings.rounding = purpose == Purpose::kKeeping ? OutputRounding::kLater : rounding_for(remeshed.wanted);
  remeshed.result =
      remesh_surface(input.read.mesh, input.options.core, settings, control, std::move(input.read.diagnostics));
  tell_axes(input.read, remeshed.result.report);
  remeshed.options.format = remeshed.result.is_not_held ? text_form(format) : format;
  if (purpose == Purpose::kAnswer)
    record_file(*remeshed.options.format, remeshed.options.writing, remeshed.result, control);
  remeshed.times = stage_times(input, remeshed.result.report);
  return remeshed;
}

RemeshAnswer run_remesh_job(Job job, const Limits& limits, RunControl& control) {
  Remeshed remeshed = remesh_for_job(std::move(job), limits, Purpose::kAnswer, control);
  RemeshAnswer answer;
  answer.format = *remeshed.options.format;
  answer.options = remeshed.options;
  answer.times = remeshed.times;
  control.enter(Stage::kWrite);
  answer.body = answer.format == Format::kJson
                    ? write_json_answer(remeshed.result, answer.options, answer.times, control)
                    : write_mesh_answer(answer.format, remeshed.result, answer.options.writing, answer.times, control);
  answer.report = std::move(remeshed.result.report);
  return answer;
}

AnalysisAnswer run_analyze_job(Job job, const Limits& limits, RunControl& control) {
  Input input = read_input(job, limits, control);
  AnalysisAnswer answer;
  answer.options = input.options;
  answer.options.format = choose_output_format(input.options.format, job.accept, Format::kJson).format;
  if (answer.options.format != Format::kJson) {
    throw Error(Code::kNotAcceptable, Stage::kRead, "an analysis is written as json only");
  }
  answer.report = analyze_surface(input.read.mesh, input.options.core,
                                  {.workers = limits.workers, .serial_corners = limits.serial_corners}, control,
                                  std::move(input.read.diagnostics));
  tell_axes(input.read, answer.report);
  answer.times = stage_times(input, answer.report);
  return answer;
}

ComparedMesh read_compared(Job job, const Limits& limits, RunControl& control) {
  Input input = read_input(job, limits, control);
  if (job.options.is_any_given())
    throw Error(Code::kInvalidOption, Stage::kRead, "a mesh that is compared has no options beside it");
  return {std::move(input.read.mesh), input.read_ms};
}

std::vector<std::string> report_document(const RemeshAnswer& answer, RunControl& control) {
  return report_document(answer.report, answer.options, ReportKind::kRemesh, answer.times, control);
}

std::vector<std::string> report_document(const AnalysisAnswer& answer, RunControl& control) {
  return report_document(answer.report, answer.options, ReportKind::kAnalysis, answer.times, control);
}

}  // namespace remesh::api
