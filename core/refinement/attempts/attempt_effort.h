/// Decides what the next attempt to refine a surface refines, by the work that attempts have taken.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/work_bound.h"
#include "core/geometry/intersections/search_limits.h"

namespace remesh {

/// The work of all attempts at one surface. A step is a triangle of a complete attempt. If half of it is spent on
/// results that failed the check, the next attempts refine nothing, until one of them passes. Then all is refined that
/// has never failed. The steps of searches for intersections in the checks have a bound of their own. Searches of the
/// usual length do not come near it.
/// Source: rules.md, Ladder.
class AttemptEffort {
 public:
  struct Taken {
    std::uint64_t triangles = 0;     ///< of complete attempts
    std::uint64_t search_steps = 0;  ///< of the searches for intersections in their checks
    std::uint64_t largest = 0;       ///< the triangles of the largest attempt
    std::uint64_t size_steps = 0;    ///< of the searches for gaps, from which sizes are found
  };

  /// Input: `max_faces` is the limit on the faces of the result. `taken` is the work that attempts took before the
  ///        surface's faces were mended anew; their results were wrong.
  AttemptEffort(std::uint64_t max_faces, const Taken& taken)
      : max_faces_(max_faces),
        search_steps_(taken.search_steps),
        largest_(taken.largest),
        size_steps_(taken.size_steps),
        wrong_(taken.triangles > 0 ? 1 : 0) {
    work_ = bound();
    work_.take(taken.triangles);
  }

  /// Changes the limit on the faces of the result.
  void set_max_faces(std::uint64_t max_faces) {
    const std::uint64_t taken = work_.taken();
    max_faces_ = max_faces;
    work_ = bound();
    work_.take(taken);
  }

  Taken all_taken() const { return {work_.taken(), search_steps_, largest_, size_steps_}; }
  /// Returns the triangles of all attempts.
  std::uint64_t taken() const { return work_.taken(); }
  std::uint64_t left() const { return work_.left(); }
  /// Takes the triangles of the attempt that has ended.
  void take(std::uint64_t triangles) {
    last_ = triangles;
    largest_ = std::max(largest_, triangles);
    work_.take(triangles);
  }
  /// Takes the steps of the search for intersections in the check of an attempt.
  void take_check(std::uint64_t steps) { search_steps_ += steps; }
  /// Takes the steps of a search for gaps.
  void take_sizes(std::uint64_t steps) { size_steps_ += std::min(steps, WorkBound::kNone - size_steps_); }
  /// Returns the steps of all searches for gaps.
  std::uint64_t size_steps() const { return size_steps_; }
  /// Bounds the work that may be in vain by the triangles that the patches have before refinement.
  void limit_vain_work(std::uint64_t triangles) { max_in_vain_ = kWorkInVain.steps(triangles, 0); }
  /// The last attempt failed by the number of its faces alone, so it does not count.
  void give_back_last() {
    const std::uint64_t others = work_.taken() - std::exchange(last_, 0);
    work_ = bound();
    work_.take(others);
  }
  /// Notes that a result has failed the check.
  void note_wrong() { ++wrong_; }
  bool is_any_wrong() const { return wrong_ > 0; }
  /// Notes that the patches are others.
  void note_other_patches() {
    if (order_ != Order::kAll) order_ = Order::kNothingYet;
    wrong_ = std::max<std::uint64_t>(wrong_, 1);
  }

  /// Must be called before each attempt.
  /// Input: whether patches may be left as they are.
  void begin_attempt(bool may_leave_all) {
    // One failure is often mended at once, whatever it took.
    const bool is_much = wrong_ >= 2 && work_.taken() > max_in_vain_;
    const bool is_in_vain = is_any_wrong() && (is_much || work_.taken() > work_.left()) && !is_spent();
    if (order_ == Order::kAll && may_leave_all && is_in_vain) order_ = Order::kNothingYet;
  }
  /// Returns false if the attempt is to show whether a result passes without any refinement.
  bool has_goals() const { return order_ != Order::kNothingYet; }
  /// Returns whether the attempt that has just passed the check had no goals. Then the next one has them again.
  bool goes_on_with_the_rest() {
    if (order_ != Order::kNothingYet) return false;
    order_ = Order::kRest;
    return true;
  }
  /// Returns whether what has never failed was being refined. Then it is not refined in the next attempt.
  bool gives_up_the_rest() {
    if (order_ != Order::kRest) return false;
    order_ = Order::kGivenUp;
    return true;
  }
  /// Returns whether the attempt has to leave all patches as they are, and all bad triangles are left for that reason.
  bool is_used_up() const { return is_spent() || order_ == Order::kGivenUp; }

 private:
  enum class Order { kAll, kNothingYet, kRest, kGivenUp };
  /// An attempt with fewer triangles is not worth while.
  static constexpr std::uint64_t kMinAttempt = 1 << 10;
  /// The searches for intersections in all checks together may take as many steps as this number of searches in failed
  /// results as large as the largest so far, or of kMinSearched triangles.
  static constexpr std::uint64_t kSearches = 4, kMinSearched = 1 << 15;

  WorkBound bound() const { return WorkBound(kWorkOfAttempts.steps(0, max_faces_)); }
  bool is_spent() const {
    const std::uint64_t searched = std::min(max_faces_, std::max(largest_, kMinSearched));
    return work_.left() < kMinAttempt || search_steps_ > kSearches * SearchLimits::few_steps_for(searched);
  }

  std::uint64_t max_faces_;
  WorkBound work_;
  std::uint64_t last_ = 0;  ///< the work of the last attempt
  std::uint64_t search_steps_;
  std::uint64_t largest_;
  std::uint64_t size_steps_;
  std::uint64_t max_in_vain_ = WorkBound::kNone;
  std::uint64_t wrong_;  ///< the results that have failed the check
  Order order_ = Order::kAll;
};

}  // namespace remesh
