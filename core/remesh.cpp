#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stopwatch.h"
#include "core/output/run/attempts.h"
#include "core/output/run/learn.h"
#include "core/output/run/run_report.h"
#include "core/output/run/trace.h"

namespace remesh {
namespace {

/// Makes attempts until one is the answer, and learns from each what to decide for the next.
/// Input:  `may_go_on(decisions, effort)` is asked before each attempt.
/// Output: the decisions that have led to the answer; empty if `may_go_on` has said no.
/// Errors: those of Attempts::failure - nothing is left that could be tried.
template <class MayGoOn>
std::optional<Decisions> find_answer(Attempts& attempts, const decltype(RunSettings::trace)& trace,
                                     const MayGoOn& may_go_on) {
  Decisions decisions = attempts.first_decisions();
  Effort effort;
  for (int number = 1; may_go_on(decisions, effort); ++number) {
    const Outcome outcome = attempts.attempt(decisions, effort);
    const Effort before = std::exchange(effort, spent(effort, decisions, outcome));
    std::optional<Decisions> next = learn(decisions, outcome, effort);
    // The next attempt would end as this one has, and so would all that follow.
    if (next && *next == decisions && effort == before) next.reset();
    if (trace) trace(line_of_trace(number, decisions, outcome, next));
    if (!next && outcome.end != Outcome::End::kVerified) throw attempts.failure(outcome);
    if (!next) return decisions;
    if (next->mending != decisions.mending) effort = for_another_surface(effort);
    decisions = *std::move(next);
  }
  return std::nullopt;
}

/// A surface that was remeshed to count its faces.
struct Counted {
  MadeFaces faces;
  Decisions decisions;  ///< those that have led to the faces
};

/// Divides the surface into patches, as the first attempts would.
/// Input: what a remeshing has made, if it is known.
Report analyze_once(Attempts attempts, std::optional<Counted> counted) {
  Decisions decisions = attempts.first_decisions();
  for (;;) {
    const Outcome outcome = attempts.divide(decisions);
    if (outcome.end != Outcome::End::kSurfaceReplaced) break;
    decisions = *learn(decisions, outcome, {});
  }
  if (!counted) return make_analysis(attempts.take_products(), std::nullopt);
  const Decisions& made_by = counted->decisions;
  const bool are_patches_same =
      made_by.mending == decisions.mending && made_by.rungs == decisions.rungs && made_by.curved == decisions.curved;
  if (!are_patches_same) counted->faces.of_patch.clear();
  return make_analysis(attempts.take_products(), std::move(counted->faces));
}

/// Surfaces of no more triangles are remeshed to count the faces. A limit that keeps faces in proportion to so few
/// triangles (Goals::faces_without_min_edge) is below kMaxCounted.
constexpr std::size_t kFewTriangles = 10000;
/// Faces are counted up to this number, and no more than so many attempts are made for that.
constexpr std::uint64_t kMaxCounted = 1 << 19;
constexpr int kMaxAttempts = 40;

/// Counts the faces that a remeshing makes of a small surface, by remeshing it. A prediction cannot know which floor is
/// found and which patches fail.
/// Output: nothing if that takes too long or leads to no answer, or if the limit on faces would change the answer.
std::optional<Counted> count_by_remeshing(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                                          RunControl& control) {
  Options limited = options;
  const std::uint64_t most = options.max_output_faces.value_or(Goals::kNoLimit);
  limited.max_output_faces = std::min(most, kMaxCounted);
  int attempts_left = kMaxAttempts;
  // With the limit, budgets, sizes and what counts as much work in vain are others than without.
  const auto may_go_on = [&](const Decisions& decisions, const Effort& effort) {
    const bool is_limited =
        decisions.refinement.budget || decisions.refinement.coarsest > 0 || effort.triangles > kMaxCounted / 2;
    return attempts_left-- > 0 && (most <= kMaxCounted || !is_limited);
  };
  try {
    Attempts attempts(input, limited, settings.storage, {}, control);
    const std::optional<Decisions> found = find_answer(attempts, {}, may_go_on);
    if (!found) return std::nullopt;
    Counted counted{{0, {}, found->refinement}, *found};
    const std::unique_ptr<RunProducts> products = attempts.take_products();
    for (const PatchMesh& patch : products->candidate.triangulated.meshes) {
      counted.faces.faces += patch.mesh.triangle_count();
      counted.faces.of_patch.push_back(static_cast<float>(patch.mesh.triangle_count()));
    }
    return counted;
  } catch (const Error& error) {
    if (error.code == Code::kCancelled || error.code == Code::kTimeout) throw;
  } catch (const std::bad_alloc&) {
    // A prediction needs less memory.
  }
  return std::nullopt;
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
    find_answer(attempts, settings.trace, [](const Decisions&, const Effort&) { return true; });
    return make_result(attempts.take_products(), settings);
  });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings), [&] {
    std::optional<Counted> counted;
    double counting_ms = 0;
    if (input.corners.size() <= 2 * input.face_count() + kFewTriangles) {
      Stopwatch watch(control);
      watch.enter(Stage::kRefinement);
      counted = count_by_remeshing(input, options, settings, control);
      counting_ms = watch.finish().front().ms;
    }
    Report report =
        analyze_once(Attempts(input, options, settings.storage, std::move(diagnostics), control), std::move(counted));
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
