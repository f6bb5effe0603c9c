/// Expansions represent real numbers as exact sums of doubles. They serve the exact stage of predicates.
/// Operations are exact as long as nothing under- or overflows. Each predicate says for which coordinates this is so.
/// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace remesh::exact {

/// A real number as the exact sum of its terms. The terms are in ascending order of magnitude, and none is 0; the empty
/// sum is 0. They are strongly nonoverlapping (Shewchuk), so the sign of the sum is that of the last term. `Capacity`
/// is the largest number of terms that the operations which made the expansion can give.
template <int Capacity>
struct Expansion {
  std::array<double, Capacity> terms;  // the first `size` are set
  int size = 0;

  Expansion() = default;
  /// Copies only the terms that are set. Capacities are for the worst case, which is rare.
  Expansion(const Expansion& other) : size(other.size) { std::copy_n(other.terms.data(), size, terms.data()); }
  Expansion& operator=(const Expansion& other) {
    size = other.size;
    std::copy_n(other.terms.data(), size, terms.data());
    return *this;
  }

  void append(double term) {
    if (term != 0) terms[size++] = term;
  }
  int sign() const { return size == 0 ? 0 : terms[size - 1] > 0 ? 1 : -1; }
};

/// A rounded result and its rounding error. Their sum `value + error` is exact.
struct Rounded {
  double value;
  double error;
};

/// Requires |a| >= |b| or a = 0.
inline Rounded fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

inline Rounded two_sum(double a, double b) {
  const double sum = a + b;
  const double b_virtual = sum - a;
  const double a_virtual = sum - b_virtual;
  return {sum, (a - a_virtual) + (b - b_virtual)};
}

/// Dekker's split into two halves of at most 26 bits. Products of such halves are exact.
inline Rounded split(double a) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double big = kSplitter * a;
  const double high = big - (big - a);
  return {high, a - high};
}

/// `b_split` is split(b). This does not use std::fma, which is a slow call on machines that lack the instruction.
inline Rounded two_product(double a, double b, Rounded b_split) {
  const double product = a * b;
  const Rounded a_split = split(a);
  const double error =
      ((a_split.value * b_split.value - product) + a_split.value * b_split.error + a_split.error * b_split.value) +
      a_split.error * b_split.error;
  return {product, error};
}

/// The exact difference a - b.
inline Expansion<2> difference(double a, double b) {
  const Rounded rounded = two_sum(a, -b);
  Expansion<2> result;
  result.append(rounded.error);
  result.append(rounded.value);
  return result;
}

/// Shewchuk's FAST-EXPANSION-SUM. It merges the terms by magnitude and carries the sum through them.
inline void add(const double* a, int a_size, const double* b, int b_size, double* sum, int& sum_size) {
  int i = 0, j = 0;
  const auto next = [&] {
    if (i == a_size) return b[j++];
    if (j == b_size) return a[i++];
    return std::fabs(a[i]) < std::fabs(b[j]) ? a[i++] : b[j++];
  };
  sum_size = 0;
  if (a_size + b_size == 0) return;
  double carry = next();
  bool is_first = true;
  while (i < a_size || j < b_size) {
    const double term = next();
    const Rounded step = is_first ? fast_two_sum(term, carry) : two_sum(carry, term);
    is_first = false;
    if (step.error != 0) sum[sum_size++] = step.error;
    carry = step.value;
  }
  if (carry != 0) sum[sum_size++] = carry;
}

template <int M, int N>
Expansion<M + N> operator+(const Expansion<M>& a, const Expansion<N>& b) {
  Expansion<M + N> result;
  add(a.terms.data(), a.size, b.terms.data(), b.size, result.terms.data(), result.size);
  return result;
}

template <int N>
Expansion<N> operator-(Expansion<N> a) {
  for (int i = 0; i < a.size; ++i) a.terms[i] = -a.terms[i];
  return a;
}

template <int M, int N>
Expansion<M + N> operator-(const Expansion<M>& a, const Expansion<N>& b) {
  return a + -b;
}

/// Shewchuk's SCALE-EXPANSION.
template <int N>
Expansion<2 * N> operator*(const Expansion<N>& a, double factor) {
  Expansion<2 * N> result;
  if (a.size == 0 || factor == 0) return result;
  const Rounded factor_split = split(factor);
  Rounded product = two_product(a.terms[0], factor, factor_split);
  result.append(product.error);
  double carry = product.value;
  for (int i = 1; i < a.size; ++i) {
    product = two_product(a.terms[i], factor, factor_split);
    const Rounded low = two_sum(carry, product.error);
    result.append(low.error);
    const Rounded high = fast_two_sum(product.value, low.value);
    result.append(high.error);
    carry = high.value;
  }
  result.append(carry);
  return result;
}

template <int M, int N>
Expansion<2 * M * N> operator*(const Expansion<M>& a, const Expansion<N>& b) {
  // Two buffers take turns as the running sum, because a sum cannot be computed in place.
  std::array<Expansion<2 * M * N>, 2> sums;
  int current = 0;
  for (int i = 0; i < b.size; ++i) {
    const auto& sum = sums[current];
    const auto part = a * b.terms[i];
    auto& next = sums[1 - current];
    add(sum.terms.data(), sum.size, part.terms.data(), part.size, next.terms.data(), next.size);
    current = 1 - current;
  }
  return sums[current];
}

}  // namespace remesh::exact
