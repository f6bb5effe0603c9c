/// Counts how many independent numbers show that all numbers of a set are rounded to a step.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {

/// The bits of evidence that a step needs: numbers with a finer step would all be multiples of the claimed one with a
/// probability of at most 2^-18 (4e-6).
///
/// Suppose that the true step is an m-th of the claimed one. A value that was rounded to the true step is a multiple of
/// the claimed one with a chance of 1/m. So n such values agree by chance with a probability of m^-n, which is
/// n * log2(m) bits. Equal values count once, and values that follow from others do not count (see IndependentNumbers).
/// A model's exact dimensions prove nothing either: they agree in any case. But such dimensions are multiples of a
/// coarser decimal step, so only the values that are no multiples of it count. A claim between the true decimal place
/// and that of the dimensions is wrong in one of two ways, by m = 2^a * 5^b:
/// - a > b, for example 0.02 is claimed where the true step is 0.01, and the dimensions are multiples of 0.1. Values
///   that are no multiples of five claimed steps count, with one bit each where m = 2.
/// - a < b, for example 0.05 is claimed where the true step is 0.01, and the dimensions are multiples of 0.1. Values
///   that are odd multiples of the claimed step count, with log2(5) bits each where m = 5.
/// The smaller sum must reach 18 bits. Of 33 values that were rounded at random both sums reach it in 99.9 % of all
/// cases.
inline constexpr int kEvidence = 18;

/// The bits that make a step likely: one in 4,096 such claims may be too coarse.
inline constexpr int kLikely = 12;

/// Collects different absolute values up to the number that is needed. A value that is repeated proves no more.
template <std::size_t kEnough>
class Witnesses {
 public:
  void add(double x) {
    x = std::fabs(x);
    const auto end = values_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (count_ < kEnough && std::find(values_.begin(), end, x) == end) values_[count_++] = x;
  }
  bool add(const Witnesses& others) {
    for (const double x : others.values()) add(x);
    return true;
  }
  std::span<const double> values() const { return std::span(values_).first(count_); }
  std::size_t count() const { return count_; }
  bool are_enough() const { return count_ == kEnough; }

 private:
  std::array<double, kEnough> values_{};
  std::size_t count_ = 0;
};

/// Keeps the lowest of the different numbers that are added. Which ones these are does not depend on the order, and no
/// number between two of them is left out.
class LowestNumbers {
 public:
  void add(std::int64_t n) {
    if (n >= bound_ || (!numbers_.empty() && n == numbers_.back())) return;
    numbers_.push_back(n);
    if (numbers_.size() == 2 * kMax) trim();
  }
  void add(const LowestNumbers& others) {
    for (const std::int64_t n : others.numbers_) add(n);
  }
  std::vector<std::int64_t> sorted() const {
    LowestNumbers copy = *this;
    copy.trim();
    return copy.numbers_;
  }

 private:
  static constexpr std::size_t kMax = 64;

  void trim() {
    sort_unique(numbers_);
    if (numbers_.size() < kMax) return;
    numbers_.resize(kMax);
    bound_ = numbers_.back();
  }

  std::vector<std::int64_t> numbers_;
  std::int64_t bound_ = std::numeric_limits<std::int64_t>::max();
};

/// Counts the numbers of a set that do not follow from other numbers of the set. The count reads the gaps between the
/// numbers from the lowest on, one coordinate after another. A gap counts unless it belongs to a run of gaps that
/// occurred before, in the same order or in the opposite one. Such a run comes from a regular grid, a circle's other
/// half, the same circle along another axis, or the next one of many equal holes. The first number of each coordinate
/// counts, too.
///
/// Runs also repeat by chance if the gaps have few sizes. With 64 numbers per coordinate, there are 2^14 pairs of
/// places where two equal runs may begin. So a run is taken for a copy only if its probability is below 2^-14.
class IndependentNumbers {
 public:
  /// `spacing(n)` is the mean distance of neighbouring possible values near n.
  template <class Spacing>
  void add(const std::vector<std::int64_t>& sorted, const Spacing& spacing) {
    if (sorted.empty()) return;
    gaps_.push_back(--separator_);
    for (std::size_t i = 1; i < sorted.size(); ++i) {
      gaps_.push_back(sorted[i] - sorted[i - 1]);
      log_ += std::log2(static_cast<double>(gaps_.back()) / spacing(sorted[i]));
    }
  }

