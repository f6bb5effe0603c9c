// The command line counterpart of the daemon: remesh part.obj -o out.obj --plane-tolerance 1e-5 --report report.json
#include <malloc.h>
#include <signal.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/cli/analysis_text.h"
#include "api/cli/batch.h"
#include "api/cli/failure.h"
#include "api/cli/files.h"
#include "api/cli/flag_names.h"
#include "api/cli/progress_bar.h"
#include "api/cli/remote.h"
#include "api/comparison.h"
#include "api/job.h"
#include "api/machine_limits.h"
#include "api/operations.h"
#include "api/options.h"
#include "api/quoting.h"
#include "core/base/number_text.h"
#include "core/io/format_spec.h"
#include "core/io/formats.h"
#include "core/io/gzip.h"
#include "core/output/report/report.h"
#include "core/output/report/surface_words.h"
#include "core/remesh.h"

namespace remesh::cli {
namespace {

/// A part of a sentence that counts things: `3 faces`.
std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
  return grouped_digits(count) + " " + (count == 1 ? one : many);
}

std::string first_line(std::uint64_t input, std::uint64_t output, double min_angle_deg) {
  return counted(input, "face", "faces") + " in, " + grouped_digits(output) + " out; the least angle is " +
         number_text(min_angle_deg, 3) + " degrees";
}

/// Lists names with their counts: `10 input_angle, 2 size_floor`.
template <class Items, class Name>
std::string list_counts(const Items& items, Name name) {
  std::string text;
  for (const auto& item : items)
    text.append(text.empty() ? "" : ", ").append(grouped_digits(item.count) + " ").append(name(item));
  return text;
}

/// Describes what was given up or missed; empty if nothing was.
std::string missed(const Report& report) {
  std::vector<std::string> parts;
  const auto count_patches = [&](PatchStatus status) {
    return static_cast<std::uint64_t>(std::count_if(report.patches.begin(), report.patches.end(),
                                                    [&](const PatchSummary& p) { return p.status == status; }));
  };
  if (const std::uint64_t kept = count_patches(PatchStatus::kKept); kept > 0)
    parts.push_back("kept as they came: " + counted(kept, "patch", "patches"));
  if (const std::uint64_t reduced = count_patches(PatchStatus::kReduced); reduced > 0)
    parts.push_back("divided more finely than planned: " + counted(reduced, "patch", "patches"));
  if (!report.unrefined.empty())
    parts.push_back("triangles that miss a bound: " +
                    list_counts(report.unrefined, [](const Unrefined& u) { return unrefined_name(u.reason); }));
  if (!report.volume_obstacles.empty())
    parts.push_back(
        "a volume mesher will refuse the result, because of " +
        list_counts(report.volume_obstacles, [](const VolumeObstacle& o) { return diagnostic_name(o.code); }));
  std::string text;
  for (const std::string& part : parts) text.append(text.empty() ? "" : "; ").append(part);
  return text;
}

/// Ranks the diagnostics whose remedies are named: the first one is the most important. The others are not named.
constexpr std::array kCodesWithAdvice{DiagnosticCode::kOpenBoundary, DiagnosticCode::kInsideOut,
                                      DiagnosticCode::kManyFaces, DiagnosticCode::kCurvedSurface};

/// Converts `a_b=1&c=2` to `--a-b 1 --c 2`.
std::string as_flags(std::string_view query) {
  std::string flags;
  while (!query.empty()) {
    const auto [pair, rest] = api::cut(query, '&');
    const auto [name, value] = api::cut(pair, '=');
    flags.append(flags.empty() ? "--" : " --").append(with_hyphens(name)).append(" ").append(value);
    query = rest;
  }
  return flags;
}

bool are_all_given(std::string_view query, const api::Fields& given) {
  while (!query.empty()) {
    const auto [pair, rest] = api::cut(query, '&');
    const std::string_view name = api::cut(pair, '=').first;
    if (std::none_of(given.begin(), given.end(), [&](const auto& option) { return option.first == name; }))
      return false;
    query = rest;
  }
  return true;
}

/// Finds the remedy that would help most; empty if there is none.
std::string advice(const Report& report, const api::Fields& given) {
  for (const DiagnosticCode code : kCodesWithAdvice)
    for (const Diagnostic& diagnostic : report.diagnostics) {
      if (diagnostic.code != code) continue;
      for (const Remedy& remedy : diagnostic.remedies)
        if (!are_all_given(remedy.options, given)) return as_flags(remedy.options) + " " + remedy.effect;
    }
  return "";
}

/// Finds a number in a text of the form `a=1, b=2`.
/// Output: 0 if it is not there.
double number_in(std::string_view summary, std::string_view name) {
  while (!summary.empty()) {
    const auto [pair, rest] = api::cut(summary, ',');
    const auto [found, value] = api::cut(pair, '=');
    if (trim(found) == name) return parse_real(value).value;
    summary = rest;
  }
  return 0;
}

/// Names what the union dropped and what closes holes, which the proven distance leaves out.
std::string not_counted(const Report& report) {
  const bool are_holes_closed = std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                                            [](const Diagnostic& d) { return d.code == DiagnosticCode::kClosedHole; });
  std::string text;
  if (report.solids && report.solids->dropped > 0) text += ", without what the union dropped";
  if (are_holes_closed) text += ", without what closes holes";
  return text;
}

