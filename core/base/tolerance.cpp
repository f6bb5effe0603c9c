#include "core/base/tolerance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/rounding_evidence.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The numbers of decimals that are tried: first those of usual numbers, then all whose powers of five are exact
/// doubles. A negative number of decimals means zeros to the left of the point. If all coordinates are short whole
/// numbers, these are taken as they are: `least_in_common` of usual numbers is 0.
struct Decimals {
  int least = 0, least_in_common = 0, most = 0;
};
constexpr Decimals kUsual{-5, 0, 15}, kAny{-22, -22, 22};
/// Two counts that are compared with each other stop at this many numbers.
constexpr std::size_t kRates = 64;
/// If a file has a limited number of significant digits, its large numbers have fewer decimals than its small ones.
/// This many large numbers without the last decimal prove it: each lacks it by chance with a probability of 1/10, so
/// all of them do with one of 1/10^6, and 1/2^18 is enough for a proof here.
constexpr std::size_t kEnoughCoarser = 6;
/// A number counts as short if it has at most this many units.
constexpr double kShort = 4294967296.0;
/// If all coordinates are multiples of one quantum, this proves more than a single short number. So the largest
/// coordinate may have up to this many units of the quantum.
constexpr double kShortTogether = 0x1p45;
/// If the smallest coordinates have more decimals than fit beside the largest one, then only coordinates of at least
/// this fraction of the largest are used to find the number of significant digits.
constexpr double kLarge = 0x1p-12;
/// The number of bits and of units in a float.
constexpr int kFloatBits = 24;
constexpr double kFloatUnits = 0x1p24;

/// A value as units * quantum, where quantum is a power of two over a power of five.
struct Decimal {
  double units = 0;
  double quantum = 0;
};

/// Writes x as an odd number of quanta. The last bits are ignored: they come from the rounding of x and of the product.
Decimal odd_part(double x) {
  // This works on the bits of the number, because reading the digits of all coordinates spends most of its time here.
  constexpr int kBias = 1023, kBits = 52;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  int field = static_cast<int>(bits >> kBits & 0x7ff);
  std::uint64_t mantissa = (bits & 0xfffffffffffffull) | std::uint64_t{1} << kBits;
  if (field == 0) {  // subnormal
    int exponent = 0;
    mantissa = static_cast<std::uint64_t>(std::ldexp(std::fabs(std::frexp(x, &exponent)), kBits + 1));
    field = exponent + kBias - 1;
  }
  // The roundest number within two of the mantissa: the multiple of eight if there is one, otherwise the first multiple
  // of four.
  const std::uint64_t of_eight = (mantissa + 2) & ~std::uint64_t{7};
  const std::uint64_t roundest = of_eight + 2 >= mantissa ? of_eight : (mantissa + 1) & ~std::uint64_t{3};
  const int zeros = std::countr_zero(roundest);
  const int exponent = field - kBias - kBits + zeros;
  const double quantum = exponent + kBias > 0 && exponent <= kBias
                             ? std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << kBits)
                             : std::ldexp(1.0, exponent);
  return {static_cast<double>(roundest >> zeros), quantum};
}

double times_power_of_five(double x, int d) {
  static const auto powers = [] {
    std::array<double, kAny.most + 1> p{};
    p[0] = 1;
    for (std::size_t i = 1; i < p.size(); ++i) p[i] = 5 * p[i - 1];
    return p;
  }();
  // If coordinates differ by hundreds of powers of ten, so do their places.
  for (; d > kAny.most; d -= kAny.most) x *= powers.back();
  for (; d < -kAny.most; d += kAny.most) x /= powers.back();
  return d >= 0 ? x * powers[static_cast<std::size_t>(d)] : x / powers[static_cast<std::size_t>(-d)];
}

/// The form of x with the fewest units. Its quantum is 0 if no form is short.
Decimal shortest(double x, Decimals decimals) {
  Decimal best;
  for (int d = decimals.least; d <= decimals.most; ++d) {
    Decimal form = odd_part(times_power_of_five(x, d));
    if (form.units >= kShort) continue;
    form.quantum = times_power_of_five(form.quantum, -d);
    if (best.quantum == 0 || form.units < best.units) best = form;
  }
  return best;
}

