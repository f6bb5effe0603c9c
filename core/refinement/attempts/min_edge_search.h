/// Finds the min edge length that keeps a default answer in proportion to the input.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/refinement/goals/goals.h"

namespace remesh {

/// Looks for the lowest min edge length with which there are no more than Goals::faces_without_min_edge faces. It is
/// raised in large steps until a result fits. If that result has less than half of the faces, lengths between it and
/// the last one that was too low are tried, each time the geometric mean of the two. The lowest one that fits is taken.
/// Holds:  the lengths depend on the numbers of faces alone.
/// Cost:   up to kHighest there are log2(kHighest) + 1 lengths to be tried, then kMaxMeans of them, and one again.
/// Source: experiments.md, Floor of a default answer.
class MinEdgeSearch {
 public:
  /// Input: the goals as they were asked for.
  explicit MinEdgeSearch(const Goals& goals)
      : asked_(goals.min_edge_length),
        lowest_(goals.lowest_min_edge),
        faces_(goals.faces_without_min_edge),
        length_(goals.min_edge_length) {}

  /// Returns a search that begins with the length of this one, for another surface that was made of the same input.
  MinEdgeSearch again() const {
    MinEdgeSearch search = *this;
    search.too_low_ = search.fits_ = 0;
    search.means_left_ = kMaxMeans;
    search.is_settled_ = length_ > asked_;
    search.is_fit_ = false;
    return search;
  }
  bool operator==(const MinEdgeSearch&) const = default;

  /// Returns the length for the next attempt, in model units.
  double min_edge_length() const { return length_; }
  /// Returns the length that was asked for, in model units.
  double asked() const { return asked_; }
  /// Returns whether there is another length to be tried if there are too many faces with this one.
  bool may_go_on() const { return fits_ > 0 || length_ < kHighest * lowest_; }
  /// Returns whether a result has shown that this length fits, or a larger one.
  bool is_known_to_fit() const { return fits_ > 0 || is_fit_; }
  /// Returns whether another length may be tried although a result fits with this one.
  bool may_try_another() const { return !is_settled_ && too_low_ > 0; }
  /// Records that there would be too many faces with this length, and goes on to the next one.
  /// Input: the shortest edge that refinement made with this length; 0 if it is not known. Lengths below half of it
  ///        would hardly change anything, so they are too low as well.
  void record_too_many(double shortest = 0) {
    is_fit_ = false;
    too_low_ = length_;
    if (fits_ > 0) return go_between();
    if (length_ < lowest_) {
      length_ = lowest_;
      return;
    }
    for (length_ *= step(); length_ < shortest / 2 && may_go_on(); length_ *= step()) too_low_ = length_;
  }
  /// Records that a result with this length has so many faces, which are not too many.
  /// Output: whether another length is to be tried.
  bool record_fit(std::uint64_t faces) {
    if (is_settled_) return false;
    const double tried = fits_ = length_;
    if (!(too_low_ > 0) || faces >= faces_ / 2) means_left_ = 0;
    go_between();
    return length_ != tried;
  }

 private:
  /// The length is raised by the first of these factors, or by the second if more than kManyFaces faces are in
  /// proportion, so that each attempt takes seconds. It is not raised beyond kHighest times the lowest.
  static constexpr double kStep = 2, kLargeStep = 4, kManyFaces = 0x1p17, kHighest = 0x1p16;
  /// After this number of means, a length that is lower by a twentieth is too low.
  static constexpr int kMaxMeans = 4;

  double step() const { return static_cast<double>(faces_) > kManyFaces ? kLargeStep : kStep; }
  void go_between() {
    if (means_left_-- > 0) {
      length_ = too_low_ * std::sqrt(fits_ / too_low_);
      return;
    }
    length_ = fits_;
    fits_ = 0;
    is_settled_ = is_fit_ = true;
  }

  double asked_;
  double lowest_;
  std::uint64_t faces_;  ///< no more than these are in proportion
  double length_;
  double too_low_ = 0;  ///< the highest length that was too low; 0: none was
  double fits_ = 0;     ///< the lowest length that fits, while others are still tried
  int means_left_ = kMaxMeans;
  bool is_fit_ = false;      ///< a result has shown that the length fits
  bool is_settled_ = false;  ///< the length is raised if it turns out to be too low, but no other one is looked for
};

}  // namespace remesh