/// Describes a result in one to three lines.
/// Input:  `given` has the options that the user has given. A remedy is not named if all its options are among them.
/// Output: the first line has the numbers of faces, the least angle and the proven distance. The second line says what
///         was given up or missed, if anything was. The third line is the one remedy that would help most, if there is
///         one, as flags. A defect that keeps a mesher from filling the surface goes before the number of faces.
std::vector<std::string> outcome_lines(const Report& report, const api::Fields& given) {
  const DistanceBound bound = report.distance_bound.value_or(DistanceBound{});
  std::vector<std::string> lines{
      first_line(report.input.faces, report.output.faces, report.output.quality.min_angle_deg) +
      "; input and result are at most " + number_text(std::max(bound.output_to_input, bound.input_to_output), 3) +
      " apart (proven" + not_counted(report) + ")"};
  for (std::string line : {missed(report), advice(report, given)})
    if (!line.empty()) lines.push_back(std::move(line));
  return lines;
}

/// Describes the result of a server by its summary (Remesh-Summary) in one line.
std::string outcome_of_summary(std::string_view summary) {
  const auto whole = [&](std::string_view name) { return static_cast<std::uint64_t>(number_in(summary, name)); };
  return first_line(whole("input_faces"), whole("output_faces"), number_in(summary, "min_angle_deg")) + "; " +
         counted(whole("warnings"), "warning", "warnings");
}

struct Arguments {
  std::string input;
  std::string output;
  std::string report;
  std::string batch;  // a folder; it replaces the input
  std::string server;
  std::vector<std::string> compared;  // two meshes; they replace the input
  std::string tolerance;              // the largest distance that is asked for; empty if none is
  bool is_analysis = false;
  bool is_traced = false;
  bool is_quiet = false;
  int workers = 1;
  api::Fields options;  // options by their names in the API
};

/// The command line is incomplete or contradicts itself.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Makes a help text of the form "help text [default]".
std::string option_help(const api::OptionSpec& spec) {
  return std::string(spec.help) + " [" + api::option_text(spec, api::with_defaults({})) + "]";
}

std::string group_heading(api::OptionGroup group) {
  std::string heading(api::group_name(group));
  heading.front() = static_cast<char>(heading.front() - 'a' + 'A');
  return heading;
}

std::string unknown_argument(const std::string& argument) {
  if (!argument.starts_with("--")) return "unexpected argument " + argument;
  const std::string_view name = std::string_view(argument).substr(2, argument.find('=') - 2);
  return "there is no option --" + std::string(name) + "; the nearest is --" +
         with_hyphens(api::nearest_option(with_underscores(name)).name);
}

std::string name_of_output(const std::string& path) { return path == "-" ? "standard output" : path; }

/// Lists the endings of files that can be written, each once.
std::string known_endings() {
  std::string text;
  for (const Format format : kFormats) {
    const std::string name = "." + std::string(file_ending(format));
    if (written_format_from_file_name(name) == format) text.append(text.empty() ? "" : ", ").append(name);
  }
  return text;
}