/// The coordinates that carry information, read in blocks in parallel. Coordinates nearer to 0 than any tolerance are
/// left out: they are zeros with a rounding error, such as 6.1e-17 for the cosine of a right angle. The coordinates are
/// scaled by a power of two so that the largest is near 1, because no decimals could be computed for numbers near the
/// largest double.
class Coordinates {
 public:
  Coordinates(std::span<const Vec3> positions, RunControl& control) : positions_(positions), control_(control) {
    Box3 box;
    for (const Box3& part : map_blocks<Box3>(positions.size(), kItemsPerBlock, control, [&](auto begin, auto end) {
           Box3 of_block;
           for (const Vec3& p : positions.subspan(begin, end - begin)) of_block.add(p);
           return of_block;
         }))
      box.add(part);
    if (box.is_empty()) return;
    const auto most_of = [](const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); };
    // The power must have a reciprocal, too.
    constexpr int kMost = 1000;
    if (const double most = std::max(most_of(box.min), most_of(box.max)); most > 0)
      unit_ = std::ldexp(1.0, std::clamp(std::ilogb(most), -kMost, kMost));
    box = {(1 / unit_) * box.min, (1 / unit_) * box.max};
    negligible_ = kToleranceFloor * box.diagonal();
    for (int axis = 0; axis < 3; ++axis) {
      const double most = std::max(std::fabs(box.min[axis]), std::fabs(box.max[axis]));
      largest_[axis] = most > negligible_ ? most : 0;
    }
  }

  /// The length, in the caller's units, of one unit of the scaled coordinates.
  double unit() const { return unit_; }
  /// The largest absolute value of each axis; 0 if all of the axis are negligible.
  const Vec3& largest() const { return largest_; }
  double largest_of_all() const { return std::max({largest_.x, largest_.y, largest_.z}); }

  /// Returns whether `holds` is true of all coordinates.
  template <class Holds>
  bool are_all(const Holds& holds) const {
    return found_in_all(
               0, [&](int&, double x, int) { return holds(x); }, [](int&, int) { return true; })
        .has_value();
  }

  /// Accumulates over all coordinates, from `none` on. `add(found, x, axis)` adds a coordinate to what its block has
  /// found so far. `join(found, other)` adds the result of another block. If either returns false, the whole result is
  /// empty.
  template <class Found, class Add, class Join>
  std::optional<Found> found_in_all(const Found& none, const Add& add, const Join& join) const {
    std::atomic<bool> is_over = false;
    const auto blocks =
        map_blocks<Found>(positions_.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
          Found found = none;
          for (const Vec3& position : positions_.subspan(begin, is_over ? 0 : end - begin)) {
            const Vec3 p = (1 / unit_) * position;
            for (int axis = 0; axis < 3; ++axis)
              if (std::fabs(p[axis]) > negligible_ && !add(found, p[axis], axis)) {
                is_over = true;
                return found;
              }
          }
          return found;
        });
    Found all = none;
    for (const Found& found : blocks)
      if (is_over || !join(all, found)) return std::nullopt;
    return all;
  }

 private:
  std::span<const Vec3> positions_;
  RunControl& control_;
  double unit_ = 1;
  double negligible_ = 0;
  Vec3 largest_;
};

/// The multiples of a step, which is a power of two over a power of five.
struct Lattice {
  int decimals = 0;
  /// A power of two. The lattice's numbers times five to the power of `decimals` are its multiples.
  double quantum = 0;

  double step() const { return times_power_of_five(quantum, -decimals); }
  bool is_within_reach() const { return std::abs(decimals) <= kAny.most; }
  /// Returns whether x is a multiple of the step, apart from its last bits.
  bool holds(double x) const { return odd_part(times_power_of_five(x, decimals)).quantum >= quantum; }
  /// The number of steps in x.
  std::int64_t units(double x) const { return std::llround(times_power_of_five(x, decimals) / quantum); }
  Lattice times(int power_of_two, int power_of_five) const {
    return {decimals - power_of_five, std::ldexp(quantum, power_of_two)};
  }
};

