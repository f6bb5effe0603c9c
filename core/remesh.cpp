#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/output/run/attempts.h"
#include "core/output/run/learn.h"
#include "core/output/run/run_report.h"
#include "core/output/run/trace.h"

namespace remesh {
namespace {

/// Makes attempts until one is the answer, and learns from each what to decide for the next.
/// Errors: kVerificationFailed - nothing is left that could be tried.
Result remesh_by_attempts(Attempts attempts, const RunSettings& settings) {
  Decisions decisions = attempts.first_decisions();
  Effort effort;
  for (int number = 1;; ++number) {
    const Outcome outcome = attempts.attempt(decisions, effort);
    effort = spent(effort, decisions, outcome);
    std::optional<Decisions> next = learn(decisions, outcome, effort);
    if (settings.trace) settings.trace(line_of_trace(number, decisions, outcome, next));
    if (!next && outcome.end != Outcome::End::kVerified) throw attempts.failure(outcome);
    if (!next) return make_result(attempts.take_products(), settings);
    if (next->mending != decisions.mending) effort = for_another_surface(effort);
    decisions = *std::move(next);
  }
}

/// Divides the surface into patches, as the first attempts would.
Report analyze_once(Attempts attempts) {
  Decisions decisions = attempts.first_decisions();
  for (;;) {
    const Outcome outcome = attempts.divide(decisions);
    if (outcome.end != Outcome::End::kSurfaceReplaced) return make_analysis(attempts.take_products());
    decisions = *learn(decisions, outcome, {});
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
    return remesh_by_attempts(Attempts(input, options, settings.storage, std::move(diagnostics), control), settings);
  });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings), [&] {
    return analyze_once(Attempts(input, options, settings.storage, std::move(diagnostics), control));
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
