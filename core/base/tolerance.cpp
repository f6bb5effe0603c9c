#include "core/base/tolerance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// The decimals that are tried: first those of usual numbers, then all whose powers of five are doubles. Negative ones
/// leave out zeros to the left of the point; but whole numbers are taken to be meant as that where all are short.
struct Decimals {
  int least = 0, least_in_common = 0, most = 0;
};
constexpr Decimals kUsual{-5, 0, 15}, kAny{-22, -22, 22};
/// A number counts as short if it has at most this many units.
constexpr double kShort = 4294967296.0;
/// That all coordinates agree on a quantum proves more than that one is short: so many units of it may be in the
/// largest.
constexpr double kShortTogether = 0x1p45;
/// The units that a float has room for.
constexpr int kFloatBits = 24;
constexpr double kFloatUnits = 0x1p24;

/// A value as units * quantum, where quantum is a power of two over a power of five.
struct Decimal {
  double units = 0;
  double quantum = 0;
};

/// x as an odd number of quanta, once the last bits, which are its own rounding and the product's, are forgotten.
Decimal odd_part(double x) {
  // By the number's own bits: this is most of the work of reading all coordinates' digits.
  constexpr int kBias = 1023, kBits = 52;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  int field = static_cast<int>(bits >> kBits & 0x7ff);
  std::uint64_t mantissa = (bits & 0xfffffffffffffull) | std::uint64_t{1} << kBits;
  if (field == 0) {  // subnormal
    int exponent = 0;
    mantissa = static_cast<std::uint64_t>(std::ldexp(std::fabs(std::frexp(x, &exponent)), kBits + 1));
    field = exponent + kBias - 1;
  }
  // The roundest number within two of the mantissa: the multiple of eight there, if any, or the first one of four.
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
  return d >= 0 ? x * powers[static_cast<std::size_t>(d)] : x / powers[static_cast<std::size_t>(-d)];
}

/// The form of x with the fewest units; quantum 0 if none is short.
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

/// The coordinates that say something, looked at by blocks in parallel: those nearer to 0 than any tolerance are a 0
/// that arithmetic has missed, as in 6.1e-17 for the cosine of a right angle. They are scaled by a power of two to be
/// near 1: decimals of a number near the largest double are none themselves.
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
    // A power that has a reciprocal, too.
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

  /// What 1 stands for.
  double unit() const { return unit_; }
  /// Per axis.
  const Vec3& largest() const { return largest_; }
  double largest_of_all() const { return std::max({largest_.x, largest_.y, largest_.z}); }

  /// Whether `holds` is true of all.
  template <class Holds>
  bool are_all(const Holds& holds) const {
    return found_in_all(
               0, [&](int&, double x, int) { return holds(x); }, [](int&, int) { return true; })
        .has_value();
  }

  /// What `add` finds in all of them, from `none` on: it is given what its block has come to, a coordinate and its
  /// axis; `join` gives the first of two blocks what the second has come to. Either says false if nothing can be found
  /// any more.
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

/// Different values that bear witness of something, as many as are needed: one that is repeated proves no more.
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
  bool are_enough() const { return count_ == kEnough; }

 private:
  std::array<double, kEnough> values_{};
  std::size_t count_ = 0;
};