/// The coarsest lattice of d decimals that has all coordinates of at least `cutoff`. Empty if they would not be short
/// in it.
std::optional<Lattice> common_lattice(const Coordinates& coordinates, int d, double cutoff) {
  const double largest = times_power_of_five(coordinates.largest_of_all(), d);
  const auto take = [&](double& least, double quantum) {
    least = std::min(least, quantum);
    return largest / least < kShortTogether;
  };
  const auto quantum = coordinates.found_in_all(
      HUGE_VAL,
      [&](double& least, double x, int) {
        return std::fabs(x) < cutoff || take(least, odd_part(times_power_of_five(x, d)).quantum);
      },
      take);
  if (!quantum) return std::nullopt;
  return Lattice{d, *quantum};
}

/// The common lattice with the fewest decimals. Very long whole numbers have none, because their last digit may well
/// stand left of the point.
std::optional<Lattice> common_lattice(const Coordinates& coordinates, Decimals decimals, double cutoff) {
  for (int d = decimals.least_in_common; d <= decimals.most; ++d) {
    const auto lattice = common_lattice(coordinates, d, cutoff);
    if (!lattice) continue;
    if (d == 0 && decimals.least_in_common == 0 && coordinates.largest_of_all() / lattice->step() > kShort) break;
    return lattice;
  }
  return std::nullopt;
}

/// Steps of which all coordinates are multiples, with the evidence that they were rounded to them.
struct Claim {
  Vec3 steps = {};
  Weight weight = {};
  bool is_in_doubt = false;  ///< for a reason other than the number of values

  bool is_proven() const { return !is_in_doubt && weight.bits(0) >= kEvidence; }
  /// The steps divided by the smallest power of two for which they are likely not too coarse.
  Vec3 likely_steps() const {
    for (int k = 0; k <= kEvidence; ++k)
      if (weight.bits(k) >= kLikely) return std::ldexp(1.0, -k) * steps;
    return {};
  }
};

/// The claim of the lattice that all coordinates share.
struct Fixed {
  Claim claim;
  /// There are numbers that show the last digit and have as many digits as the largest.
  bool is_last_digit_shown = false;
};

int count_digits(std::int64_t n) {
  int digits = 0;
  for (; n > 0; n /= 10) ++digits;
  return digits;
}

Fixed fixed_decimals(const Coordinates& coordinates, const Lattice& lattice) {
  struct Found {
    Evidence evidence;
    std::int64_t largest = 0, largest_odd = 0, largest_not_of_five = 0;
  };
  const auto found = *coordinates.found_in_all(
      Found{},
      [&](Found& f, double x, int axis) {
        const std::int64_t units = lattice.units(x), n = std::abs(units);
        f.evidence.add(x, n, units, axis);
        f.largest = std::max(f.largest, n);
        if (n % 2 != 0) f.largest_odd = std::max(f.largest_odd, n);
        if (n % 5 != 0) f.largest_not_of_five = std::max(f.largest_not_of_five, n);
        return true;
      },
      [](Found& f, const Found& other) {
        f.evidence.add(other.evidence);
        f.largest = std::max(f.largest, other.largest);
        f.largest_odd = std::max(f.largest_odd, other.largest_odd);
        f.largest_not_of_five = std::max(f.largest_not_of_five, other.largest_not_of_five);
        return true;
      });
  const double step = lattice.step();
  const int shown = count_digits(std::min(found.largest_odd, found.largest_not_of_five));
  return {{{step, step, step}, found.evidence.weight([](std::int64_t) { return 1.0; })},
          shown == count_digits(found.largest)};
}

double last_place(double x, int bits) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, exponent - bits);
}

double nearest_float(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return std::ldexp(std::nearbyint(fraction * kFloatUnits), exponent - kFloatBits);
}

