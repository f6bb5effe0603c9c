#include "core/base/tolerance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

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

template <class Visit>
bool for_each_coordinate(std::span<const Vec3> positions, Visit visit) {
  for (const Vec3& p : positions)
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != 0 && !visit(p[axis])) return false;
  return true;
}

/// The quantum of which all coordinates are multiples after d decimals; 0 if there is none that leaves them short.
double common_quantum(std::span<const Vec3> positions, int d, double largest) {
  const double five = powers_of_five()[d];
  double quantum = HUGE_VAL;
  const bool is_common = for_each_coordinate(positions, [&](double x) {
    const Decimal form = odd_part(x * five);
    quantum = std::min(quantum, form.quantum);
    return largest * five / quantum < kShortTogether;
  });
  return is_common && quantum < HUGE_VAL ? quantum / five : 0;
}

double last_place(double x, int bits) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, exponent - bits);
}

/// Whether the numbers seem to be limited in significant digits: the small ones have decimals that the large ones lack.
/// One value that shows nearly all the digits which the common quantum leaves to the largest one proves the contrary.
bool has_limited_digits(std::span<const Vec3> positions, double largest, double common) {
  if (common == 0) return for_each_coordinate(positions, [](double x) { return shortest(x).quantum != 0; });
  const double digits = largest / common;
  double most_units = 0;
  const bool is_far_apart = for_each_coordinate(positions, [&](double x) {
    most_units = std::max(most_units, shortest(x).units);
    return digits > 10 * most_units;
  });
  if (is_far_apart) return true;
  // Within one decade the quanta differ by ten only: then all of several long numbers at the top must lack the last
  // one.
  constexpr int kEnough = 4;
  int long_ones = 0;
  const bool is_top_coarse = for_each_coordinate(positions, [&](double x) {
    if (std::fabs(x) < 0.75 * largest) return true;
    const Decimal form = shortest(x);
    if (form.units * 100 >= digits) ++long_ones;
    return form.quantum >= 5 * common;
  });
  return is_top_coarse && long_ones >= kEnough;
}

/// The last place of numbers that are limited in significant digits, of all three coordinates together: the root of the
/// mean of its squares. A value with most of the digits shows its last place; the largest such values of a coordinate
/// have its coarsest one. A coordinate without such values is taken to be like the coarsest.
double last_place_of_digits(std::span<const Vec3> positions) {
  Vec3 largest;
  double most_units = 0;
  for (const Vec3& p : positions)
    for (int axis = 0; axis < 3; ++axis) {
      largest[axis] = std::max(largest[axis], std::fabs(p[axis]));
      if (p[axis] != 0) most_units = std::max(most_units, shortest(p[axis]).units);
    }
  Vec3 step, step_of_largest{HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (const Vec3& p : positions)
    for (int axis = 0; axis < 3; ++axis) {
      if (p[axis] == 0) continue;
      const Decimal form = shortest(p[axis]);
      if (form.units * 10 < most_units) continue;
      step[axis] = std::max(step[axis], form.quantum);
      if (std::fabs(p[axis]) > 0.9 * largest[axis])
        step_of_largest[axis] = std::min(step_of_largest[axis], form.quantum);
    }
  for (int axis = 0; axis < 3; ++axis) step[axis] = std::min(step[axis], step_of_largest[axis]);
  const double coarsest = std::max({step.x, step.y, step.z});
  for (int axis = 0; axis < 3; ++axis)
    if (step[axis] == 0) step[axis] = coarsest;
  return step.x == step.y && step.y == step.z ? coarsest : std::sqrt(dot(step, step) / 3);
}

}  // namespace

Rounding rounding_of(std::span<const Vec3> positions) {
  double largest = 0;
  for_each_coordinate(positions, [&](double x) {
    largest = std::max(largest, std::fabs(x));
    return true;
  });
  if (largest == 0) return {};
  const double least = last_place(largest, 53);

  double common = 0;
  for (int d = 0; d <= kMaxDecimals && common == 0; ++d) common = common_quantum(positions, d, largest);
  if (has_limited_digits(positions, largest, common)) return {std::max(last_place_of_digits(positions), least), true};
  if (common != 0) return {std::max(common, least), true};
  const bool are_floats = for_each_coordinate(positions, [](double x) { return odd_part(x).units < 16777216.0; });
  return {are_floats ? last_place(largest, 24) : least, false};
}

AutomaticTolerance automatic_tolerance(double step, double diagonal) {
  const double floor = kToleranceFloor * diagonal;
  const double wanted = std::clamp(kToleranceSteps * step, floor, kToleranceCeiling * diagonal);
  const bool is_unquestioned = wanted <= kToleranceUnquestioned * diagonal;
  return {is_unquestioned ? wanted : floor, wanted};
}

}  // namespace remesh