bool has_unknown_ending(const std::string& path) {
  return std::filesystem::path(path).has_extension() && !written_format_from_file_name(path);
}

/// Lists the formats with the endings of their files, whether they are read and written, and what is in them.
std::string list_of_formats() {
  std::string text =
      "Formats, r: read, w: written, both also with .gz; --report has the lines that go on with a file:\n";
  for (const Format format : kFormats) {
    const FormatSpec& spec = format_spec(format);
    std::string endings;
    for (const std::string_view ending : spec.endings) endings.append(endings.empty() ? "." : " .").append(ending);
    std::string line = "  " + std::string(spec.name);
    line.resize(13, ' ');
    line += endings;
    line.resize(29, ' ');
    line.append(spec.reads.empty() ? "-" : "r").append(spec.about.empty() ? "-  " : "w  ");
    text += line.append(spec.about.empty() ? spec.reads : spec.about) + "\n";
  }
  return text;
}

/// Errors: UsageError - a required path is missing, or two outputs have the same path.
void check_paths(const Arguments& arguments) {
  if (arguments.is_traced && (!arguments.batch.empty() || arguments.is_analysis || !arguments.server.empty()))
    throw UsageError("--trace cannot be combined with --batch, --analyze or --server");
  if (!arguments.batch.empty()) {
    if (arguments.is_analysis) throw UsageError("--analyze cannot be combined with --batch");
    if (!arguments.compared.empty()) throw UsageError("--compare cannot be combined with --batch");
    if (!arguments.input.empty()) throw UsageError("--batch cannot be combined with the input " + arguments.input);
    if (!arguments.server.empty()) throw UsageError("--batch cannot be combined with --server");
    if (arguments.report.empty()) throw UsageError("--batch needs --report, the file for its table");
    if (arguments.output == "-") throw UsageError("with --batch the output is a folder");
    return;
  }
  if (!arguments.compared.empty()) {
    if (!arguments.input.empty()) throw UsageError("--compare cannot be combined with the input " + arguments.input);
    if (!arguments.output.empty() || !arguments.report.empty())
      throw UsageError("--compare cannot be combined with --output or --report: it writes to standard output");
    if (arguments.is_analysis || arguments.is_traced || !arguments.server.empty())
      throw UsageError("--compare cannot be combined with --analyze, --trace or --server");
    return;
  }
  if (!arguments.tolerance.empty()) throw UsageError("--tolerance is for --compare");
  if (arguments.input.empty()) throw UsageError("input is required");
  if (arguments.is_analysis) {
    if (!arguments.output.empty()) throw UsageError("--analyze cannot be combined with --output: it writes no mesh");
    if (!arguments.server.empty()) throw UsageError("--analyze cannot be combined with --server");
    if (arguments.report == "-") throw UsageError("with --analyze the report cannot go to standard output");
    return;
  }
  if (arguments.output.empty()) throw UsageError("--output is required");
  if (arguments.output == arguments.report) {
    throw UsageError("the mesh and the report cannot both go to " + name_of_output(arguments.output));
  }
}

