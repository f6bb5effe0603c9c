/// Numbers of twice the usual precision, alone and with a bound on their error.
#pragma once

#include <array>
#include <cmath>

#include "core/base/vec.h"
#include "core/geometry/exact/expansion.h"

namespace remesh::exact {

/// A number of twice the usual precision, as the sum of a double and its rounding error.
/// Source: Joldes, Muller and Popescu, Tight and rigorous error bounds for basic building blocks of double-word
///         arithmetic, 2017. The relative error is hardly more than 3 u^2 for sums (algorithm 6, AccurateDWPlusDW) and
///         at most 7 u^2 for products (algorithm 10, DWTimesDW1), where u is 2^-53.
using Twofold = Rounded;

inline Twofold sum(Twofold a, Twofold b) {
  const Twofold high = two_sum(a.value, b.value), low = two_sum(a.error, b.error);
  const Twofold most = fast_two_sum(high.value, high.error + low.value);
  return fast_two_sum(most.value, low.error + most.error);
}

inline Twofold product(Twofold a, Twofold b) {
  const Twofold high = two_product(a.value, b.value, split(b.value));
  return fast_two_sum(high.value, high.error + (a.value * b.error + a.error * b.value));
}

inline Twofold negative(Twofold a) { return {-a.value, -a.error}; }

/// A twofold number with a bound on its absolute error. The operations keep the bound true as long as nothing under- or
/// overflows.
struct Bounded {
  Twofold number{0, 0};
  double bound = 0;

  /// The exact difference of two doubles.
  static Bounded difference(double a, double b) { return {two_sum(a, -b), 0}; }

  /// The sign of the number if the bound leaves no doubt, otherwise 0.
  int sign() const { return number.value > bound ? 1 : number.value < -bound ? -1 : 0; }
  double size() const { return std::fabs(number.value); }

  friend Bounded operator-(const Bounded& a) { return {negative(a.number), a.bound}; }
  friend Bounded operator+(const Bounded& a, const Bounded& b) {
    const Twofold number = sum(a.number, b.number);
    return {number, kSlack * (a.bound + b.bound) + kError * std::fabs(number.value)};
  }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return a + -b; }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    const Twofold number = product(a.number, b.number);
    return {number, kSlack * (a.bound * (b.size() * kSlack + b.bound) + b.bound * a.size() * kSlack) +
                        kError * std::fabs(number.value)};
  }

 private:
  /// The errors of one operation are below 7 u^2, and the sums of bounds are rounded.
  static constexpr double kError = 8 * 0x1p-106, kSlack = 1 + 0x1p-48;
};

using Bounded3 = std::array<Bounded, 3>;

inline Bounded3 difference(const Vec3& a, const Vec3& b) {
  return {Bounded::difference(a.x, b.x), Bounded::difference(a.y, b.y), Bounded::difference(a.z, b.z)};
}

inline Bounded3 cross(const Bounded3& a, const Bounded3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Bounded dot(const Bounded3& a, const Bounded3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Twofold quotient(Twofold a, Twofold b) {
  const double first = a.value / b.value;
  const Twofold left = sum(a, negative(product(b, {first, 0})));
  return fast_two_sum(first, left.value / b.value);
}

}  // namespace remesh::exact
