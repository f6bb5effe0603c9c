#include "api/operations.h"

#include <algorithm>
#include <array>

#include "api/comparison.h"
#include "api/file_name.h"
#include "api/job.h"
#include "api/json_reader.h"
#include "api/multipart.h"
#include "api/negotiation.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "api/result_archive.h"
#include "core/base/number_text.h"
#include "core/io/gzip.h"
#include "core/io/mesh_files.h"
#include "core/mesh/quality.h"
#include "core/output/result/round_for_format.h"

namespace remesh::api {
namespace {

/// A parsed request.
struct ParsedRequest {
  Job job;
  std::string file_name;  ///< the name of a form's upload, if it had one; not trusted
  std::string decoded;    ///< the body if it was compressed; `job` refers to it
};

/// True if the whole body is compressed.
/// Errors: kUnsupportedMediaType - a coding that is not gzip.
bool is_compressed(const Request& request) {
  bool is_gzip = false;
  for (std::string_view rest = request.content_encoding; !rest.empty();) {
    const auto [element, others] = cut(rest, ',');
    rest = others;
    const std::string coding = ascii_lower(trim(element));
    if (coding.empty() || coding == "identity") continue;
    if (is_gzip || (coding != "gzip" && coding != "x-gzip")) {
      throw Error(Code::kUnsupportedMediaType, Stage::kRead,
                  "the content coding " + in_quotes(request.content_encoding) +
                      " is not supported; the "
                      "supported coding is gzip");
    }
    is_gzip = true;
  }
  return is_gzip;
}

/// Returns the body without its Content-Encoding.
/// Input: `decoded` - receives the body if it had one.
/// Errors: kUnsupportedMediaType; kMalformedRequest - the body does not follow its coding.
std::string_view decoded_body(const Request& request, const Limits& limits, RunControl& control, std::string& decoded) {
  if (!is_compressed(request)) return request.body;
  try {
    decoded = gunzip(request.body, limits.decompression, control);
  } catch (const Error& error) {
    if (error.code != Code::kInvalidMesh) throw;
    Error malformed(as_code(RequestCode::kMalformedRequest), Stage::kRead, error.what());
    malformed.byte = error.byte;
    throw malformed;
  }
  return decoded;
}

/// Reads the options of a form.
/// Errors: as read_json_options. The message says that the fault is in the options, because a line or byte alone would
///         be taken for a place in the mesh.
void read_options_part(std::string_view content, RunControl& control, OptionReader& options) {
  try {
    read_json_options(content, control, options);
  } catch (const Error& error) {
    Error named(error.code, error.stage, "in the part \"options\" of the form: " + std::string(error.what()));
    named.line = error.line;
    named.byte = error.byte;
    named.element = error.element;
    named.option = error.option;
    named.limit = error.limit;
    throw named;
  }
}

/// True if a body looks like `name=value&...` with a name that cannot begin a mesh.
bool is_urlencoded(std::string_view body) {
  const std::size_t equals = body.substr(0, 200).find('=');
  if (equals == 0 || equals == std::string_view::npos) return false;
  return std::all_of(body.begin(), body.begin() + static_cast<std::ptrdiff_t>(equals), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-.%+[]").find(c) != std::string_view::npos;
  });
}

/// The names under which a form may have its mesh, as other services call it.
constexpr std::array<std::string_view, 5> kMeshNames{"mesh", "file", "model", "upload", "data"};
/// Files with these names have meanings of their own, and are no mesh to be remeshed.
constexpr std::array<std::string_view, 3> kOtherFiles{"sizes", "a", "b"};

template <class Names>
bool is_one_of(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns a field without blanks and line ends around it, which text areas and files of one word have.
std::string_view without_line_ends(std::string_view text) {
  constexpr std::string_view kAround = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kAround);
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(kAround) + 1 - begin);
}

[[noreturn]] void fail_form(const std::string& message) {
  throw Error(as_code(RequestCode::kMalformedMultipart), Stage::kRead, message);
}

std::string names_of_mesh() {
  std::string text;
  for (const std::string_view name : kMeshNames)
    text.append(text.empty() ? "" : name == kMeshNames.back() ? " or " : ", ").append(name);
  return text;
}

