#include "core/geometry/exact/predicates_3d.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/cgal_space.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Compares the filtered and the exact predicate with the oracle in several orders of the arguments. Returns the sign.
int compare(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int expected = cgal_orientation(a, b, c, d);
  EXPECT_EQ(orient3d(a, b, c, d), expected);
  EXPECT_EQ(exact::orient3d(a, b, c, d), expected);
  EXPECT_EQ(orient3d(b, c, a, d), expected);
  EXPECT_EQ(orient3d(b, a, c, d), -expected);
  EXPECT_EQ(orient3d(d, b, c, a), -expected);
  EXPECT_EQ(orient3d(c, d, a, b), expected);
  return expected;
}

Vec3 random_place(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}
double nudged(Random& random, double value) {
  const int ulps = random.integer(-2, 2);
  for (int i = 0; i < std::abs(ulps); ++i) value = std::nextafter(value, ulps * HUGE_VAL);
  return value;
}

constexpr double kScalesInSpace[] = {0x1p-240, 0x1p-20, 1, 0x1p20, 0x1p249};

TEST(predicates_3d, the_fourth_point_is_positive_where_the_first_three_are_counter_clockwise) {
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, -1}), -1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 0}), 0);
}

TEST(predicates_3d, random_points_agree_with_the_oracle_at_every_scale) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double scale = kScalesInSpace[i % 5];
    const Vec3 a = scale * random_place(random), b = scale * random_place(random);
    const Vec3 c = scale * random_place(random), d = scale * random_place(random);
    compare(a, b, c, d);
  }
}

TEST(predicates_3d, coordinates_of_very_different_magnitude_agree_with_the_oracle) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    Vec3 p[4];
    for (Vec3& q : p)
      for (int axis = 0; axis < 3; ++axis) q[axis] = std::ldexp(random.uniform(-1, 1), random.integer(-198, 250));
    compare(p[0], p[1], p[2], p[3]);
  }
}

TEST(predicates_3d, points_ulps_from_a_plane_agree_with_the_oracle) {
  Random random(3);
  int signs[3] = {};
  for (int i = 0; i < 20000; ++i) {
    const double scale = kScalesInSpace[i % 5];
    const Vec3 a = scale * random_place(random), b = scale * random_place(random), c = scale * random_place(random);
    const double s = random.uniform(-1, 2), t = random.uniform(-1, 2);
    Vec3 d = a + s * (b - a) + t * (c - a);
    d = {nudged(random, d.x), nudged(random, d.y), nudged(random, d.z)};
    ++signs[1 + compare(a, b, c, d)];
    const Vec3 middle = 0.5 * (a + b);
    ++signs[1 + compare(a, b, c, {nudged(random, middle.x), middle.y, middle.z})];
  }
  EXPECT_GT(*std::min_element(signs, signs + 3), 1000);
}

/// The determinant stays as it is while multiples of rows and columns are added to others, and its terms become ever
/// larger: in the end it is their difference in the last of 150 bits.
TEST(predicates_3d, the_last_bit_of_the_volume_decides) {
  constexpr double kLargest = 0x1p50;
  Random random(5);
  for (int i = 0; i < 5000; ++i) {
    const int volume = i % 3 - 1;
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, static_cast<double>(volume)}};
    for (int steps = 0; steps < 200; ++steps) {
      const int from = random.integer(0, 2), to = (from + random.integer(1, 2)) % 3;
      const double factor = random.integer(0, 1) * 2 - 1;
      const bool is_of_rows = random.chance(0.5);
      const auto changed = [&](int k) {
        return is_of_rows ? m[to][k] + factor * m[from][k] : m[k][to] + factor * m[k][from];
      };
      if (std::max({std::fabs(changed(0)), std::fabs(changed(1)), std::fabs(changed(2))}) > kLargest) break;
      for (int k = 0; k < 3; ++k) (is_of_rows ? m[to][k] : m[k][to]) = changed(k);
    }
    const Vec3 a{double(random.below(1000)), double(random.below(1000)), double(random.below(1000))};
    const auto point = [&](int row) { return a + Vec3{m[row][0], m[row][1], m[row][2]}; };
    ASSERT_EQ(compare(a, point(0), point(1), point(2)), volume) << i;
  }
}

TEST(predicates_3d, points_of_a_small_grid_have_the_sign_of_integer_arithmetic_at_the_ends_of_the_range) {
  Random random(4);
  int coplanar = 0;
  for (int i = 0; i < 50000; ++i) {
    Vec3 p[4];
    for (Vec3& q : p)
      for (int axis = 0; axis < 3; ++axis) q[axis] = random.below(4);
    const double volume = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]);  // small integers: exact
    const double scale = i % 2 == 0 ? 0x1p-250 : 0x1p248;
    ASSERT_EQ(orient3d(scale * p[0], scale * p[1], scale * p[2], scale * p[3]), (volume > 0) - (volume < 0));
    coplanar += volume == 0;
  }
  EXPECT_GT(coplanar, 1000);
}

TEST(predicates_3d, scaling_brings_any_magnitude_into_the_range_by_a_power_of_two) {
  RunControl control;
  for (const double size : {5e-324, 1e-300, 1.0, 3.4e38, 1.7e308}) {
    const std::vector<Vec3> points = {{size, -size, 0}, {0.5 * size, 0, -0.75 * size}};
    const std::vector<Vec3> scaled = scaled_for_predicates(points, control);
    EXPECT_GE(scaled[0].x, 0x1p249);
    EXPECT_LT(scaled[0].x, 0x1p250);
    // The quotient is a power of two, the same for every coordinate.
    int exponent = 0;
    const double significand = std::frexp(size, &exponent);
    EXPECT_EQ(scaled[0].x, std::ldexp(significand, 250));
    EXPECT_EQ(scaled[0].y, -scaled[0].x);
    EXPECT_EQ(scaled[1].x, std::ldexp(0.5 * size, 250 - exponent));
    EXPECT_EQ(scaled[1].z, std::ldexp(-0.75 * size, 250 - exponent));
  }
  EXPECT_EQ(scaled_for_predicates(std::vector<Vec3>{{0, 0, 0}}, control), (std::vector<Vec3>{{0, 0, 0}}));
}

TEST(predicates_3d, an_axis_along_which_all_is_small_is_stretched) {
  RunControl control;
  const std::vector<Vec3> points = {{1, 0x1p-9, 0x1p-30}, {0.5, 0x1p-11, -0x1p-31}, {0.25, 0, 0}};
  const std::vector<Vec3> scaled = scaled_for_predicates(points, control);
  const double all = 0x1p249;
  EXPECT_EQ(scaled[0], (Vec3{all, 0x1p-9 * all, 0x1p-10 * all}));
  EXPECT_EQ(scaled[1], (Vec3{0.5 * all, 0x1p-11 * all, -0x1p-11 * all}));
  EXPECT_EQ(scaled[2], (Vec3{0.25 * all, 0, 0}));
}

}  // namespace
}  // namespace remesh
