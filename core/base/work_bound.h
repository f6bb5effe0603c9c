/// Bounds on the work of stages. They are counted in steps and never in seconds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/run_control.h"

namespace remesh {

/// Counts the steps of a stage against a bound. A stage whose bound is spent goes on with a coarser answer and tells
/// so. Steps are counted where all threads have come together, or within a piece of work that one thread does alone. So
/// the answer is the same on every machine and for any number of threads.
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
    // This many faces stand for no limit. With fewer, the products below are still numbers.
    constexpr std::uint64_t kMany = std::uint64_t{1} << 36;
    if (input >= kMany || output >= kMany) return WorkBound::kNone;
    std::uint64_t log = 1;
    while (growth == Growth::kTimesLog && (input + output) >> log != 0) ++log;
    return always + log * (input * per_input_face + output * per_output_face);
  }
};

/// The searches for gaps from which sizes are found. A step is a box that a search looks at.
/// Good surfaces take 100 to 400 steps for each place that gets a size of its own, and have fewer such places than
/// faces in the output.
inline constexpr StageWork kWorkOfSizes{128, 1, 1 << 20};

/// Returns the steps of a search for gaps if those before it in the run have taken `earlier` steps and one alone may
/// take `max_steps`. Sizes are looked for again when the patches have changed. All searches for sizes that refinement
/// aims at take no more steps together than one and a quarter of one may, apart from an eighth for each. Searches that
/// only predict what other options would lead to do not count.
constexpr std::uint64_t work_of_sizes_after(std::uint64_t earlier, std::uint64_t max_steps) {
  if (max_steps == WorkBound::kNone) return max_steps;
  const std::uint64_t all = max_steps + max_steps / 4;
  return std::clamp(all - std::min(all, earlier), max_steps / 8, max_steps);
}

/// The search for the smallest gap of the whole surface, from the corners of patches and from one triangle after the
/// other. A step is a box. Good surfaces take up to 850 steps for each triangle, most of them fewer than 200.
inline constexpr StageWork kWorkOfSmallestGap{64, 1, 1 << 18};

/// The searches for gaps that tell which triangles are larger than the gaps beside them. A step is a box. Where patches
/// have many triangles, these take up to 20 steps each on good surfaces, times the logarithm. In patches of one or two
/// triangles, these take up to 150.
inline constexpr StageWork kWorkOfMisses{0, 64, 1 << 22};

/// The refinement of one patch, compared with the triangles that it has so far. A step is a triangle that is treated,
/// or eight triangles that walks and cavities go through for one point. Good patches take fewer than 17 steps for each
/// triangle.
inline constexpr StageWork kWorkOfPatch{0, 4, 1 << 10};

/// The steps that all patches together may take above these bounds. A patch that needs more of them than its share
/// waits for the next round, so that many bad patches take no longer than one.
inline constexpr std::uint64_t kWorkAboveBounds = 1 << 20;

/// All attempts to refine a surface. A step is a triangle of an attempt. So an attempt that fails with all faces that
/// are allowed can be repeated with a few of them, and one with few faces can be repeated often.
inline constexpr StageWork kWorkOfAttempts{0, 1, 1 << 15, StageWork::Growth::kLinear};

/// The triangles of attempts that failed the check after which nothing is refined until a result passes, for the
/// triangles that the patches had before refinement. It counts where it is less than half of kWorkOfAttempts: a limit
/// on faces may be far above what attempts make, and is then no measure of the work that failures are worth.
inline constexpr StageWork kWorkInVain{16, 0, 1 << 15, StageWork::Growth::kLinear};

/// The triangles that all attempts may refine before faces of frozen patches stay frozen after a step of the ladder.
/// Each step would otherwise need one attempt to find them again.
inline constexpr std::uint64_t kWorkBeforeFrozenStay = 1 << 19;

}  // namespace remesh
