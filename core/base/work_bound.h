/// Bounds on the work of stages. Work is counted in steps and never in seconds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/base/run_control.h"

namespace remesh {

/// Counts the steps of a stage against a bound. A stage that has spent its bound continues with a coarser answer and
/// reports this. Steps are counted where all threads have come together, or within a piece of work that one thread does
/// alone. So the answer is the same on every machine and for any number of threads.
class WorkBound {
 public:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  /// Input: with `control`, long work that is counted here can be asked to stop.
  explicit WorkBound(std::uint64_t max_steps = kNone, const RunControl* control = nullptr)
      : max_steps_(max_steps), control_(control) {}

  void take(std::uint64_t steps) { taken_ += std::min(steps, kNone - taken_); }
  std::uint64_t taken() const { return taken_; }
  /// Without a bound, kNone steps are always left.
  std::uint64_t left() const { return max_steps_ == kNone ? kNone : max_steps_ - std::min(max_steps_, taken_); }
  bool is_spent() const { return left() == 0; }
  /// Errors: kCancelled, kTimeout - asked to stop.
  void check() const {
    if (control_ != nullptr) control_->check();
  }

 private:
  std::uint64_t max_steps_;
  std::uint64_t taken_ = 0;
  const RunControl* control_;
};

/// This is a row of the table of bounds: a number of steps for each face of the input and for each face that the output
/// may have, times the logarithm of their number, and some steps that are always allowed.
struct StageWork {
  enum class Growth { kTimesLog, kLinear };

  std::uint64_t per_input_face, per_output_face, always;
  Growth growth = Growth::kTimesLog;

  constexpr std::uint64_t steps(std::uint64_t input, std::uint64_t output) const {
    // From this number of faces on, there is no limit. Below it, the products that follow do not overflow.
    constexpr std::uint64_t kMany = std::uint64_t{1} << 36;
    if (input >= kMany || output >= kMany) return WorkBound::kNone;
    std::uint64_t log = 1;
    while (growth == Growth::kTimesLog && (input + output) >> log != 0) ++log;
    return always + log * (input * per_input_face + output * per_output_face);
  }
};

/// Bounds the searches for gaps from which the size field is computed. A step is one box that a search visits. Good
/// surfaces take 100 to 400 steps for each place that gets a size of its own, and have fewer such places than faces in
/// the output.
inline constexpr StageWork kWorkOfSizes{128, 1, 1 << 20};

/// Returns the max number of steps of the next search for gaps, if the searches before it in the run took `earlier`
/// steps and a single search may take `max_steps`. The search is repeated when patches have changed. All these searches
/// together take at most 5/4 of `max_steps`, but each may always take 1/8 of `max_steps`. Searches that only predict
/// the effect of other options do not count.
constexpr std::uint64_t work_of_sizes_after(std::uint64_t earlier, std::uint64_t max_steps) {
  if (max_steps == WorkBound::kNone) return max_steps;
  const std::uint64_t all = max_steps + max_steps / 4;
  return std::clamp(all - std::min(all, earlier), max_steps / 8, max_steps);
}

/// Bounds the search for the smallest gap of the whole surface, from the corners of patches and then from each
/// triangle. A step is one box. Good surfaces take up to 850 steps for a triangle, and for most triangles fewer than
/// 200.
inline constexpr StageWork kWorkOfSmallestGap{64, 1, 1 << 18};

/// Bounds the searches for gaps that find the triangles that are larger than the gaps beside them. A step is one box.
/// On good surfaces, a triangle takes up to 20 steps times the logarithm if its patch has many triangles, and up to 150
/// in a patch of one or two triangles.
inline constexpr StageWork kWorkOfMisses{0, 64, 1 << 22};

/// Bounds the refinement of one patch, in proportion to its present number of triangles. A step is one triangle that is
/// treated, or eight triangles that walks and cavities visit for one point. Good patches take fewer than 17 steps for
/// each triangle.
inline constexpr StageWork kWorkOfPatch{0, 4, 1 << 10};

/// The steps that all patches together may take above `kWorkOfPatch`. A patch that needs more than its share of them
/// waits for the next round, so that many bad patches take no longer than one.
inline constexpr std::uint64_t kWorkAboveBounds = 1 << 20;

/// Bounds all attempts to refine a surface. A step is one triangle of an attempt. So after an attempt with the max
/// number of faces has failed, attempts with fewer faces are still possible, and attempts with few faces can be
/// repeated often.
inline constexpr StageWork kWorkOfAttempts{0, 1, 1 << 15, StageWork::Growth::kLinear};

/// The max number of triangles of attempts that failed the check, for the number of triangles that the patches had
/// before refinement. Beyond it, nothing is refined until a result passes. It applies where it is less than half of
/// kWorkOfAttempts: a limit on faces may be far above the size of attempts, and then does not tell how much work
/// failures are worth.
inline constexpr StageWork kWorkInVain{16, 0, 1 << 15, StageWork::Growth::kLinear};

/// The number of triangles that all attempts may refine before the faces of frozen patches stay frozen after a step of
/// the ladder. Before that, each step of the ladder needs one attempt to find these faces again.
inline constexpr std::uint64_t kWorkBeforeFrozenStay = 1 << 19;

}  // namespace remesh
