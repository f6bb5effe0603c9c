#include "core/geometry/exact/predicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/cgal_plane.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Returns the value that is `ulps` units in the last place away.
double nudged(double value, int ulps) {
  for (; ulps > 0; --ulps) value = std::nextafter(value, HUGE_VAL);
  for (; ulps < 0; ++ulps) value = std::nextafter(value, -HUGE_VAL);
  return value;
}
Vec2 nudged(Random& random, Vec2 p, int ulps) {
  const double x = nudged(p.x, random.integer(-ulps, ulps));
  return {x, nudged(p.y, random.integer(-ulps, ulps))};
}

/// Compares the filtered and the exact predicates with the oracle in every order of the arguments. Counts the zeros.
class Comparison {
 public:
  void orientation(Vec2 a, Vec2 b, Vec2 c) {
    const int expected = cgal_orientation(a, b, c);
    zeros_ += expected == 0;
    EXPECT_EQ(orient2d(a, b, c), expected);
    EXPECT_EQ(exact::orient2d(a, b, c), expected);
    EXPECT_EQ(orient2d(b, c, a), expected);
    EXPECT_EQ(orient2d(c, a, b), expected);
    EXPECT_EQ(orient2d(b, a, c), -expected);
  }
  void circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    const int expected = cgal_in_circle(a, b, c, d);
    zeros_ += expected == 0;
    EXPECT_EQ(in_circle(a, b, c, d), expected);
    EXPECT_EQ(exact::in_circle(a, b, c, d), expected);
    EXPECT_EQ(in_circle(b, c, a, d), expected);
    EXPECT_EQ(in_circle(b, c, d, a), -expected);
    EXPECT_EQ(in_circle(b, a, c, d), -expected);
    if (expected != 0) {
      EXPECT_EQ(in_circle_perturbed(a, b, c, d), expected);
    }
  }
  int zeros() const { return zeros_; }

 private:
  int zeros_ = 0;
};

Vec2 random_point(Random& random) {
  const double x = random.uniform(-1, 1);
  return {x, random.uniform(-1, 1)};
}

constexpr double kScales[] = {0x1p-100, 0x1p-20, 1, 0x1p20, 0x1p100};

TEST(predicates, random_points_agree_with_the_oracle_at_every_scale) {
  Random random(1);
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const double scale = kScales[i % 5];
    const Vec2 a = scale * random_point(random), b = scale * random_point(random);
    const Vec2 c = scale * random_point(random), d = scale * random_point(random);
    comparison.orientation(a, b, c);
    comparison.circle(a, b, c, d);
  }
}

TEST(predicates, coordinates_of_very_different_magnitude_agree_with_the_oracle) {
  Random random(2);
  Comparison comparison;
  const auto wild = [&] { return std::ldexp(random.uniform(-1, 1), random.integer(-119, 119)); };
  for (int i = 0; i < 20000; ++i) {
    Vec2 p[4];
    for (Vec2& q : p) {
      q.x = wild();
      q.y = wild();
    }
    comparison.orientation(p[0], p[1], p[2]);
    comparison.circle(p[0], p[1], p[2], p[3]);
  }
}

TEST(predicates, points_ulps_from_a_line_agree_with_the_oracle) {
  Random random(3);
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const double scale = kScales[i % 5];
    const Vec2 a = scale * random_point(random), b = scale * random_point(random);
    const Vec2 on_line = a + random.uniform(-1, 2) * (b - a);
    comparison.orientation(a, b, nudged(random, on_line, 3));
    comparison.orientation(a, b, nudged(random, 0.5 * (a + b), 1));
  }
  EXPECT_GT(comparison.zeros(), 10);
}

TEST(predicates, points_ulps_from_a_diagonal_agree_with_the_oracle) {
  // The classic failure: a point that walks around (0.5, 0.5) against the line from (12, 12) to (24, 24).
  Comparison comparison;
  for (int i = -32; i < 32; ++i)
    for (int j = -32; j < 32; ++j) comparison.orientation({nudged(0.5, i), nudged(0.5, j)}, {12, 12}, {24, 24});
  EXPECT_GE(comparison.zeros(), 48);
}

TEST(predicates, points_ulps_from_a_circle_agree_with_the_oracle) {
  Random random(4);
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const double scale = kScales[i % 5];
    const Vec2 centre = random_point(random);
    const double radius = std::ldexp(1, random.integer(-20, 0));
    const auto on_circle = [&] {
      const double angle = random.uniform(0, 7);
      return nudged(random, scale * (centre + radius * Vec2{std::cos(angle), std::sin(angle)}), 2);
    };
    const Vec2 a = on_circle(), b = on_circle(), c = on_circle(), d = on_circle();
    comparison.circle(a, b, c, d);
    // A rectangle about the centre, exact but for one nudge.
    const Vec2 half = scale * radius * Vec2{0.5, 0.25}, o = scale * centre;
    const Vec2 p = o + half, q = o + Vec2{-half.x, half.y}, r = o - half, s = o + Vec2{half.x, -half.y};
    comparison.circle(p, q, r, nudged(random, s, 1));
  }
  EXPECT_GT(comparison.zeros(), 10);
}