  int count() const {
    const auto separators = static_cast<std::size_t>(-separator_);
    if (gaps_.size() == separators) return static_cast<int>(separators);
    // The gaps of random numbers have a geometric distribution. Two of them are equal with a probability of 2^-bits.
    const double mean = std::exp2(log_ / static_cast<double>(gaps_.size() - separators));
    const double bits = mean > 1 ? std::log2(2 * mean - 1) : 0;
    int count = 0;
    for (std::size_t i = 0; i < gaps_.size();) {
      const std::size_t run = longest_run(i);
      const bool is_copy = bits >= kMinBits && static_cast<double>(run) * bits >= kRun;
      count += !is_copy;
      i += is_copy ? run : 1;
    }
    return count;
  }

 private:
  static constexpr double kRun = 14;
  /// Gaps prove nothing if the numbers are so dense that nearly every possible value occurs.
  static constexpr double kMinBits = 1;

  std::size_t longest_run(std::size_t i) const {
    std::size_t longest = 0;
    for (std::size_t j = 0; j < i; ++j) {
      std::size_t along = 0, back = 0;
      while (i + along < gaps_.size() && gaps_[i + along] == gaps_[j + along]) ++along;
      while (i + back < gaps_.size() && back <= j && gaps_[i + back] == gaps_[j - back]) ++back;
      longest = std::max({longest, along, back});
    }
    return longest;
  }

  double log_ = 0;
  std::int64_t separator_ = 0;
  std::vector<std::int64_t> gaps_;  // the gaps of each coordinate follow a negative number that occurs only once
};

/// Numbers of one kind that show a step. The class counts how many of them are different and independent.
template <std::size_t kEnough>
class Signs {
 public:
  /// `place` is x in units that are the same for all numbers.
  void add(double x, std::int64_t place, int axis) {
    different_.add(x);
    lowest_[static_cast<std::size_t>(axis)].add(place);
  }
  void add(const Signs& others) {
    different_.add(others.different_);
    for (std::size_t axis = 0; axis < 3; ++axis) lowest_[axis].add(others.lowest_[axis]);
  }
  template <class Spacing>
  int count(const Spacing& spacing) const {
    IndependentNumbers independent;
    for (const LowestNumbers& of_axis : lowest_) independent.add(of_axis.sorted(), spacing);
    return std::min(static_cast<int>(different_.count()), independent.count());
  }

 private:
  Witnesses<kEnough> different_;
  std::array<LowestNumbers, 3> lowest_;
};

/// The number of independent values that are evidence about a claimed step.
struct Weight {
  int not_of_five = 0;  ///< values that are no multiples of five claimed steps
  int odd = 0;          ///< values that are odd multiples of the claimed step

  /// The bits of evidence that the true step is not finer than the claimed step times 2^-k.
  double bits(int k) const { return std::min(not_of_five * bits_each(k, true), odd * bits_each(k, false)); }

 private:
  /// The bits of one value: log2 of the smallest m = 2^a * 5^b above 2^k with a > b (`are_more_twos`) or a < b
  /// (otherwise).
  static double bits_each(int k, bool are_more_twos) {
    double least = std::numeric_limits<double>::infinity();
    const double log2_of_5 = std::log2(5.0);
    for (int a = 0; a <= k + 1; ++a)
      for (int b = 0; b <= k + 1; ++b) {
        const double log2_of_m = a + b * log2_of_5;
        if ((are_more_twos ? a > b : a < b) && log2_of_m > k) least = std::min(least, log2_of_m);
      }
    return least;
  }
};

/// Collects the values that show a step (see kEvidence).
class Evidence {
 public:
  /// `steps` is x as a number of claimed steps. `place` is x in a unit that is the same for all numbers.
  void add(double x, std::int64_t steps, std::int64_t place, int axis) {
    if (steps % 5 != 0) not_of_five_.add(x, place, axis);
    if (steps % 2 != 0) odd_.add(x, place, axis);
  }
  void add(const Evidence& others) {
    not_of_five_.add(others.not_of_five_);
    odd_.add(others.odd_);
  }
  /// `step(n)` is the step of numbers near the n-th unit, in units.
  template <class Step>
  Weight weight(const Step& step) const {
    const int odd = odd_.count([&](std::int64_t n) { return 2 * step(n); });
    const int not_of_five = not_of_five_.count([&](std::int64_t n) { return 1.25 * step(n); });
    return {not_of_five, odd};
  }

 private:
  Signs<kEvidence> not_of_five_;
  Signs<kEvidence> odd_;
};

}  // namespace remesh
