#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stopwatch.h"
#include "core/base/work_bound.h"
#include "core/output/run/attempts.h"
#include "core/output/run/learn.h"
#include "core/output/run/run_report.h"
#include "core/output/run/trace.h"

namespace remesh {
namespace {

/// Makes attempts until one is the answer, and learns from each what to decide for the next.
/// Output: the decisions that have led to the answer; empty if the attempts have made more than `most` triangles.
/// Errors: kVerificationFailed - nothing is left that could be tried.
std::optional<Decisions> find_answer(Attempts& attempts, std::uint64_t most, const RunSettings& settings) {
  Decisions decisions = attempts.first_decisions();
  Effort effort;
  std::uint64_t made = 0;
  for (int number = 1; made <= most; ++number) {
    const Outcome outcome = attempts.attempt(decisions, effort);
    made += outcome.triangles;
    effort = spent(effort, decisions, outcome);
    std::optional<Decisions> next = learn(decisions, outcome, effort);
    if (settings.trace) settings.trace(line_of_trace(number, decisions, outcome, next));
    if (!next && outcome.end != Outcome::End::kVerified) throw attempts.failure(outcome);
    if (!next) return decisions;
    if (next->mending != decisions.mending) effort = for_another_surface(effort);
    decisions = *std::move(next);
  }
  return std::nullopt;
}

/// Divides the surface into patches, as the first attempts would.
/// Input: what a remeshing has made, if it is known.
Report analyze_once(Attempts attempts, std::optional<MadeFaces> made) {
  Decisions decisions = attempts.first_decisions();
  for (;;) {
    const Outcome outcome = attempts.divide(decisions);
    if (outcome.end != Outcome::End::kSurfaceReplaced) return make_analysis(attempts.take_products(), std::move(made));
    decisions = *learn(decisions, outcome, {});
  }
}

/// Surfaces of no more triangles are remeshed to count the faces, as long as these are no more than kMaxCounted and
/// all attempts together make no more than kMaxTried. A limit that keeps faces in proportion to so few triangles
/// (Goals::faces_without_min_edge) is below kMaxCounted.
constexpr std::size_t kFewTriangles = 10000;
constexpr std::uint64_t kMaxCounted = 1 << 19, kMaxTried = 1 << 20;

/// Counts the faces that a remeshing makes of a small surface, by remeshing it. A prediction cannot know which floor is
/// found and which patches fail.
/// Output: nothing if the surface is not small, or if that takes too long or leads to no answer.
std::optional<MadeFaces> count_by_remeshing(const PolygonMesh& input, const Options& options,
                                            const RunSettings& settings, RunControl& control) {
  if (input.corners.size() > 2 * input.face_count() + kFewTriangles) return std::nullopt;
  Options limited = options;
  const std::uint64_t most = options.max_output_faces.value_or(WorkBound::kNone);
  limited.max_output_faces = std::min(most, kMaxCounted);
  try {
    Attempts attempts(input, limited, settings.storage, {}, control);
    const std::optional<Decisions> found = find_answer(attempts, kMaxTried, {});
    const bool is_limited = found && found->refinement.budget && most > kMaxCounted;
    if (!found || is_limited) return std::nullopt;
    MadeFaces made{{}, found->refinement};
    const std::unique_ptr<RunProducts> products = attempts.take_products();
    for (const PatchMesh& patch : products->candidate.triangulated.meshes)
      made.of_patch.push_back(static_cast<float>(patch.mesh.triangle_count()));
    return made;
  } catch (const Error& error) {
    const bool is_no_answer = error.code == Code::kOutputTooLarge || error.code == Code::kOutOfMemory ||
                              error.code == Code::kVerificationFailed;
    if (!is_no_answer) throw;
    return std::nullopt;
  }
}

/// An arena with this many threads. The calling thread stores it for later runs. TBB (2021.8) never frees some KB of
/// each arena whose workers did not come in time, so an arena per run would fill the memory of a long-lived process.
tbb::task_arena& reused_arena(int threads) {
  thread_local std::map<int, tbb::task_arena> arenas;
  return arenas.try_emplace(threads, threads).first->second;
}

/// Runs `work` on this many threads. If the caller's arena has as many, it runs there.
template <class Work>
auto in_arena(int threads, Work work) {
  if (tbb::this_task_arena::max_concurrency() == threads) return work();
  return reused_arena(threads).execute(work);
}

int allowed_threads(const RunSettings& settings) {
  const auto most = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  return std::clamp(settings.workers, 1, most);
}

}  // namespace

int thread_count(const PolygonMesh& input, const Options& options, const RunSettings& settings) {
  return !options.refine && input.corners.size() < settings.serial_corners ? 1 : allowed_threads(settings);
}

Result remesh_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                      RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings), [&] {
    Attempts attempts(input, options, settings.storage, std::move(diagnostics), control);
    find_answer(attempts, WorkBound::kNone, settings);
    return make_result(attempts.take_products(), settings);
  });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings), [&] {
    Stopwatch watch(control);
    watch.enter(Stage::kRefinement);
    std::optional<MadeFaces> made = count_by_remeshing(input, options, settings, control);
    const double counting_ms = watch.finish().front().ms;
    Report report =
        analyze_once(Attempts(input, options, settings.storage, std::move(diagnostics), control), std::move(made));
    for (StageTime& time : report.timing_ms)
      if (time.stage == Stage::kRefinement) time.ms += counting_ms;
    return report;
  });
}

verification::TwoWayDistance compare_surfaces(const PolygonMesh& a, const PolygonMesh& b,
                                              std::optional<double> tolerance, const RunSettings& settings,
                                              RunControl& control) {
  const bool is_small = a.corners.size() + b.corners.size() < settings.serial_corners;
  return in_arena(is_small ? 1 : allowed_threads(settings),
                  [&] { return verification::distance_between_meshes(a, b, tolerance, control); });
}

}  // namespace remesh