/// Takes a file of a form as the mesh of a job.
void take_file(const FormPart& part, Job& job) {
  if (!part.is_file && is_file_name(part.content))
    fail_form("the part " + in_quotes(part.name) + " is only the name of a file, " + in_quotes(part.content) +
              "; with curl, an @ in front of the name sends the file: -F " + part.name + "=@" +
              shortened(part.content));
  if (part.content.empty())
    throw Error(Code::kEmptyMesh, Stage::kRead, "the file of the part " + in_quotes(part.name) + " is empty");
  job.mesh = part.content;
  job.input_format = format_of_content_type(part.content_type);
}

/// Takes the mesh of a form.
void take_mesh_part(const FormPart& part, std::string_view earlier, ParsedRequest& parsed) {
  if (!earlier.empty())
    fail_form("the form has a mesh as " + in_quotes(earlier) + " and another one as " + in_quotes(part.name) +
              "; send one of them");
  take_file(part, parsed.job);
  parsed.file_name = part.file_name;
}

/// Reads the mesh and the options of a form: a part with a file name is a file, and one without is an option.
void read_form(std::string_view body, const Request& request, RunControl& control, ParsedRequest& parsed) {
  std::string mesh_name;
  bool has_options = false;
  for (const FormPart& part : parse_multipart(body, request.content_type)) {
    if (part.name == "options") {
      if (std::exchange(has_options, true)) fail_form("the form has more than one part \"options\"");
      read_options_part(part.content, control, parsed.job.options);
    } else if (is_one_of(kMeshNames, part.name)) {
      take_mesh_part(part, mesh_name, parsed);
      mesh_name = part.name;
    } else if (part.is_file) {
      fail_form("the form has a file as " + in_quotes(part.name) +
                (is_one_of(kOtherFiles, part.name) ? ", which is no mesh to be remeshed" : "") + "; send the mesh as " +
                names_of_mesh());
    } else {
      parsed.job.options.add(part.name, without_line_ends(part.content));
    }
  }
  if (mesh_name.empty())
    fail_form("the form has no mesh; send the mesh as a field with the name " + names_of_mesh() +
              " (curl -F mesh=@part.stl)");
}

/// The two meshes of a form. They refer to the body.
struct ComparedParts {
  Job a, b;
  ComparisonOptions options;
};

ComparedParts read_compared_parts(std::string_view body, const Request& request) {
  ComparedParts parts;
  if (media_type_of(request.content_type) != "multipart/form-data")
    throw Error(Code::kUnsupportedMediaType, Stage::kRead,
                "a comparison takes a form of the type multipart/form-data with the two meshes as its files \"a\" and "
                "\"b\": with curl, -F a=@first.stl -F b=@second.stl");
  for (const auto& [name, value] : request.query) parts.options.add(name, value);
  std::array<bool, 2> are_there{};
  for (const FormPart& part : parse_multipart(body, request.content_type)) {
    if (part.name == "a" || part.name == "b") {
      const bool is_b = part.name == "b";
      if (std::exchange(are_there[is_b], true)) fail_form("the form has more than one part " + in_quotes(part.name));
      take_file(part, is_b ? parts.b : parts.a);
    } else if (part.is_file) {
      fail_form("the form has a file as " + in_quotes(part.name) + "; a comparison takes the files \"a\" and \"b\"");
    } else {
      parts.options.add(part.name, without_line_ends(part.content));
    }
  }
  for (const bool is_b : {false, true})
    if (!are_there[is_b])
      fail_form(std::string("the form has no mesh ") + (is_b ? "\"b\"" : "\"a\"") +
                "; a comparison takes two files with the names \"a\" and \"b\"");
  return parts;
}

/// Reads one of two meshes. An error says which one it is about.
ComparedMesh read_part(std::string_view name, Job job, const Limits& limits, RunControl& control) {
  try {
    return read_compared(std::move(job), limits, control);
  } catch (Error& error) {
    static_cast<std::runtime_error&>(error) =
        std::runtime_error("in the part " + in_quotes(name) + ": " + error.what());
    throw;
  }
}

