/// Finds the floor under the lengths of edges that keeps a default answer in proportion to the input.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/refinement/goals/goals.h"

namespace remesh {

/// Looks for the lowest floor with which there are no more than Goals::faces_without_floor faces. The floor is raised
/// in large steps until a result fits. If that result has less than half of the faces, floors between it and the last
/// one that was too low are tried, each time the geometric mean of the two. The lowest one that fits is taken.
/// Holds:  the floors depend on the numbers of faces alone.
/// Cost:   up to kHighest there are log2(kHighest) + 1 floors to be tried, then kMaxMeans of them, and one again.
/// Source: experiments.md, Floor of a default answer.
class FloorSearch {
 public:
  /// Input: the goals as they were asked for.
  explicit FloorSearch(const Goals& goals)
      : asked_(goals.min_edge_length),
        lowest_(goals.lowest_floor),
        faces_(goals.faces_without_floor),
        floor_(goals.min_edge_length) {}

  /// Returns a search that begins with the floor of this one, for another surface that was made of the same input.
  FloorSearch again() const {
    FloorSearch search = *this;
    search.too_low_ = search.fits_ = 0;
    search.means_left_ = kMaxMeans;
    search.is_settled_ = floor_ > asked_;
    return search;
  }
  bool operator==(const FloorSearch&) const = default;

  /// Returns the floor for the next attempt, in model units.
  double floor() const { return floor_; }
  /// Returns the floor that was asked for, in model units.
  double asked() const { return asked_; }
  /// Returns whether there is another floor to be tried if there are too many faces with this one.
  bool may_go_on() const { return fits_ > 0 || floor_ < kHighest * lowest_; }
  /// Returns whether the floor is one between one that was too low and one that fits.
  bool is_between() const { return fits_ > 0; }
  /// Returns whether another floor may be tried although a result fits with this one.
  bool may_try_another() const { return !is_settled_ && too_low_ > 0; }
  /// Notes that there would be too many faces with this floor, and goes on to the next one.
  void note_too_many() {
    too_low_ = floor_;
    if (fits_ > 0)
      go_between();
    else
      floor_ = floor_ < lowest_ ? lowest_ : step() * floor_;
  }
  /// Notes that a result with this floor has so many faces, which are not too many.
  /// Output: whether another floor is to be tried.
  bool note_fit(std::uint64_t faces) {
    if (is_settled_) return false;
    const double tried = fits_ = floor_;
    if (!(too_low_ > 0) || faces >= faces_ / 2) means_left_ = 0;
    go_between();
    return floor_ != tried;
  }

 private:
  /// A floor is raised by the first of these factors, or by the second if more than kManyFaces faces are in proportion,
  /// so that each attempt takes seconds. It is not raised beyond kHighest times the lowest.
  static constexpr double kStep = 2, kLargeStep = 4, kManyFaces = 0x1p17, kHighest = 0x1p16;
  /// After this number of means, a floor that is lower by a twentieth is too low.
  static constexpr int kMaxMeans = 4;

  double step() const { return static_cast<double>(faces_) > kManyFaces ? kLargeStep : kStep; }
  void go_between() {
    if (means_left_-- > 0) {
      floor_ = too_low_ * std::sqrt(fits_ / too_low_);
      return;
    }
    floor_ = fits_;
    fits_ = 0;
    is_settled_ = true;
  }

  double asked_;
  double lowest_;
  std::uint64_t faces_;  ///< no more than these are in proportion
  double floor_;
  double too_low_ = 0;  ///< the highest floor that was too low; 0: none was
  double fits_ = 0;     ///< the lowest floor that fits, while others are still tried
  int means_left_ = kMaxMeans;
  bool is_settled_ = false;  ///< the floor is raised if it turns out to be too low, but no other one is looked for
};

}  // namespace remesh