Vec3 larger_of(const Vec3& a, const Vec3& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

/// A number of steps, written as units * 2^twos * 5^fives, where neither two nor five divides the units.
struct Factors {
  std::int64_t units = 0;
  int twos = 0, fives = 0;

  Factors() = default;
  explicit Factors(std::int64_t n) : units(n) {
    if (n == 0) return;
    twos = std::countr_zero(static_cast<std::uint64_t>(n));
    units >>= twos;
    for (; units % 5 == 0; units /= 5) ++fives;
  }
  double steps() const { return std::ldexp(times_power_of_five(1, fives), twos); }
};

/// The coordinates of at least `cutoff` that show the most digits of the lattice, in descending order of these digits.
/// There is one for each power of two that the last digit may refer to.
std::vector<Factors> longest_numbers(const Coordinates& coordinates, const Lattice& lattice, double cutoff) {
  constexpr int kMost = 4;
  using Longest = std::array<Factors, 2 * kMost + 1>;
  const auto take = [](Factors& longest, const Factors& other) {
    if (other.units > longest.units || (other.units == longest.units && other.steps() < longest.steps()))
      longest = other;
  };
  const Longest found = *coordinates.found_in_all(
      Longest{},
      [&](Longest& longest, double x, int) {
        if (std::fabs(x) < cutoff) return true;
        const Factors factors(std::abs(lattice.units(x)));
        const int power_of_two = std::clamp(factors.twos - factors.fives, -kMost, kMost);
        take(longest[static_cast<std::size_t>(power_of_two + kMost)], factors);
        return true;
      },
      [&](Longest& longest, const Longest& other) {
        for (std::size_t i = 0; i < longest.size(); ++i) take(longest[i], other[i]);
        return true;
      });
  std::vector<Factors> sorted(found.begin(), found.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.units > b.units; });
  return sorted;
}

/// Significant digits as a rule by which numbers may have been rounded: the place of the last digit depends on the
/// number's size.
class SignificantDigits {
 public:
  /// The number of digits is that of `longest`, a longest number. Its last digit shows to which power of two times ten
  /// the digits refer.
  SignificantDigits(const Lattice& lattice, const Factors& longest)
      : last_(lattice.times(longest.twos, longest.fives)),
        last_step_(last_.step()),
        digits_(count_digits(longest.units)) {
    for (int i = 0; 2 * i < digits_; ++i) half_ *= 10;
  }

  Lattice last() const { return last_; }
  /// The place of the last digit of a number of x's size.
  Lattice place(double x) const { return decimal_place(x, 1 - digits_); }
  /// The largest of the digits' decimal places that is not above the step.
  double not_above(double step) const { return decimal_place(step, 0).step(); }
  /// Returns whether a number needs more than half of the digits that the file writes. A number that needs fewer digits
  /// may be exact, as 1 is, and is then no evidence of rounding.
  /// Input: the number as a multiple of its last digit's place.
  bool is_long(std::int64_t units) const { return units % half_ != 0; }

 private:
  /// The place of x's first digit, shifted by `before` places to the left.
  Lattice decimal_place(double x, int before) const {
    const int e = static_cast<int>(std::floor(std::log10(std::fabs(x) / last_step_ * (1 + 1e-12)))) + before;
    return last_.times(e, e);
  }

  Lattice last_;
  double last_step_;
  int digits_;
  std::int64_t half_ = 1;
};

/// The claim of significant digits.
struct Significant {
  Claim claim;
  /// The largest step of a number that is not exact, which is one that shows one of its last two digits.
  double coarsest = 0;
  bool is_apart = false;  ///< large numbers lack decimals that small ones have, and not by chance
};