void check_body_size(const Request& request, const Limits& limits) {
  if (request.body.size() <= limits.max_body) return;
  throw Error(as_code(RequestCode::kBodyTooLarge), Stage::kRead,
              "the body is longer than " + std::to_string(limits.max_body) + " bytes")
      .with_limit(limits.max_body);
}

/// Fills `parsed` in place, because its `job` refers to its other members.
void parse_request(const Request& request, const Limits& limits, RunControl& control, ParsedRequest& parsed) {
  check_body_size(request, limits);
  const std::string_view body = decoded_body(request, limits, control, parsed.decoded);
  parsed.job.accept = request.accept;
  parsed.job.trace = limits.trace;
  parsed.job.release_mesh = [&] {
    std::string().swap(parsed.decoded);
    if (request.release_body) request.release_body();
  };
  for (const auto& [name, value] : request.query) parsed.job.options.add(name, value);
  if (media_type_of(request.content_type) == "multipart/form-data") {
    read_form(body, request, control, parsed);
  } else {
    // Many clients give this type to every body, so the content decides.
    if (media_type_of(request.content_type) == "application/x-www-form-urlencoded" && is_urlencoded(body)) {
      throw Error(Code::kUnsupportedMediaType, Stage::kRead,
                  "the body is a urlencoded form; send the mesh itself as the body, or a form of the type "
                  "multipart/form-data with the mesh as its file \"mesh\"");
    }
    parsed.job.mesh = body;
    parsed.job.input_format = format_of_content_type(request.content_type);
  }
}

/// Formats the value of Server-Timing: `read;dur=1.2, ..., total;dur=30`.
std::string server_timing(const StageTimes& times) {
  std::string text;
  for (int s = 0; s < kStageCount; ++s) {
    const Stage stage = static_cast<Stage>(s);
    if (times.ran(stage)) text.append(stage_name(stage)).append(";dur=" + shortest_text(times.of(stage)) + ", ");
  }
  return text + "total;dur=" + shortest_text(times.total());
}

/// The times of the stages that ran.
std::vector<std::pair<std::string_view, double>> stages_that_ran(const StageTimes& times) {
  std::vector<std::pair<std::string_view, double>> stages;
  for (int s = 0; s < kStageCount; ++s) {
    const Stage stage = static_cast<Stage>(s);
    if (times.ran(stage)) stages.emplace_back(stage_name(stage), times.of(stage));
  }
  return stages;
}

/// Counts the work. The caller sets `output_faces` after a remeshing.
WorkDone work_done(const Report& report, const StageTimes& times) {
  WorkDone done;
  done.input_faces = report.input.faces;
  for (const PatchSummary& patch : report.patches) {
    ++(patch.status == PatchStatus::kRemeshed  ? done.remeshed
       : patch.status == PatchStatus::kReduced ? done.reduced
                                               : done.kept);
  }
  done.stages_ms = stages_that_ran(times);
  return done;
}

/// The limits for the mesh of a request. A mesh that is compressed within a compressed body may use the ratio only
/// once.
Limits limits_of_mesh(const ParsedRequest& parsed, const Request& request, Limits limits) {
  if (!parsed.decoded.empty())
    limits.decompression.max_bytes = most_decompressed(request.body.size(), limits.decompression);
  return limits;
}

/// Makes the header fields of a result.
Fields result_headers(std::string_view summary, std::string_view timing, std::string_view file_name, Format format) {
  Fields headers{{"Remesh-Summary", std::string(summary)}, {"Server-Timing", std::string(timing)}};
  if (format != Format::kJson) {
    headers.emplace_back("Content-Disposition", content_disposition(file_name, format));
  }
  return headers;
}

/// Updates the members of a summary that change with rounding.
void update_summary(const Result& rounded, Summary& summary, RunControl& control) {
  summary.min_angle_deg = measure_surface(rounded.mesh, control).quality.min_angle_deg;
  summary.origin = rounded.report.output_origin;
  summary.distance_bound = rounded.report.distance_bound;
  summary.unrefined.clear();
  for (const Unrefined& left : summarise_unrefined(rounded.rounding_input.unrefined, rounded.mesh.positions.items(),
                                                   rounded.mesh.faces.items(), rounded.rounding_input.goals, control))
    summary.unrefined.emplace_back(left.reason, left.count);
}

}  // namespace