/// Parses the command line into `arguments`.
/// Errors: CLI::ParseError, also for --help and --version; UsageError.
void parse(CLI::App& app, int argc, char** argv, Arguments& arguments) {
  arguments.workers = api::usable_cores();
  app.set_version_flag("--version", std::string("remesh ") + version());
  app.add_option("input", arguments.input, "the mesh to read; - for standard input");
  app.add_option("-o,--output", arguments.output,
                 "the mesh to write; - for standard output; compressed if the name ends in .gz");
  app.add_option("--report", arguments.report, "also write the report, as JSON");
  app.add_flag(
      "--analyze", arguments.is_analysis,
      "write no mesh, but describe the one that is given: its cylinders, cones and other surfaces with their sizes, "
      "its defects, and how many faces a remeshing with these options would make");
  app.add_option(
      "--batch", arguments.batch,
      "remesh every mesh in this folder instead of one input; --report is then a table (CSV) with one line per "
      "file, and -o is a folder and may be left out");
  app.add_option("--compare", arguments.compared,
                 "do not remesh, but print how far two meshes are apart, both ways, as JSON; the bounds are proven")
      ->expected(2)
      ->type_name("A B");
  app.add_option("--tolerance", arguments.tolerance,
                 "with --compare: whether all points are within this distance, in model units; if not, the exit code "
                 "is 3");
  app.add_flag("--trace", arguments.is_traced,
               "print a line for each attempt at a result to standard error: what has failed, and what was decided");
  app.add_flag("-q,--quiet", arguments.is_quiet,
               "print nothing to standard error unless it fails; without it, a few lines say what the result is");
  app.add_option("--server", arguments.server,
                 "let the remeshd at this address do the work, as a job: http://host:8080; the API key is taken from "
                 "REMESH_API_KEY");
  app.add_option("--workers", arguments.workers, "threads that compute; the result does not depend on their number")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();

  std::map<std::string_view, std::string> values;
  std::map<std::string_view, CLI::Option*> flags;
  for (const api::OptionSpec& spec : api::option_table()) {
    flags[spec.name] = app.add_option("--" + with_hyphens(spec.name), values[spec.name], option_help(spec))
                           ->type_name("VALUE")
                           ->group(group_heading(spec.group));
  }
  app.footer(list_of_formats());
  app.allow_extras();
  app.parse(argc, argv);
  if (const auto extras = app.remaining(); !extras.empty()) throw UsageError(unknown_argument(extras.front()));
  check_paths(arguments);
  if (!arguments.server.empty() && app.count("--workers") > 0) {
    throw UsageError("--workers cannot be combined with --server");
  }
  for (const api::OptionSpec& spec : api::option_table()) {
    if (flags[spec.name]->count() == 0) continue;
    if (!arguments.compared.empty())
      throw UsageError("--compare has the one option --tolerance, and not --" + with_hyphens(spec.name));
    arguments.options.emplace_back(spec.name, values[spec.name]);
  }
  if (arguments.batch.empty() && flags["format"]->count() == 0 && has_unknown_ending(arguments.output)) {
    throw UsageError("the ending of " + arguments.output + " does not name a format that can be written; these do: " +
                     known_endings() + ", each also with .gz; or give one with --format");
  }
}

/// The limits of the command line. Without options, the only limit on a mesh is the range of ids. A result is bounded
/// as on a server if the user sets no bound, because needles of 1e7 to 1 would otherwise be refined until memory is
/// full.
api::Limits limits_for(int workers) {
  api::Limits limits;
  limits.decompression.max_bytes = std::numeric_limits<std::uint64_t>::max();
  limits.decompression.max_ratio = 1000;  // slightly less than gzip can reach, so that no file of zeros passes
  limits.input.max_vertices = VertexId::kInvalid;
  limits.input.max_faces = FaceId::kInvalid;
  limits.usual_output_faces = limits.max_output_faces;
  limits.max_output_faces = std::numeric_limits<std::uint64_t>::max();
  limits.workers = workers;
  return limits;
}

// This is set before the signal handlers are installed, and outlives them.
std::atomic<RunControl*> g_interrupted_run{nullptr};
static_assert(std::atomic<RunControl*>::is_always_lock_free);

void interrupt(int) {
  if (RunControl* const run = g_interrupted_run.load()) run->cancel();
}

void stop_on_signals(RunControl& control) {
  g_interrupted_run = &control;
  struct sigaction action {};  // without SA_RESTART, so that a signal also ends waiting for input
  action.sa_handler = interrupt;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);  // a reader that goes away then causes an error of write()
}

/// Prints a line for the user, unless the user wants none.
void tell(const Arguments& arguments, const std::string& line) {
  if (!arguments.is_quiet) std::cerr << "remesh: " + line + "\n";
}

/// Prints the origin, because the coordinates in the output are relative to it.
void tell_origin(const Arguments& arguments, const std::string& origin) {
  tell(arguments, "the written coordinates are relative to the origin " + origin);
}

/// Returns the media type that the ending of the output asks for. If the input has the same ending, the result is
/// empty: the format is then the input's in any case, as text if need be.
std::string accept_of(const Arguments& arguments) {
  const auto format = written_format_from_file_name(arguments.output);
  return format && format != format_from_file_name(arguments.input) ? std::string(media_type(*format)) : "";
}