/// The quantum of which all coordinates are multiples after d decimals; 0 if there is none that leaves them short.
double common_quantum(const Coordinates& coordinates, int d) {
  const double largest = times_power_of_five(coordinates.largest_of_all(), d);
  const auto take = [&](double& least, double quantum) {
    least = std::min(least, quantum);
    return largest / least < kShortTogether;
  };
  const auto quantum = coordinates.found_in_all(
      HUGE_VAL, [&](double& least, double x, int) { return take(least, odd_part(times_power_of_five(x, d)).quantum); },
      take);
  return quantum ? times_power_of_five(*quantum, -d) : 0;
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

/// The largest power of ten, times `unit`, that is not above x.
double decade(double x, double unit) { return unit * std::pow(10, std::floor(std::log10(x / unit * (1 + 1e-9)))); }

/// Whether the numbers seem to be limited in significant digits: the small ones have decimals that the large ones lack.
/// One value that shows nearly all the digits which the common quantum leaves to the largest one proves the contrary.
bool has_limited_digits(const Coordinates& coordinates, double common, Decimals decimals) {
  if (common == 0) return coordinates.are_all([&](double x) { return shortest(x, decimals).quantum != 0; });
  const double digits = coordinates.largest_of_all() / common;
  const auto leaves_one = [&](double x) {
    const Decimal form = shortest(x, decimals);
    return form.quantum != 0 && digits > 10 * form.units;
  };
  if (coordinates.are_all(leaves_one)) return true;
  // Between neighbouring decades the quanta differ by ten only: then all of several long numbers in the higher one must
  // lack the last digit of the lower one.
  const double top = decade(coordinates.largest_of_all(), common);
  const auto witnesses = coordinates.found_in_all(
      Witnesses<4>{},
      [&](Witnesses<4>& found, double x, int) {
        if (std::fabs(x) < top * (1 - 1e-9)) return true;
        const Decimal form = shortest(x, decimals);
        if (form.units * 100 >= digits) found.add(x);
        return form.quantum >= 5 * common;
      },
      [](auto& found, const auto& more) { return found.add(more); });
  return witnesses && witnesses->are_enough();
}

/// The coordinate that shows most digits.
Decimal longest_form(const Coordinates& coordinates, Decimals decimals) {
  const auto take = [](Decimal& longest, const Decimal& form) {
    if (form.units > longest.units || (form.units == longest.units && form.quantum < longest.quantum)) longest = form;
    return true;
  };
  return *coordinates.found_in_all(
      Decimal{}, [&](Decimal& longest, double x, int) { return take(longest, shortest(x, decimals)); }, take);
}

Vec3 larger_of(const Vec3& a, const Vec3& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

/// Per axis, the largest coordinate that shows nearly all of the digits: a 1 beside numbers below it may be one that
/// nothing was rounded off.
Vec3 largest_of_long(const Coordinates& coordinates, double most_units, Decimals decimals) {
  return *coordinates.found_in_all(
      Vec3{},
      [&](Vec3& largest, double x, int axis) {
        if (std::fabs(x) > largest[axis] && 100 * shortest(x, decimals).units >= most_units)
          largest[axis] = std::fabs(x);
        return true;
      },
      [](Vec3& largest, const Vec3& other) {
        largest = larger_of(largest, other);
        return true;
      });
}

/// Whether the decimals are those of floats, to so many places that the floats' own rounding shows: each is the nearest
/// to a float with as many places as it has, and several of them would not be by chance. All are multiples of `unit`.
bool are_printed_floats(const Coordinates& coordinates, double unit, Decimals decimals) {
  const auto place_of = [&](double x) { return std::max(unit, shortest(x, decimals).quantum); };
  // How many quarters of bits at a number's end are the float's and not the printing's.
  const auto seen = [](double x, double place) {
    const double ratio = last_place(x, kFloatBits) / place;
    return std::ilogb(ratio * ratio * ratio * ratio);
  };
  if (seen(coordinates.largest_of_all(), unit) < 1) return false;
  constexpr int kEnough = 64;
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

/// The last places of the largest coordinates as floats.
Vec3 float_steps(const Coordinates& coordinates) {
  const auto step = [](double x) { return x == 0 ? 0 : last_place(x, kFloatBits); };
  const Vec3& largest = coordinates.largest();
  return {step(largest.x), step(largest.y), step(largest.z)};
}

std::optional<Rounding> rounding_of_decimals(const Coordinates& coordinates, Decimals decimals) {
  double unit = 0;
  for (int d = decimals.least_in_common; d <= decimals.most && unit == 0; ++d) {
    unit = common_quantum(coordinates, d);
    // So long, and no decimals: the last digit may well stand left of the point.
    const bool are_whole = d == 0 && unit != 0;
    if (are_whole && decimals.least_in_common == 0 && coordinates.largest_of_all() / unit > kShort) return std::nullopt;
  }
  Vec3 steps{unit, unit, unit};
  if (has_limited_digits(coordinates, unit, decimals)) {
    const Decimal longest = longest_form(coordinates, decimals);
    unit = longest.quantum;
    const double digits = decade(longest.units, 1);
    const Vec3 of_long = largest_of_long(coordinates, longest.units, decimals);
    for (int axis = 0; axis < 3; ++axis) {
      const double largest = of_long[axis] > 0 ? of_long[axis] : coordinates.largest()[axis];
      steps[axis] = largest == 0 ? 0 : decade(largest, unit) / digits;
    }
  }
  if (unit == 0) return std::nullopt;
  if (!are_printed_floats(coordinates, unit, decimals)) return Rounding{steps, true};
  return Rounding{larger_of(steps, float_steps(coordinates)), false};
}

Rounding rounding_of(const Coordinates& coordinates) {
  if (coordinates.are_all([](double x) { return odd_part(x).units < kFloatUnits; })) {
    const double common = common_quantum(coordinates, 0);
    const Vec3 floats = float_steps(coordinates);
    return {larger_of({common, common, common}, floats), common >= std::max({floats.x, floats.y, floats.z})};
  }
  const double least = last_place(coordinates.largest_of_all(), 53);
  const Vec3 as_doubles{least, least, least};
  for (const Decimals decimals : {kUsual, kAny})
    if (const auto rounding = rounding_of_decimals(coordinates, decimals))
      return {larger_of(rounding->steps, as_doubles), rounding->is_decimal};
  return {as_doubles, false};
}

}  // namespace

double Rounding::step() const {
  if (steps.x == steps.y && steps.y == steps.z) return steps.x;
  // Near 1, where squares neither over- nor underflow.
  const int exponent = std::ilogb(std::max({steps.x, steps.y, steps.z}));
  const Vec3 scaled{std::ldexp(steps.x, -exponent), std::ldexp(steps.y, -exponent), std::ldexp(steps.z, -exponent)};
  return std::ldexp(std::sqrt(dot(scaled, scaled) / 3), exponent);
}

Rounding rounding_of(std::span<const Vec3> positions, RunControl& control) {
  const Coordinates coordinates(positions, control);
  if (coordinates.largest_of_all() == 0) return {};
  Rounding rounding = rounding_of(coordinates);
  rounding.steps = coordinates.unit() * rounding.steps;
  return rounding;
}

AutomaticTolerance automatic_tolerance(double step, double diagonal) {
  const double floor = kToleranceFloor * diagonal;
  const double wanted = std::clamp(kToleranceSteps * step, floor, kToleranceCeiling * diagonal);
  const bool is_unquestioned = wanted <= kToleranceUnquestioned * diagonal;
  return {is_unquestioned ? wanted : floor, wanted};
}

}  // namespace remesh