Response run_remesh(const Request& request, const Limits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  ParsedRequest parsed;
  parse_request(request, limits, control, parsed);
  RemeshAnswer answer = run_remesh_job(std::move(parsed.job), limits_of_mesh(parsed, request, limits), control);

  Response response;
  response.content_type = content_type(answer.format);
  response.body = std::move(answer.body);
  response.headers = result_headers(summary_line(summary_of(answer.report)), server_timing(answer.times),
                                    parsed.file_name, answer.format);
  response.done = work_done(answer.report, answer.times);
  response.done->output_faces = answer.report.output.faces;
  return response;
}

Response run_analyze(const Request& request, const Limits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  ParsedRequest parsed;
  parse_request(request, limits, control, parsed);
  const AnalysisAnswer answer =
      run_analyze_job(std::move(parsed.job), limits_of_mesh(parsed, request, limits), control);

  JsonWriter json;
  json.begin_object();
  json.key("report");
  write_report(json, answer.report, answer.options, ReportKind::kAnalysis, answer.times, control);
  json.end_object();
  Response response;
  response.content_type = media_type(Format::kJson);
  response.body = json.take();
  response.headers = {{"Server-Timing", server_timing(answer.times)}};
  response.done = work_done(answer.report, answer.times);
  response.done->remeshed = response.done->reduced = response.done->kept = 0;
  return response;
}

Response run_compare(const Request& request, const Limits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  check_body_size(request, limits);
  if (choose_output_format(std::nullopt, request.accept, Format::kJson).format != Format::kJson)
    throw Error(Code::kNotAcceptable, Stage::kRead, "a comparison is written as json only");
  ParsedRequest parsed;
  const std::string_view body = decoded_body(request, limits, control, parsed.decoded);
  ComparedParts parts = read_compared_parts(body, request);
  const Limits of_mesh = limits_of_mesh(parsed, request, limits);
  ComparedMesh a = read_part("a", std::move(parts.a), of_mesh, control);
  ComparedMesh b = read_part("b", std::move(parts.b), of_mesh, control);
  std::string().swap(parsed.decoded);
  if (request.release_body) request.release_body();
  const ComparisonAnswer answer = compare(std::move(a), std::move(b), parts.options.tolerance(), limits, control);

  Response response;
  response.content_type = media_type(Format::kJson);
  response.body = comparison_document(answer);
  response.headers = {{"Server-Timing", server_timing(answer.times)}};
  response.done.emplace();
  response.done->input_faces = answer.input_faces;
  response.done->stages_ms = stages_that_ran(answer.times);
  return response;
}

StoredRemesh run_remesh_to_keep(const Request& request, const Limits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  ParsedRequest parsed;
  parse_request(request, limits, control, parsed);
  Remeshed remeshed =
      remesh_for_job(std::move(parsed.job), limits_of_mesh(parsed, request, limits), Purpose::kKeeping, control);
  const Format format = remeshed.wanted.format;
  const auto report_text = [&](const Report& report) {
    JsonWriter json;
    write_report(json, report, remeshed.options, ReportKind::kRemesh, remeshed.times, control);
    return json.take();
  };

  control.enter(Stage::kWrite);
  KeptResult kept;
  kept.format = format;
  kept.local_origin = remeshed.options.core.local_origin;
  kept.writing = remeshed.options.writing;
  kept.summary = summary_of(remeshed.result.report);
  kept.server_timing = server_timing(remeshed.times);
  kept.file_name = std::move(parsed.file_name);
  StoredRemesh answer;
  answer.report = report_text(remeshed.result.report);
  if (storage_of(format) != Storage::kDouble) kept.exact_report = answer.report;
  kept.result = std::move(remeshed.result);
  // Other formats that are written later may have the names as they came, and are filled by other lines.
  const auto record_own_file = [&] {
    if (!record_file(kept.format, kept.writing, kept.result, control)) return;
    kept.exact_report = answer.report;
    answer.report = report_text(kept.result.report);
  };
  record_own_file();
  answer.mesh = pack_result(kept);
  // The report describes the result in the job's own format. If this format cannot hold the result, the report stays
  // about doubles, and the job gives the result in all other formats.
  const Rounded rounded =
      round_for_format(storage_of(format), kept.local_origin, OutputRounding::kIfHeld, kept.result, control);
  if (rounded == Rounded::kMoved) {
    measure_output(kept.result, control);
    answer.report = report_text(kept.result.report);
  } else if (rounded == Rounded::kNotHeld) {
    kept.exact_report.clear();
    if (rounding_for(remeshed.wanted) == OutputRounding::kIfHeld) {
      kept.format = text_form(format);
      remeshed.options.format = kept.format;
      kept.summary = summary_of(kept.result.report);
      answer.report = report_text(kept.result.report);
      record_own_file();
    }
    answer.mesh = pack_result(kept);
  }
  answer.done = work_done(kept.result.report, remeshed.times);
  answer.done.output_faces = kept.result.report.output.faces;
  return answer;
}