/// Tests a rule of significant digits. The result is empty if any coordinate has more digits. All coordinates are
/// multiples of `fixed_step`; it is 0 if there is no such step.
std::optional<Significant> significant_digits(const Coordinates& coordinates, const SignificantDigits& significant,
                                              const Lattice& lattice, double fixed_step) {
  struct Found {
    Evidence evidence;
    Witnesses<kEnoughCoarser> coarser;  // numbers that are coarser than the fixed step by a factor of ten at least
    // The largest steps of numbers that show their last digit, and of numbers that show either of their last two.
    double coarsest_last = 0, coarsest_shown = 0;
    // Counts of the numbers that show their last digit and of those that lack it, in the decade of the largest number
    // and below it.
    Witnesses<kRates> shown, lacking, shown_below, lacking_below;
    Vec3 largest_of_long;
  };
  constexpr double kOverDecimal = 4.99;
  const double least_coarser = fixed_step > 0 ? kOverDecimal * significant.not_above(fixed_step) : 0;
  const Lattice place_of_largest = significant.place(coordinates.largest_of_all());
  if (!place_of_largest.is_within_reach()) return std::nullopt;
  const double lower = 0.5 * place_of_largest.step();
  const auto found = coordinates.found_in_all(
      Found{},
      [&](Found& f, double x, int axis) {
        const Lattice place = significant.place(x);
        // A number that is too small for a place within reach is ignored. If the number is too large, the rule cannot
        // hold.
        if (!place.is_within_reach()) return place.decimals > 0;
        if (!place.holds(x)) return false;
        const std::int64_t units = std::abs(place.units(x));
        f.evidence.add(x, units, lattice.units(x), axis);
        if (units % 10 != 0 && place.step() > least_coarser) f.coarser.add(x);
        if (place.step() < lower)
          (units % 10 != 0 ? f.shown_below : f.lacking_below).add(x);
        else
          (units % 10 != 0 ? f.shown : f.lacking).add(x);
        if (units % 10 != 0) f.coarsest_last = std::max(f.coarsest_last, place.step());
        if (units % 100 != 0 && significant.is_long(units)) f.coarsest_shown = std::max(f.coarsest_shown, place.step());
        if (significant.is_long(units)) f.largest_of_long[axis] = std::max(f.largest_of_long[axis], std::fabs(x));
        return true;
      },
      [](Found& f, const Found& other) {
        f.evidence.add(other.evidence);
        f.coarser.add(other.coarser);
        f.shown.add(other.shown);
        f.lacking.add(other.lacking);
        f.shown_below.add(other.shown_below);
        f.lacking_below.add(other.lacking_below);
        f.coarsest_last = std::max(f.coarsest_last, other.coarsest_last);
        f.coarsest_shown = std::max(f.coarsest_shown, other.coarsest_shown);
        f.largest_of_long = larger_of(f.largest_of_long, other.largest_of_long);
        return true;
      });
  if (!found) return std::nullopt;
  // If digits were limited, small and large numbers would show their last digit equally often. If most large numbers
  // show it and most small ones lack it, then all but a few numbers are exact decimals.
  constexpr std::size_t kFew = 6;
  const auto are_most = [](const auto& some, const auto& others) {
    return some.count() >= kFew && 2 * some.count() > 3 * others.count();
  };
  const bool is_alike = !are_most(found->shown, found->lacking) || !are_most(found->lacking_below, found->shown_below);
  const auto step_near = [&](std::int64_t n) {
    return n == 0 ? 1
                  : std::max(1.0, significant.place(static_cast<double>(n) * lattice.step()).step() / lattice.step());
  };
  // If there are many large numbers and none shows its last digit, they are exact and lack nothing.
  const bool are_large_exact = found->shown.count() == 0 && found->lacking.count() >= kFew;
  const double coarsest = are_large_exact ? found->coarsest_last : found->coarsest_shown;
  Significant result{
      {{}, found->evidence.weight(step_near)}, coarsest, is_alike && (found->coarser.are_enough() || fixed_step == 0)};
  for (int axis = 0; axis < 3; ++axis) {
    const double of_long = found->largest_of_long[axis], largest = of_long > 0 ? of_long : coordinates.largest()[axis];
    const Lattice place = largest > 0 ? significant.place(largest) : Lattice{};
    if (!place.is_within_reach()) return std::nullopt;
    result.claim.steps[axis] = place.step();
    // All numbers of this coordinate lack the last digit that they would have if digits were limited.
    if (of_long > 0 && kOverDecimal * place.step() < fixed_step) result.is_apart = false;
  }
  return result;
}

/// Returns whether the coordinates are floats that were printed as decimal numbers, with enough digits to show their
/// rounding to floats. There are two conditions. First, each coordinate must be the decimal number that results from
/// printing its nearest float with the coordinate's number of decimal places. Second, there must be too many
/// coordinates for all to be that near to a float by chance.
/// Input: all coordinates are multiples of `unit`.
bool are_printed_floats(const Coordinates& coordinates, double unit, Decimals decimals) {
  const auto place_of = [&](double x) { return std::max(unit, shortest(x, decimals).quantum); };
  // Counts the binary digits between the last digit of a float near x and the printed digit at `place`. This number of
  // bits of x can show that x was a float. The result is in quarters of a bit.
  const auto seen = [](double x, double place) {
    const double ratio = last_place(x, kFloatBits) / place;
    return std::ilogb(ratio * ratio * ratio * ratio);
  };
  if (seen(coordinates.largest_of_all(), unit) < 1) return false;
  // If the numbers were not floats, each would be this near to a float with a probability of 2^-bits.
  constexpr int kEnough = 4 * kEvidence;
  using Found = Witnesses<kEnough>;
  const auto witnesses = coordinates.found_in_all(
      Found{},
      [&](Found& found, double x, int) {
        const double place = place_of(x), off = std::fabs(x - nearest_float(x));
        if (off != 0 && seen(x, place) >= 1) found.add(x);
        return off <= 0.5001 * place;
      },
      [](Found& found, const Found& more) { return found.add(more); });
  if (!witnesses) return false;
  int all_seen = 0;
  for (const double x : witnesses->values()) all_seen += seen(x, place_of(x));
  return all_seen >= kEnough;
}

