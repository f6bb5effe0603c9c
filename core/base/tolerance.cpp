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

constexpr int kMaxDecimals = 15;
/// A number counts as short if it has at most this many units.
constexpr double kShort = 4294967296.0;
/// That all coordinates agree on a quantum proves more than that one is short: so many units of it may be in the
/// largest.
constexpr double kShortTogether = 0x1p45;

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

const std::array<double, kMaxDecimals + 1>& powers_of_five() {
  static const auto powers = [] {
    std::array<double, kMaxDecimals + 1> p{};
    p[0] = 1;
    for (std::size_t d = 1; d < p.size(); ++d) p[d] = 5 * p[d - 1];
    return p;
  }();
  return powers;
}

/// The form of x with the fewest units; quantum 0 if none is short.
Decimal shortest(double x) {
  Decimal best;
  for (int d = 0; d <= kMaxDecimals; ++d) {
    Decimal form = odd_part(x * powers_of_five()[d]);
    if (form.units >= kShort) continue;
    form.quantum /= powers_of_five()[d];
    if (best.quantum == 0 || form.units < best.units) best = form;
  }
  return best;
}

/// The coordinates that are not 0, looked at by blocks in parallel.
class Coordinates {
 public:
  Coordinates(std::span<const Vec3> positions, RunControl& control) : positions_(positions), control_(control) {}

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
          for (const Vec3& p : positions_.subspan(begin, is_over ? 0 : end - begin))
            for (int axis = 0; axis < 3; ++axis)
              if (p[axis] != 0 && !add(found, p[axis], axis)) {
                is_over = true;
                return found;
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
};

/// The quantum of which all coordinates are multiples after d decimals; 0 if there is none that leaves them short.
double common_quantum(const Coordinates& coordinates, int d, double largest) {
  const double five = powers_of_five()[d];
  const auto take = [&](double& least, double quantum) {
    least = std::min(least, quantum);
    return largest * five / least < kShortTogether;
  };
  const auto quantum = coordinates.found_in_all(
      HUGE_VAL, [&](double& least, double x, int) { return take(least, odd_part(x * five).quantum); }, take);
  return quantum ? *quantum / five : 0;
}

double last_place(double x, int bits) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, exponent - bits);
}

/// Whether the numbers seem to be limited in significant digits: the small ones have decimals that the large ones lack.
/// One value that shows nearly all the digits which the common quantum leaves to the largest one proves the contrary.
bool has_limited_digits(const Coordinates& coordinates, double largest, double common) {
  if (common == 0) return coordinates.are_all([](double x) { return shortest(x).quantum != 0; });
  const double digits = largest / common;
  if (coordinates.are_all([&](double x) { return digits > 10 * shortest(x).units; })) return true;
  // Within one decade the quanta differ by ten only: then all of several long numbers at the top must lack the last
  // one.
  constexpr int kEnough = 4;
  const std::optional<std::size_t> long_ones = coordinates.found_in_all(
      std::size_t{0},
      [&](std::size_t& count, double x, int) {
        if (std::fabs(x) < 0.75 * largest) return true;
        const Decimal form = shortest(x);
        if (form.units * 100 >= digits) ++count;
        return form.quantum >= 5 * common;
      },
      [](std::size_t& count, std::size_t more) {
        count += more;
        return true;
      });
  return long_ones && *long_ones >= kEnough;
}

double largest_of(const Coordinates& coordinates, double (*measure)(double)) {
  const auto take = [](double& most, double other) {
    most = std::max(most, other);
    return true;
  };
  return *coordinates.found_in_all(
      0.0, [&](double& most, double x, int) { return take(most, measure(x)); }, take);
}

/// The last place of numbers that are limited in significant digits, of all three coordinates together: the root of the
/// mean of its squares. A value with most of the digits shows its last place; the largest such values of a coordinate
/// have its coarsest one. A coordinate without such values is taken to be like the coarsest.
double last_place_of_digits(const Coordinates& coordinates) {
  const double most_units = largest_of(coordinates, [](double x) { return shortest(x).units; });
  const Vec3 largest = *coordinates.found_in_all(
      Vec3{},
      [](Vec3& most, double x, int axis) {
        most[axis] = std::max(most[axis], std::fabs(x));
        return true;
      },
      [](Vec3& most, const Vec3& other) {
        for (int axis = 0; axis < 3; ++axis) most[axis] = std::max(most[axis], other[axis]);
        return true;
      });
  struct Steps {
    Vec3 all, of_largest{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  };
  const Steps steps = *coordinates.found_in_all(
      Steps{},
      [&](Steps& found, double x, int axis) {
        const Decimal form = shortest(x);
        if (form.units * 10 < most_units) return true;
        found.all[axis] = std::max(found.all[axis], form.quantum);
        if (std::fabs(x) > 0.9 * largest[axis]) found.of_largest[axis] = std::min(found.of_largest[axis], form.quantum);
        return true;
      },
      [](Steps& found, const Steps& other) {
        for (int axis = 0; axis < 3; ++axis) {
          found.all[axis] = std::max(found.all[axis], other.all[axis]);
          found.of_largest[axis] = std::min(found.of_largest[axis], other.of_largest[axis]);
        }
        return true;
      });
  Vec3 step;
  for (int axis = 0; axis < 3; ++axis) step[axis] = std::min(steps.all[axis], steps.of_largest[axis]);
  const double coarsest = std::max({step.x, step.y, step.z});
  for (int axis = 0; axis < 3; ++axis)
    if (step[axis] == 0) step[axis] = coarsest;
  return step.x == step.y && step.y == step.z ? coarsest : std::sqrt(dot(step, step) / 3);
}

}  // namespace

Rounding rounding_of(std::span<const Vec3> positions, RunControl& control) {
  const Coordinates coordinates(positions, control);
  const double largest = largest_of(coordinates, [](double x) { return std::fabs(x); });
  if (largest == 0) return {};
  const double least = last_place(largest, 53);

  double common = 0;
  for (int d = 0; d <= kMaxDecimals && common == 0; ++d) common = common_quantum(coordinates, d, largest);
  if (has_limited_digits(coordinates, largest, common))
    return {std::max(last_place_of_digits(coordinates), least), true};
  if (common != 0) return {std::max(common, least), true};
  const bool are_floats = coordinates.are_all([](double x) { return odd_part(x).units < 16777216.0; });
  return {are_floats ? last_place(largest, 24) : least, false};
}

AutomaticTolerance automatic_tolerance(double step, double diagonal) {
  const double floor = kToleranceFloor * diagonal;
  const double wanted = std::clamp(kToleranceSteps * step, floor, kToleranceCeiling * diagonal);
  const bool is_unquestioned = wanted <= kToleranceUnquestioned * diagonal;
  return {is_unquestioned ? wanted : floor, wanted};
}

}  // namespace remesh