bool check_remesh(const Request& request, const Limits& limits) {
  RunControl control;
  ParsedRequest parsed;
  // A compressed body is not checked here, but later when it is read.
  Request head = request;
  if (is_compressed(request)) head.body = head.content_encoding = head.content_type = "";
  parse_request(head, limits, control, parsed);
  const Job& job = parsed.job;
  check_job(job, limits);
  return job.input_format ? *job.input_format == Format::kJson && !is_gzip(job.mesh)
                          : sniff_format(job.mesh) == Format::kJson;
}

void check_json(const Request& request, const Limits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  ParsedRequest parsed;
  parse_request(request, limits, control, parsed);
  check_json_text(parsed.job.mesh, limits.input, control, parsed.job.options);
  check_job(parsed.job, limits);
}

Response write_kept(std::string mesh, const std::function<std::string()>& report, const Request& wanted,
                    RunControl& control) {
  control.enter(Stage::kWrite);
  for (const auto& [name, value] : wanted.query) {
    const OptionSpec* option = find_option(name);
    if (option != nullptr && is_of_output(*option)) continue;
    throw Error(as_code(RequestCode::kUnknownOption), Stage::kWrite,
                "a result takes only the options that say how it is written (format, local_origin, label, names, "
                "stl_solids, msh_version, glb_colours), not " +
                    in_quotes(name))
        .for_option(shortened(name));
  }
  // Faults of the options are told before the result is unpacked, which takes several times as much memory.
  const auto options_with = [&](RequestOptions options) {
    OptionReader reader(std::move(options));
    for (const auto& [name, value] : wanted.query) reader.add(name, value);
    reader.check();
    return reader.options();
  };
  (void)options_with({});
  KeptResult kept = unpack_result(mesh);
  std::string().swap(mesh);  // the following steps take several times as much memory
  RequestOptions of_job;
  of_job.core.local_origin = kept.local_origin;
  of_job.writing = kept.writing;
  const RequestOptions options = options_with(std::move(of_job));
  const Format format = choose_output_format(options.format, wanted.accept, kept.format).format;
  Response response;
  response.content_type = content_type(format);
  if (format == Format::kJson) {
    JsonWriter json;
    json.begin_object();
    json.key("mesh");
    write_mesh(json, kept.result, control);
    json.key("report");
    json.raw(kept.exact_report.empty() ? report() : kept.exact_report);
    json.end_object();
    response.body = json.take();
  } else {
    kept.result.report.distance_bound = kept.summary.distance_bound;
    // If a job did not ask for its format by name, the chosen format can hold the result.
    if (round_for_format(storage_of(format), options.core.local_origin, OutputRounding::kRequired, kept.result,
                         control) == Rounded::kMoved)
      update_summary(kept.result, kept.summary, control);
    record_file(format, options.writing, kept.result, control);
    if (!kept.result.report.renamed_labels.empty())
      kept.summary.warnings.push_back(warning_text(renamed_diagnostic(kept.result.report.renamed_labels)));
    const std::vector<std::string> comments = summary_comments(kept.summary);
    response.body = write_mesh(format, writer_input(kept.result, comments, options.writing), control);
  }
  response.headers = result_headers(summary_line(kept.summary), kept.server_timing, kept.file_name, format);
  return response;
}

}  // namespace remesh::api
