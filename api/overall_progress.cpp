#include "api/overall_progress.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace remesh::api {
namespace {

/// The progress of a usual run at the beginning of each stage, and at its end. Runs that take seconds often refine
/// twice, so the first refinement has less than its usual share. See core/experiments.md, Shares of the stages.
constexpr std::array<double, kStageCount + 1> kBegin{0,    0,    0.02, 0.03, 0.04, 0.05, 0.055, 0.06,
                                                     0.12, 0.15, 0.45, 0.48, 0.9,  0.96, 1};

double begin_of(Stage stage) { return kBegin[static_cast<std::size_t>(stage)]; }
double end_of(Stage stage) { return kBegin[static_cast<std::size_t>(stage) + 1]; }

/// Returns the part of a stage's time that has passed when it says that this fraction of it is done. Refinement counts
/// triangles, most of which are made early.
double share_of_time(Stage stage, double fraction) {
  return stage == Stage::kRefinement ? fraction * fraction : fraction;
}

}  // namespace

double OverallProgress::look(Stage stage, double fraction) {
  const std::lock_guard lock(mutex_);
  has_result_ = has_result_ || stage == Stage::kRefinement || stage == Stage::kAssembly;
  // Before there is a result, it is the input that is searched for intersections.
  if (stage == Stage::kVerify && !has_result_) stage = Stage::kTriangulation;
  if (stage < stage_) {
    shared_out_ = most_;
    from_ = begin_of(stage);
  }
  stage_ = stage;
  const double here =
      begin_of(stage) + (end_of(stage) - begin_of(stage)) * share_of_time(stage, std::clamp(fraction, 0.0, 1.0));
  most_ = std::clamp(shared_out_ + (1 - shared_out_) * (here - from_) / (1 - from_), most_, 1.0);
  return most_;
}

std::optional<double> seconds_left(double overall, double elapsed_s) {
  // Before that, the first stages say hardly anything about the others.
  constexpr double kEnough = 0.1, kEnoughSeconds = 1;
  if (overall < kEnough || elapsed_s < kEnoughSeconds) return std::nullopt;
  return elapsed_s * (1 - overall) / overall;
}

}  // namespace remesh::api
