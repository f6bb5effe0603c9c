#include "core/geometry/exact/predicates.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/geometry/exact/expansion.h"

namespace remesh::exact {

namespace {

/// The exact vector from one point to another.
struct Difference {
  Expansion<2> x;
  Expansion<2> y;

  Difference(Vec2 to, Vec2 from) : x(difference(to.x, from.x)), y(difference(to.y, from.y)) {}
};

__extension__ typedef __int128 Wide;

/// The exact vector between two points of the lattice of multiples of 2^-40 in [-1, 1]^2, in units of 2^-40. Nearly all
/// points of patches are on this lattice. Coordinates are at most 2^41.
struct LatticeVector {
  std::int64_t x, y;
};

Wide cross(LatticeVector a, LatticeVector b) { return Wide{a.x} * b.y - Wide{a.y} * b.x; }
Wide lift(LatticeVector a) { return Wide{a.x} * a.x + Wide{a.y} * a.y; }

/// The point as a lattice vector; empty if it is not on the lattice.
std::optional<LatticeVector> on_lattice(Vec2 p) {
  const double x = p.x * 0x1p40, y = p.y * 0x1p40;
  if (!(std::fabs(x) <= 0x1p40 && std::fabs(y) <= 0x1p40)) return std::nullopt;
  const LatticeVector result{static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)};
  if (static_cast<double>(result.x) != x || static_cast<double>(result.y) != y) return std::nullopt;
  return result;
}

LatticeVector operator-(LatticeVector a, LatticeVector b) { return {a.x - b.x, a.y - b.y}; }

int sign_of(Wide x) { return (x > 0) - (x < 0); }

/// Lifts and cross products are at most 2^83, so their products exceed the range of the type. Therefore lifts are split
/// into two parts, the lower one of 42 bits, so that no sum below exceeds 2^127.
int in_circle(LatticeVector a, LatticeVector b, LatticeVector c) {
  constexpr int kLow = 42;
  constexpr std::int64_t kMask = (std::int64_t{1} << kLow) - 1;
  Wide high = 0, low = 0;
  const auto add = [&](Wide lift, Wide cross) {
    high += (lift >> kLow) * cross;
    low += (lift & kMask) * cross;
  };
  add(lift(a), cross(b, c));
  add(lift(b), cross(c, a));
  add(lift(c), cross(a, b));
  // The shift rounds down, so the remainder is not negative.
  const Wide upper = high + (low >> kLow);
  return upper != 0 ? sign_of(upper) : sign_of(low & kMask);
}

Expansion<16> cross(const Difference& a, const Difference& b) { return a.x * b.y - a.y * b.x; }
Expansion<16> lift(const Difference& a) { return a.x * a.x + a.y * a.y; }

}  // namespace

int orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const auto la = on_lattice(a), lb = on_lattice(b), lc = on_lattice(c);
  if (la && lb && lc) return sign_of(cross(*la - *lc, *lb - *lc));
  return cross(Difference(a, c), Difference(b, c)).sign();
}

int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const auto la = on_lattice(a), lb = on_lattice(b), lc = on_lattice(c), ld = on_lattice(d);
  if (la && lb && lc && ld) return in_circle(*la - *ld, *lb - *ld, *lc - *ld);
  const Difference ad(a, d), bd(b, d), cd(c, d);
  return (lift(ad) * cross(bd, cd) + lift(bd) * cross(cd, ad) + lift(cd) * cross(ad, bd)).sign();
}

int in_circle_tie(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  // The in-circle determinant is linear in the points' lifts to the paraboloid. Lowering one lift adds that lift's
  // cofactor, which is the orientation of the other three points.
  const Vec2 smallest = std::min({a, b, c, d});
  if (smallest == d) return remesh::orient2d(a, b, c);
  if (smallest == a) return -remesh::orient2d(b, c, d);
  if (smallest == b) return -remesh::orient2d(c, a, d);
  return -remesh::orient2d(a, b, d);
}

}  // namespace remesh::exact
