#include "core/refinement/goals/face_budget.h"

#include <algorithm>

#include "core/base/stoppable.h"

namespace remesh {

// Before any patch has begun, the budget is shared out in proportion to the predicted faces, so that lattices fit.
// Later, half of it is shared out by the work that waits and half evenly: one bad triangle may lead to a thousand
// others, and a patch that is stopped only by its share continues in another round.
void FaceBudget::share_out(std::uint64_t faces, std::span<const double> work, bool are_all_new, RunControl& control) {
  shares_.assign(work.size(), kNoFaceLimit);
  if (!is_limited()) return;
  double all_work = 0;
  for (const double w : work) all_work += w;
  // A step may make a few more faces than its share has left.
  constexpr std::uint64_t kLastStep = 1;
  faces += kLastStep * work.size();
  left_ = max_faces_ - std::min(max_faces_, faces);
  // If little is left for each patch, only the first patches get a share, which is large enough to be worth a round.
  if (left_ / work.size() < kWorthwhile) {
    std::fill(shares_.begin(), shares_.end(), 0);
    std::fill_n(shares_.begin(), left_ / kWorthwhile, kWorthwhile);
    return;
  }
  const auto left = static_cast<double>(left_);
  const double even = are_all_new ? 1.0 / 8 : 1.0 / 2;
  StopCheck check(control);
  for (std::size_t i = 0; i < work.size(); ++i) {
    check();
    shares_[i] = static_cast<std::uint64_t>((1 - even) * left * work[i] / all_work) +
                 static_cast<std::uint64_t>(even * left / static_cast<double>(work.size()));
  }
}

}  // namespace remesh
