/// Shares out the triangles that a refinement may make.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/refinement/goals/goals.h"

namespace remesh {

/// The number of faces that stands for "no limit".
inline constexpr std::uint64_t kNoFaceLimit = Goals::kNoLimit;

/// The triangles that a refinement may make in all, and the share of each patch in a round.
class FaceBudget {
 public:
  /// Input: `max_faces` is the budget. Refinement makes no more triangles than `max_faces`, and it may be given up as
  ///        soon as there are more than `max_made`. Either may be kNoFaceLimit.
  FaceBudget(std::uint64_t max_faces, std::uint64_t max_made) : max_faces_(max_faces), max_made_(max_made) {}

  std::uint64_t max_faces() const { return max_faces_; }
  std::uint64_t max_made() const { return max_made_; }
  bool is_limited() const { return max_faces_ != kNoFaceLimit; }
  bool is_counted() const { return max_made_ != kNoFaceLimit; }

  /// Decides how many triangles each patch that has work may make in the next round. This depends on the state at the
  /// barrier alone.
  /// Input: `faces` is the number of triangles so far, plus those that are certain to come. `work` has the share of
  ///        work of each patch, at least 1. `are_all_new` is true if no patch has begun.
  void share_out(std::uint64_t faces, std::span<const double> work, bool are_all_new, RunControl& control);
  /// Returns the share of the i-th patch, or kNoFaceLimit.
  std::uint64_t share(std::size_t i) const { return shares_[i]; }
  /// Returns whether the budget, when it was last shared out, was too small for another round.
  bool is_spent() const { return is_limited() && left_ < kWorthwhile; }
  /// Returns whether this number of triangles leaves at least this part of the budget.
  bool has_room_for_more(std::uint64_t faces, double part) const {
    return static_cast<double>(faces) <= (1 - part) * static_cast<double>(max_faces_);
  }

  /// The following functions count the triangles that are made. Any thread may call them. During turns the count only
  /// grows, and each turn adds the same whenever it runs. So whether there are too many triangles does not depend on
  /// the threads.
  void set_made(std::uint64_t faces) { made_ = faces; }
  void add_made(std::uint64_t faces) { made_ += faces; }
  bool is_too_much_made() const { return made_ > max_made_; }

 private:
  /// The number of triangles that mending one or two bad ones may take.
  static constexpr std::uint64_t kWorthwhile = 16;

  const std::uint64_t max_faces_, max_made_;
  std::uint64_t left_ = kNoFaceLimit;  ///< the rest of the budget when it was last shared out
  std::vector<std::uint64_t> shares_;
  /// The number of triangles at the last barrier, plus at least those that turns have made since then.
  std::atomic<std::uint64_t> made_ = 0;
};

}  // namespace remesh