/// The float's last place for the largest coordinate of each axis.
Vec3 float_steps(const Coordinates& coordinates) {
  const auto step = [](double x) { return x == 0 ? 0 : last_place(x, kFloatBits); };
  const Vec3& largest = coordinates.largest();
  return {step(largest.x), step(largest.y), step(largest.z)};
}

/// The claim of significant digits, if there is a number of digits that no coordinate exceeds. Sets `unit` to the place
/// of the last digit.
std::optional<Significant> find_significant_digits(const Coordinates& coordinates, const Lattice& lattice,
                                                   double cutoff, double fixed_step, double& unit) {
  // The longest number may end in an even digit or in a five by chance. Then it seems to refer to another power of two,
  // but other numbers have more digits, so the next ones are tried.
  constexpr std::size_t kTries = 3;
  const std::vector<Factors> longest = longest_numbers(coordinates, lattice, cutoff);
  for (std::size_t i = 0; i < kTries && longest[i].units > 0; ++i) {
    const SignificantDigits digits(lattice, longest[i]);
    const auto significant = significant_digits(coordinates, digits, lattice, fixed_step);
    if (!significant) continue;
    unit = digits.last().step();
    return significant;
  }
  return std::nullopt;
}

/// Finds the steps to which the coordinates were rounded as decimal numbers, with the evidence for that. Returns
/// nothing if there is no short decimal step of which all coordinates are multiples. Sets `unit` to the value of one
/// unit in the last digit.
std::optional<Claim> claim_of_decimals(const Coordinates& coordinates, Decimals decimals, double& unit) {
  if (const auto lattice = common_lattice(coordinates, decimals, 0)) {
    unit = lattice->step();
    Fixed fixed = fixed_decimals(coordinates, *lattice);
    if (fixed.is_last_digit_shown) return fixed.claim;
    double last = 0;
    const auto significant = find_significant_digits(coordinates, *lattice, 0, unit, last);
    if (!significant || significant->coarsest < 1.01 * unit) return fixed.claim;
    if (significant->is_apart) {
      unit = last;
      return significant->claim;
    }
    // The largest numbers lack the last digits that smaller ones have, but there are so few large numbers that this may
    // be chance.
    fixed.claim.is_in_doubt = true;
    return fixed.claim;
  }
  // The smallest numbers may have more decimals than a double of the largest number's size can hold.
  const double cutoff = kLarge * coordinates.largest_of_all();
  const auto lattice = common_lattice(coordinates, decimals, cutoff);
  if (!lattice) return std::nullopt;
  const auto significant = find_significant_digits(coordinates, *lattice, cutoff, 0, unit);
  if (!significant) return std::nullopt;
  Claim claim = significant->claim;
  if (!significant->is_apart) claim.weight = {};
  return claim;
}

Rounding rounding_of(const Coordinates& coordinates) {
  const double least = last_place(coordinates.largest_of_all(), 53);
  Vec3 steps{least, least, least};
  if (coordinates.are_all([](double x) { return odd_part(x).units < kFloatUnits; })) {
    const Vec3 as_floats = float_steps(coordinates);
    const auto common = common_lattice(coordinates, 0, 0);
    // If the common step is larger, the numbers are so short that they lost nothing when they became floats.
    if (!common || common->step() <= std::max({as_floats.x, as_floats.y, as_floats.z}))
      return {as_floats, as_floats, as_floats, false, as_floats};
  }
  for (const Decimals decimals : {kUsual, kAny}) {
    double unit = 0;
    const auto claim = claim_of_decimals(coordinates, decimals, unit);
    if (!claim) continue;
    const bool are_floats = are_printed_floats(coordinates, unit, decimals);
    if (are_floats) steps = larger_of(steps, float_steps(coordinates));
    const Vec3 possible = larger_of(steps, claim->steps);
    if (claim->is_proven()) return {possible, possible, possible, !are_floats, possible};
    return {steps, larger_of(steps, claim->likely_steps()), possible, !are_floats, possible};
  }
  return {steps, steps, steps, false, steps};
}

