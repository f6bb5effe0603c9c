#include "core/geometry/predicates.h"

#include <algorithm>

#include "core/geometry/expansion.h"

namespace remesh::exact {

namespace {

/// The exact vector from one point to another.
struct Difference {
  Expansion<2> x;
  Expansion<2> y;

  Difference(Vec2 to, Vec2 from) : x(difference(to.x, from.x)), y(difference(to.y, from.y)) {}
};

Expansion<16> cross(const Difference& a, const Difference& b) { return a.x * b.y - a.y * b.x; }
Expansion<16> lift(const Difference& a) { return a.x * a.x + a.y * a.y; }

}  // namespace

int orient2d(Vec2 a, Vec2 b, Vec2 c) { return cross(Difference(a, c), Difference(b, c)).sign(); }

int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const Difference ad(a, d), bd(b, d), cd(c, d);
  return (lift(ad) * cross(bd, cd) + lift(bd) * cross(cd, ad) + lift(cd) * cross(ad, bd)).sign();
}

int in_circle_tie(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  // The in-circle determinant is linear in the points' lifts to the paraboloid: lowering one lift adds that lift's
  // cofactor, which is the orientation of the other three points.
  const Vec2 smallest = std::min({a, b, c, d});
  if (smallest == d) return remesh::orient2d(a, b, c);
  if (smallest == a) return -remesh::orient2d(b, c, d);
  if (smallest == b) return -remesh::orient2d(c, a, d);
  return -remesh::orient2d(a, b, d);
}

}  // namespace remesh::exact
