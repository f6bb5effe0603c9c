#include "tests/mutate/case_run.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "api/job.h"
#include "api/json_reader.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/base/number_text.h"
#include "core/io/mesh_files.h"

namespace remesh::mutate {
namespace {

api::Limits service_limits(const TryLimits& limits, int workers) {
  api::Limits service;
  service.workers = workers;
  service.max_output_faces = limits.max_faces;
  service.usual_output_faces = limits.max_faces;
  return service;
}

api::Job job_of(const Case& c) {
  api::Job job;
  job.mesh = c.bytes;
  if (c.is_format_told) job.input_format = c.format;
  for (const auto& [name, value] : c.options) job.options.add(name, value);
  return job;
}

/// Returns the body without its times, which differ from run to run.
std::string without_times(std::string body) {
  const std::size_t begin = body.rfind("\"timing_ms\":{");
  if (begin == std::string::npos) return body;
  return body.erase(begin, body.find('}', begin) - begin);
}

class Trier {
 public:
  Trier(const Case& c, const TryLimits& limits) : case_(c), limits_(limits) {}

  CaseResult run() {
    const bool is_analysis = case_.trial == Trial::kAnalysis;
    std::optional<api::RemeshAnswer> answer = is_analysis ? analyse() : remesh(case_.workers);
    if (!answer) return std::move(result_);
    judge_answer(*answer);
    if (case_.trial == Trial::kTwice) compare(*answer);
    return std::move(result_);
  }

 private:
  /// Output: the answer, if there was one.
  std::optional<api::RemeshAnswer> remesh(int workers) {
    std::optional<api::RemeshAnswer> answer;
    watch(workers, [&](RunControl& control) {
      answer = api::run_remesh_job(job_of(case_), service_limits(limits_, workers), control);
    });
    return answer;
  }

  std::optional<api::RemeshAnswer> analyse() {
    watch(case_.workers, [&](RunControl& control) {
      api::Job job = job_of(case_);
      job.accept = "application/json";
      const api::AnalysisAnswer answer =
          api::run_analyze_job(std::move(job), service_limits(limits_, case_.workers), control);
      (void)answer;
    });
    return std::nullopt;
  }

  void watch(int workers, const std::function<void(RunControl&)>& work) {
    const bool is_to_be_stopped = case_.trial == Trial::kCancelled;
    const RunEnd end =
        run_watched(work, is_to_be_stopped ? case_.stop_after_s : limits_.time_s, limits_.patience_s, workers);
    result_.seconds += end.wall_s;
    result_.stop_busy_ms = std::max(result_.stop_busy_ms, end.stop_busy_ms);
    result_.outcome = outcome_of(end, is_to_be_stopped);
    if (end.busy_s > limits_.busy_s)
      find("slow", "it took " + shortest_text(end.busy_s) + " s of processor time" +
                       (end.was_stopped ? " and was stopped in the stage " + std::string(stage_name(end.stage)) : ""));
    if (end.ending == Ending::kStrange) find("strange exception", end.strange);
    if (end.ending == Ending::kRefused &&
        (end.error->code == Code::kInternal || end.error->code == Code::kVerificationFailed))
      find(std::string(api::error_name(*end.error)), end.error->what());
    if (!end.was_stopped) return;
    const std::string where = " in the stage " + std::string(stage_name(end.stage));
    // A busy machine makes a run wait, for seconds. A run that waits for itself never ends.
    const bool is_late = end.stop_wall_ms > limits_.stop_ms && end.stop_busy_ms > limits_.stop_ms;
    if (end.ending == Ending::kNever)
      find("hang", "it lived for " + shortest_text(limits_.patience_s) + " s after it was stopped" + where);
    else if (is_late)
      find("late stop", "it lived for " + shortest_text(end.stop_wall_ms) + " ms after it was stopped" + where +
                            ", and worked for " + shortest_text(end.stop_busy_ms) + " ms of them");
  }

  static std::string outcome_of(const RunEnd& end, bool is_to_be_stopped) {
    switch (end.ending) {
      case Ending::kDone: return "accepted";
      case Ending::kOutOfMemory: return "out_of_memory";
      case Ending::kStrange: return "strange exception";
      case Ending::kNever: return "hang";
      case Ending::kRefused: break;
    }
    if (end.error->code == Code::kCancelled) return is_to_be_stopped ? "stopped" : "slow";
    return "refused: " + std::string(api::error_name(*end.error));
  }

  void judge_answer(const api::RemeshAnswer& answer) {
    RunControl control;
    api::OptionReader options;
    const Format format = case_.is_format_told ? case_.format : sniff_format(case_.bytes);
    const ReadResult input = format == Format::kJson ? api::read_json(case_.bytes, {}, control, options)
                                                     : read_mesh(format, case_.bytes, {}, control);
    for (Objection& objection : judge(input.mesh, answer)) result_.findings.push_back(std::move(objection));
  }

  void compare(const api::RemeshAnswer& first) {
    const std::optional<api::RemeshAnswer> second = remesh(3 - case_.workers);
    if (!second && result_.outcome == "slow") return;
    if (!second)
      find("not deterministic", "with another number of workers it ended with " + result_.outcome);
    else if (without_times(first.body) != without_times(second->body))
      find("not deterministic", "with another number of workers the bytes differ");
  }

  void find(std::string kind, std::string text) { result_.findings.push_back({std::move(kind), std::move(text)}); }

  const Case& case_;
  const TryLimits& limits_;
  CaseResult result_;
};

}  // namespace

CaseResult try_case(const Case& c, const TryLimits& limits) {
  // Options are refused before the mesh is read.
  try {
    job_of(c);
  } catch (const Error& error) {
    return {"refused: " + std::string(api::error_name(error)), 0, {}, 0};
  }
  return Trier(c, limits).run();
}

}  // namespace remesh::mutate