/// Returns what makes the lines of a progress bar for a run that begins now.
std::function<std::string()> follow(const RunControl& control) {
  const auto progress = std::make_shared<api::OverallProgress>();
  return [progress, &control, start = std::chrono::steady_clock::now()] {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    return progress_line(*progress, control, elapsed.count());
  };
}

void remesh_one(const Arguments& arguments, api::Job job, RunControl& control) {
  job.input_format = format_from_file_name(arguments.input);
  job.accept = accept_of(arguments);
  FileContent mesh = read_file(arguments.input, control);
  job.mesh = mesh.view();
  job.release_mesh = [&] { mesh.release(); };

  if (arguments.is_traced) job.trace = [](const std::string& line) { std::cerr << "remesh: " + line + "\n"; };

  api::RemeshAnswer answer;
  std::vector<std::string> report;
  {
    const ProgressBar progress(follow(control), !arguments.is_quiet);
    answer = api::run_remesh_job(std::move(job), limits_for(arguments.workers), control);
    if (is_gzip_file_name(arguments.output)) answer.body = gzip(answer.body, control);
    if (!arguments.report.empty()) report = api::report_document(answer, control);
    control.check();
  }
  write_file(arguments.output, answer.body);
  if (!arguments.report.empty()) write_file(arguments.report, report);
  for (const std::string& line : outcome_lines(answer.report, arguments.options)) tell(arguments, line);
  if (answer.report.output_origin) tell_origin(arguments, api::origin_text(*answer.report.output_origin));
  for (const Diagnostic& told : answer.report.diagnostics)
    if (told.code == DiagnosticCode::kOutputAsText) tell(arguments, told.message);
}

/// Prints a description of the mesh.
void analyze_one(const Arguments& arguments, api::Job job, RunControl& control) {
  job.input_format = format_from_file_name(arguments.input);
  FileContent mesh = read_file(arguments.input, control);
  job.mesh = mesh.view();
  job.release_mesh = [&] { mesh.release(); };

  api::AnalysisAnswer answer;
  std::vector<std::string> report;
  {
    const ProgressBar progress(follow(control), !arguments.is_quiet);
    answer = api::run_analyze_job(std::move(job), limits_for(arguments.workers), control);
    if (!arguments.report.empty()) report = api::report_document(answer, control);
    control.check();
  }
  const std::string name = arguments.input == "-" ? "standard input" : arguments.input;
  write_file("-", analysis_text(answer.report, name));
  if (!arguments.report.empty()) write_file(arguments.report, report);
}

/// Prints how far two meshes are apart.
/// Input:  `file` - gets the name of what is worked on, for errors.
/// Output: the exit code.
int compare_two(const Arguments& arguments, std::string& file, RunControl& control) {
  api::ComparisonOptions options;
  if (!arguments.tolerance.empty()) options.add("tolerance", arguments.tolerance);
  const api::Limits limits = limits_for(arguments.workers);
  api::ComparisonAnswer answer;
  {
    const ProgressBar progress(follow(control), !arguments.is_quiet);
    const auto read = [&](const std::string& path) {
      file = path;
      FileContent mesh = read_file(path, control);
      api::Job job;
      job.input_format = format_from_file_name(path);
      job.mesh = mesh.view();
      job.release_mesh = [&] { mesh.release(); };
      return api::read_compared(std::move(job), limits, control);
    };
    api::ComparedMesh a = read(arguments.compared[0]);
    api::ComparedMesh b = read(arguments.compared[1]);
    file = arguments.compared[0] + ", " + arguments.compared[1];
    answer = api::compare(std::move(a), std::move(b), options.tolerance(), limits, control);
    control.check();
  }
  write_file("-", api::comparison_document(answer));
  return answer.is_within().value_or(true) ? kDone : kNotWithin;
}