/// Returns the steps if all coordinates were printed with as many significant digits as the longest of them has. For
/// each axis, its largest number with more than half as many digits counts; shorter ones may be exact.
Vec3 steps_of_printed_digits(std::span<const Vec3> positions, const RunControl& control) {
  // Decimal numbers with more digits cannot be distinguished from doubles.
  constexpr int kMaxDigits = 9;
  struct Printed {
    int digits = 0, exponent = 0;
  };
  const auto printed = [](double x) {
    std::array<char, 40> text{};
    const char* const end =
        std::to_chars(text.data(), text.data() + text.size(), std::fabs(x), std::chars_format::scientific).ptr;
    const char* const mark = std::find(static_cast<const char*>(text.data()), end, 'e');
    Printed result{
        static_cast<int>(std::count_if(static_cast<const char*>(text.data()), mark, [](char c) { return c != '.'; })),
        0};
    std::from_chars(mark + (mark[1] == '+' ? 2 : 1), end, result.exponent);
    return result;
  };
  StopCheck check(control);
  int longest = 0;
  for (const Vec3& p : positions) {
    check();
    for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, printed(p[axis]).digits);
    if (longest > kMaxDigits) return {};
  }
  Vec3 largest;
  for (const Vec3& p : positions) {
    check();
    for (int axis = 0; axis < 3; ++axis)
      if (2 * printed(p[axis]).digits > longest) largest[axis] = std::max(largest[axis], std::fabs(p[axis]));
  }
  Vec3 steps;
  for (int axis = 0; axis < 3; ++axis)
    if (largest[axis] > 0) steps[axis] = std::pow(10.0, printed(largest[axis]).exponent + 1 - longest);
  return steps;
}

/// One length for three steps: the root of the mean of their squares.
double mean_step(const Vec3& steps) {
  if (steps.x == steps.y && steps.y == steps.z) return steps.x;
  // The steps are scaled to about 1, where their squares neither overflow nor underflow.
  const int exponent = std::ilogb(std::max({steps.x, steps.y, steps.z}));
  const Vec3 scaled{std::ldexp(steps.x, -exponent), std::ldexp(steps.y, -exponent), std::ldexp(steps.z, -exponent)};
  return std::ldexp(std::sqrt(dot(scaled, scaled) / 3), exponent);
}

}  // namespace

double Rounding::step() const { return mean_step(steps); }
double Rounding::likely_step() const { return mean_step(likely_steps); }
double Rounding::possible_step() const { return mean_step(possible_steps); }
double Rounding::doubtful_step() const { return mean_step(doubtful_steps); }

Rounding rounding_of(std::span<const Vec3> positions, RunControl& control) {
  const Coordinates coordinates(positions, control);
  if (coordinates.largest_of_all() == 0) return {};
  Rounding rounding = rounding_of(coordinates);
  rounding.steps = coordinates.unit() * rounding.steps;
  rounding.likely_steps = coordinates.unit() * rounding.likely_steps;
  rounding.possible_steps = coordinates.unit() * rounding.possible_steps;
  rounding.doubtful_steps = coordinates.unit() * rounding.doubtful_steps;
  const bool is_proven = rounding.steps == rounding.possible_steps;
  if (rounding.is_decimal && !is_proven)
    rounding.doubtful_steps = larger_of(rounding.doubtful_steps, steps_of_printed_digits(positions, control));
  return rounding;
}

AutomaticTolerance automatic_tolerance(const Rounding& rounding, double diagonal) {
  const double floor = kToleranceFloor * diagonal, unquestioned = kToleranceUnquestioned * diagonal,
               ceiling = kToleranceCeiling * diagonal;
  AutomaticTolerance tolerance;
  tolerance.explained = std::max(floor, kToleranceSteps * rounding.possible_step());
  tolerance.is_capped = tolerance.explained > ceiling;
  tolerance.value = tolerance.explained <= unquestioned ? tolerance.explained : floor;
  tolerance.if_bent = std::min(tolerance.explained, unquestioned);
  tolerance.if_noisy = std::clamp(kToleranceSteps * rounding.likely_step(), tolerance.if_bent, ceiling);
  return tolerance;
}

}  // namespace remesh