TEST(predicates, points_of_the_lattice_of_patches_agree_with_the_oracle) {
  // Multiples of 2^-40 in [-1, 1]^2, out to its corners: near a circle or line, on it, and one step beside it.
  Random random(6);
  Comparison comparison;
  const auto on_lattice = [](Vec2 p) {
    return Vec2{std::nearbyint(p.x * 0x1p40) * 0x1p-40, std::nearbyint(p.y * 0x1p40) * 0x1p-40};
  };
  const auto step = [&](Vec2 p) {
    const double x = p.x + random.integer(-1, 1) * 0x1p-40;
    return Vec2{x, p.y + random.integer(-1, 1) * 0x1p-40};
  };
  for (int i = 0; i < 20000; ++i) {
    const Vec2 centre = on_lattice(0.5 * random_point(random));
    const double radius = std::ldexp(random.uniform(0.25, 0.5), -random.integer(0, 36));
    const auto on_circle = [&] {
      const double angle = random.uniform(0, 7);
      return on_lattice(centre + radius * Vec2{std::cos(angle), std::sin(angle)});
    };
    comparison.circle(on_circle(), on_circle(), on_circle(), on_circle());
    const Vec2 half = on_circle() - centre, turned{-half.y, half.x}, last = centre - turned;
    comparison.circle(centre + half, centre + turned, centre - half, last);
    comparison.circle(centre + half, centre + turned, centre - half, step(last));
    comparison.orientation(centre + half, centre - half, centre);
    comparison.orientation(centre + half, centre - half, step(centre));
  }
  EXPECT_GT(comparison.zeros(), 40000);
  for (const Vec2 last :
       {Vec2{-1, 1}, Vec2{-1, 1 - 0x1p-40}, Vec2{-1 + 0x1p-40, 1}, Vec2{0, 0}, Vec2{1 - 0x1p-40, 1}}) {
    comparison.circle({1, 1}, {-1, -1}, {1, -1}, last);
    comparison.circle({1, 1}, {-1, -1}, {1 - 0x1p-40, -1}, last);
    comparison.orientation({1, 1}, {-1, -1}, last);
  }
}

TEST(predicates, exactly_cocircular_and_collinear_points_give_zero_at_every_scale) {
  const std::vector<Vec2> points = polygons::cocircular();
  Random random(5);
  for (int i = 0; i < 10000; ++i) {
    const double scale = kScales[i % 5];
    const auto any = [&] { return scale * points[static_cast<std::size_t>(random.below(324))]; };
    const Vec2 a = any(), b = any(), c = any(), d = any();
    EXPECT_EQ(in_circle(a, b, c, d), 0);
    EXPECT_EQ(orient2d(a, 0.5 * (a + b), b), 0);
  }
}

/// All ordered quadruples of different points of a small grid.
template <class Visit>
void for_each_quadruple(const std::vector<Vec2>& points, const Visit& visit) {
  for (const Vec2 a : points)
    for (const Vec2 b : points)
      for (const Vec2 c : points)
        for (const Vec2 d : points)
          if (a != b && a != c && a != d && b != c && b != d && c != d) visit(a, b, c, d);
}

TEST(predicates, every_quadruple_of_a_small_grid_has_the_sign_of_integer_arithmetic) {
  for_each_quadruple(polygons::grid(4, 5), [](Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    const Vec2 ad = a - d, bd = b - d, cd = c - d;  // small integers: all of this is exact
    const double circle = dot(ad, ad) * cross(bd, cd) + dot(bd, bd) * cross(cd, ad) + dot(cd, cd) * cross(ad, bd);
    const double turn = cross(b - a, c - a);
    ASSERT_EQ(in_circle(a, b, c, d), (circle > 0) - (circle < 0));
    ASSERT_EQ(exact::in_circle(a, b, c, d), (circle > 0) - (circle < 0));
    ASSERT_EQ(orient2d(a, b, c), (turn > 0) - (turn < 0));
    ASSERT_EQ(exact::orient2d(a, b, c), (turn > 0) - (turn < 0));
  });
}

TEST(predicates, the_perturbed_in_circle_is_an_antisymmetric_determinant_that_is_never_zero) {
  int ties = 0;
  for_each_quadruple(polygons::grid(4, 5), [&](Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    if (orient2d(a, b, c) <= 0) return;
    const int sign = in_circle_perturbed(a, b, c, d);
    const int exact_sign = in_circle(a, b, c, d);
    ties += exact_sign == 0;
    ASSERT_NE(sign, 0);
    if (exact_sign != 0) {
      ASSERT_EQ(sign, exact_sign);
    }
    ASSERT_EQ(in_circle_perturbed(b, c, a, d), sign);
    ASSERT_EQ(in_circle_perturbed(b, a, c, d), -sign);
    // Of an edge and its two apexes, both views agree: it is flipped or not.
    if (orient2d(c, d, a) > 0) {
      ASSERT_EQ(in_circle_perturbed(c, d, a, b), sign);
    }
  });
  EXPECT_GT(ties, 1000);
}

TEST(predicates, of_four_cocircular_points_the_smallest_one_is_inside) {
  int ties = 0;
  for_each_quadruple(polygons::grid(4, 4), [&](Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    if (orient2d(a, b, c) <= 0 || in_circle(a, b, c, d) != 0) return;
    ++ties;
    // The vertex opposite to d around the circle is the one that the chord of the other two separates from d.
    const Vec2 opposite = orient2d(b, c, d) < 0 ? a : orient2d(c, a, d) < 0 ? b : c;
    const Vec2 smallest = std::min({a, b, c, d});
    ASSERT_EQ(in_circle_perturbed(a, b, c, d) > 0, smallest == d || smallest == opposite);
  });
  EXPECT_GT(ties, 500);
}

}  // namespace
}  // namespace remesh