/// Does the same as remesh_one, but on a server.
void remesh_one_remotely(const Arguments& arguments, RunControl& control) {
  RemoteJob job;
  job.server = arguments.server;
  if (const char* key = std::getenv("REMESH_API_KEY")) job.api_key = key;
  if (const auto format = format_from_file_name(arguments.input)) job.content_type = media_type(*format);
  job.accept = accept_of(arguments);
  job.options = arguments.options;
  job.wants_report = !arguments.report.empty();
  const FileContent mesh = read_file(arguments.input, control);
  job.mesh = mesh.view();

  Remote remote(std::move(job));
  RemoteAnswer answer;
  {
    const ProgressBar progress([&] { return remote.progress_line(); }, !arguments.is_quiet);
    answer = remote.run(control);
    if (is_gzip_file_name(arguments.output)) answer.mesh = gzip(answer.mesh, control);
  }
  write_file(arguments.output, answer.mesh);
  if (!arguments.report.empty()) write_file(arguments.report, answer.report);
  tell(arguments, outcome_of_summary(answer.summary));
  if (!answer.origin.empty()) tell_origin(arguments, answer.origin);
}

int remesh_folder(const Arguments& arguments, RunControl& control) {
  const BatchJob job{
      arguments.batch,   arguments.report, arguments.output, arguments.options, limits_for(arguments.workers),
      arguments.is_quiet};
  const BatchOutcome outcome = run_batch(job, control);
  if (outcome.files == 0) std::cerr << "remesh: no mesh found below " << arguments.batch << "\n";
  if (outcome.failed == 0) {
    if (outcome.files > 0)
      tell(arguments, std::to_string(outcome.files) + (outcome.files == 1 ? " file is" : " files are") + " remeshed; " +
                          name_of_output(arguments.report) + " has a line for each");
    return kDone;
  }
  std::cerr << "remesh: " << outcome.failed << " of " << outcome.files << " files failed; "
            << name_of_output(arguments.report) << " says why\n";
  return kFailed;
}

/// Makes a result that does not fit into memory an ordinary error, before the system kills the largest process.
void limit_memory(int workers) {
  // The stacks of threads count in full, although threads use hardly any part of them.
  constexpr std::uint64_t kStack = std::uint64_t{16} << 20;
  api::limit_own_memory(api::usable_memory() / 10 * 9 + kStack * (static_cast<std::uint64_t>(workers) + 4));
}

int run(const Arguments& arguments) {
  static RunControl control;
  stop_on_signals(control);
  // This permits as many threads as were asked for, even if the machine has fewer cores.
  const tbb::global_control parallelism(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(arguments.workers));
  limit_memory(arguments.workers);
  std::string file = arguments.input;
  try {
    if (!arguments.compared.empty()) return compare_two(arguments, file, control);
    api::Job job;
    for (const auto& [name, value] : arguments.options) job.options.add(name, value);
    job.options.check();
    if (!arguments.batch.empty()) return remesh_folder(arguments, control);
    if (!arguments.is_analysis) check_writable(arguments.output);
    if (!arguments.report.empty()) check_writable(arguments.report);
    if (arguments.is_analysis) {
      analyze_one(arguments, std::move(job), control);
    } else if (!arguments.server.empty()) {
      remesh_one_remotely(arguments, control);
    } else {
      remesh_one(arguments, std::move(job), control);
    }
    return kDone;
  } catch (...) {
    const Failure failure = failure_of(std::current_exception(), file);
    std::cerr << "remesh: " << failure.line << "\n";
    return failure.exit_code;
  }
}

}  // namespace
}  // namespace remesh::cli

int main(int argc, char** argv) {
  using namespace remesh::cli;
  // Memory that one stage frees is reused by the next one, instead of being returned to the system. This saves a
  // tenth of the time of a large mesh. A process that does one thing and ends need not return memory.
  mallopt(M_MMAP_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  CLI::App app{
      "Re-triangulates a surface mesh. The shape stays the same, and each flat patch becomes a Delaunay triangulation.",
      "remesh"};
  Arguments arguments;
  try {
    parse(app, argc, argv, arguments);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    std::cerr << "remesh: " << error.what() << "; see remesh --help\n";
    return kMisused;
  } catch (const UsageError& error) {
    std::cerr << "remesh: " << error.what() << "; see remesh --help\n";
    return kMisused;
  }
  return run(arguments);
}
