#include "core/verify/model/fixed_width_integers.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace remesh::verification {
namespace {

__extension__ typedef unsigned __int128 Wide;

/// An integer in two's complement with N limbs of 64 bits, the lowest limb first. Sums and products are taken modulo
/// 2^(64 N). The caller must choose N such that no result leaves the range.
template <std::size_t N>
class FixedInteger {
 public:
  FixedInteger() = default;
  /// Input: a whole number of magnitude at most 2^127.
  explicit FixedInteger(double value) {
    int exponent = 0;
    const double fraction = std::frexp(std::fabs(value), &exponent);
    if (fraction == 0) return;
    Wide magnitude = static_cast<std::uint64_t>(std::ldexp(fraction, 53));  // value = magnitude * 2^(exponent - 53)
    magnitude = exponent >= 53 ? magnitude << (exponent - 53) : magnitude >> (53 - exponent);
    limbs_[0] = static_cast<std::uint64_t>(magnitude);
    limbs_[1] = static_cast<std::uint64_t>(magnitude >> 64);
    if (value < 0) *this = FixedInteger() - *this;
  }

  friend FixedInteger operator+(const FixedInteger& a, const FixedInteger& b) {
    FixedInteger out;
    Wide carry = 0;
    for (std::size_t i = 0; i < N; ++i) {
      carry += static_cast<Wide>(a.limbs_[i]) + b.limbs_[i];
      out.limbs_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return out;
  }
  friend FixedInteger operator-(const FixedInteger& a, const FixedInteger& b) {
    FixedInteger out;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const Wide difference = static_cast<Wide>(a.limbs_[i]) - b.limbs_[i] - borrow;
      out.limbs_[i] = static_cast<std::uint64_t>(difference);
      borrow = static_cast<std::uint64_t>(difference >> 64) != 0 ? 1 : 0;
    }
    return out;
  }
  friend FixedInteger operator*(const FixedInteger& a, const FixedInteger& b) {
    FixedInteger out;
    for (std::size_t i = 0; i < N; ++i) {
      Wide carry = 0;
      for (std::size_t j = 0; i + j < N; ++j) {
        carry += static_cast<Wide>(a.limbs_[i]) * b.limbs_[j] + out.limbs_[i + j];
        out.limbs_[i + j] = static_cast<std::uint64_t>(carry);
        carry >>= 64;
      }
    }
    return out;
  }
  int sign() const {
    if (limbs_[N - 1] >> 63) return -1;
    for (const std::uint64_t limb : limbs_)
      if (limb != 0) return 1;
    return 0;
  }

 private:
  std::array<std::uint64_t, N> limbs_{};
};

/// A vector between two grid points, as integers.
template <std::size_t N>
struct IntegerVector {
  FixedInteger<N> x, y;
  IntegerVector(Vec2 from, Vec2 to, double per_unit)
      : x(FixedInteger<N>(to.x * per_unit) - FixedInteger<N>(from.x * per_unit)),
        y(FixedInteger<N>(to.y * per_unit) - FixedInteger<N>(from.y * per_unit)) {}
  FixedInteger<N> squared() const { return x * x + y * y; }
};

template <std::size_t N>
FixedInteger<N> cross(const IntegerVector<N>& a, const IntegerVector<N>& b) {
  return a.x * b.y - a.y * b.x;
}

template <std::size_t N>
int exact_orientation(Vec2 a, Vec2 b, Vec2 c, double grid) {
  return cross(IntegerVector<N>(a, b, 1 / grid), IntegerVector<N>(a, c, 1 / grid)).sign();
}

template <std::size_t N>
int exact_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double grid) {
  const IntegerVector<N> da(d, a, 1 / grid), db(d, b, 1 / grid), dc(d, c, 1 / grid);
  return (da.squared() * cross(db, dc) + db.squared() * cross(dc, da) + dc.squared() * cross(da, db)).sign();
}

// On a grid of 2^-g the differences have g + 1 bits. The incircle determinant has at most 4 (g + 1) + 4 bits and a
// sign: 169 bits for g = 40, and 409 bits for g = 100.
constexpr std::size_t kCoarseLimbs = 3;
constexpr std::size_t kFineLimbs = 7;

/// Computes the exact sign of a sum of products of two doubles. Each product is split without error into two doubles,
/// and these are added up in an expansion of non-overlapping parts.
class ProductSum {
 public:
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const {
    for (std::size_t i = size_; i-- > 0;)
      if (parts_[i] != 0) return parts_[i] > 0 ? 1 : -1;
    return 0;
  }

 private:
  /// Adds a value. Knuth's error-free addition carries it through the parts, the smallest first.
  void add(double value) {
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = parts_[i] + value;
      const double rounded = sum - parts_[i];
      parts_[i] = (parts_[i] - (sum - rounded)) + (value - rounded);
      value = sum;
    }
    parts_[size_++] = value;
  }
  std::array<double, 12> parts_{};
  std::size_t size_ = 0;
};

/// True if the projection of abc onto two of the axes has no area.
bool is_flat_along(const Vec3& a, const Vec3& b, const Vec3& c, int x, int y) {
  ProductSum sum;
  sum.add_product(a[x], b[y]);
  sum.add_product(-a[y], b[x]);
  sum.add_product(b[x], c[y]);
  sum.add_product(-b[y], c[x]);
  sum.add_product(c[x], a[y]);
  sum.add_product(-c[y], a[x]);
  return sum.sign() == 0;
}

}  // namespace

bool is_on_grid(Vec2 uv, double grid) {
  const auto is_multiple = [grid](double t) { return std::fabs(t) <= 1 && std::trunc(t / grid) == t / grid; };
  return is_multiple(uv.x) && is_multiple(uv.y);
}

int orientation(Vec2 a, Vec2 b, Vec2 c, double grid) {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  // The differences, the products and the final difference are rounded once each. This gives 3 u (|left| + |right|)
  // with u = 2^-53, and slightly more.
  const double bound = 4e-16 * (std::fabs(left) + std::fabs(right));
  if (std::fabs(left - right) > bound) return left > right ? 1 : -1;
  return grid == kCoarseGrid ? exact_orientation<kCoarseLimbs>(a, b, c, grid)
                             : exact_orientation<kFineLimbs>(a, b, c, grid);
}

bool is_inside_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double grid) {
  const Vec2 da = a - d, db = b - d, dc = c - d;
  const double a2 = dot(da, da), b2 = dot(db, db), c2 = dot(dc, dc);
  const double determinant = a2 * cross(db, dc) + b2 * cross(dc, da) + c2 * cross(da, db);
  const double magnitude = a2 * (std::fabs(db.x * dc.y) + std::fabs(db.y * dc.x)) +
                           b2 * (std::fabs(dc.x * da.y) + std::fabs(dc.y * da.x)) +
                           c2 * (std::fabs(da.x * db.y) + std::fabs(da.y * db.x));
  // Each term's share in the sum has at most ten roundings, counted from the coordinates: 10 u magnitude = 1.2e-15.
  if (std::fabs(determinant) > 4e-15 * magnitude) return determinant > 0;
  return (grid == kCoarseGrid ? exact_in_circle<kCoarseLimbs>(a, b, c, d, grid)
                              : exact_in_circle<kFineLimbs>(a, b, c, d, grid)) > 0;
}

bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return is_flat_along(a, b, c, 0, 1) && is_flat_along(a, b, c, 1, 2) && is_flat_along(a, b, c, 2, 0);
}

}  // namespace remesh::verification
