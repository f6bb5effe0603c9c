#include "core/base/tolerance.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

/// Returns points with random coordinates up to `size` in magnitude. The coordinates are those that one reads from a
/// file that was written with this printf format.
std::vector<Vec3> printed(const char* format, double size, int n = 200, std::uint64_t seed = 1) {
  Random random(seed);
  const auto coordinate = [&] {
    char text[64];
    std::snprintf(text, sizeof text, format, random.uniform(-size, size));
    return std::strtod(text, nullptr);
  };
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    points.push_back({x, y, z});
  }
  return points;
}

std::vector<Vec3> with(std::vector<Vec3> points, const std::function<double(double)>& change) {
  for (Vec3& p : points) p = {change(p.x), change(p.y), change(p.z)};
  return points;
}

double rounding_step(const std::vector<Vec3>& points) {
  RunControl control;
  return rounding_of(points, control).step();
}

void expect_step(const std::vector<Vec3>& points, double step) { EXPECT_NEAR(rounding_step(points) / step, 1, 1e-12); }

TEST(rounding_step, fixed_decimals_are_the_step) {
  expect_step(printed("%.6f", 10), 1e-6);
  expect_step(printed("%.6f", 0.5), 1e-6);
  expect_step(printed("%.3f", 800), 1e-3);
  expect_step(printed("%.1f", 3), 1e-1);
}

Rounding rounding(const std::vector<Vec3>& points) {
  RunControl control;
  return rounding_of(points, control);
}

TEST(rounding_step, eleven_free_vertices_show_their_decimals) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    found += std::fabs(rounding_step(printed("%.4f", 10, 11, seed)) / 1e-4 - 1) < 1e-12;
  EXPECT_GE(found, 95);
}

TEST(rounding_step, of_few_vertices_a_part_of_the_step_is_likely_and_all_of_it_possible) {
  int parts = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Rounding few = rounding(printed("%.4f", 10, 4, seed));
    EXPECT_LT(few.step(), 1e-14);
    EXPECT_LE(few.likely_step(), 1e-4);
    EXPECT_GE(few.possible_step(), 1e-4 * (1 - 1e-12));
    parts += few.likely_step() > 1e-7;
  }
  EXPECT_GE(parts, 15);
}

TEST(rounding_step, a_handful_of_short_numbers_proves_nothing) {
  const std::vector<Vec3> crowned{{0, 0, 0},    {200, 0, 0},    {200, 100, 0}, {0, 100, 0},     {0, 0, 10},
                                  {200, 0, 10}, {200, 100, 10}, {0, 100, 10},  {100, 0, 10.01}, {100, 100, 10.01}};
  const std::vector<Vec3> bumped{{0, 0, 0}, {0, 0, 1}, {0.005, 0.005, 0.5}, {-100, 0, 0.5}, {0, -100, 0.5}};
  EXPECT_EQ(rounding_step(crowned), 0x1p-45);
  EXPECT_EQ(rounding_step(bumped), 0x1p-46);
  EXPECT_NEAR(rounding(crowned).possible_step() / 0.01, 1, 1e-12);
  EXPECT_NEAR(rounding(bumped).possible_step() / 0.005, 1, 1e-12);
  // One number with the last digit makes no more likely than a 4096th of it.
  EXPECT_LT(rounding(crowned).likely_step(), 1e-5);
  EXPECT_LT(rounding(bumped).likely_step(), 1e-5);
}

TEST(rounding_step, a_few_free_numbers_among_many_exact_ones_prove_nothing) {
  // Hundreds of multiples of 0.5, and two numbers with three decimals.
  std::vector<Vec3> points = with(printed("%.0f", 300), [](double x) { return x / 2; });
  points.push_back({0.123, 10, 25.517});
  EXPECT_LT(rounding_step(points), 1e-13);
  EXPECT_LT(rounding(points).likely_step(), 1e-4);
  // Twenty vertices of the kind do.
  const std::vector<Vec3> free = printed("%.3f", 100, 20);
  points.insert(points.end(), free.begin(), free.end());
  expect_step(points, 1e-3);
}

TEST(rounding_step, numbers_that_follow_from_few_are_few) {
  const double pi = std::acos(-1);
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  // Holes of the same circle, and a regular grid far from the origin.
  std::vector<Vec3> holes, grid;
  for (int hole = 0; hole < 40; ++hole)
    for (int i = 0; i < 12; ++i)
      holes.push_back(
          {rounded(7.5 * (hole % 8) + std::cos(pi * i / 6)), rounded(9 * (hole / 8) + std::sin(pi * i / 6)), 0});
  for (int i = 0; i < 50; ++i) grid.push_back({1000.37 + 12.5 * i, 512.11 + 12.5 * (i % 7), 3});
  EXPECT_LT(rounding(holes).step(), 1e-13);
  EXPECT_LT(rounding(grid).step(), 1e-12);
}

TEST(rounding_step, repetition_and_signs_add_no_evidence) {
  std::vector<Vec3> points = printed("%.3f", 10, 4);
  const double likely = rounding(points).likely_step();
  for (int i = 0; i < 4; ++i)
    for (const Vec3& p : std::vector<Vec3>(points)) points.push_back(p);
  EXPECT_EQ(rounding(points).likely_step(), likely);
  for (const Vec3& p : std::vector<Vec3>(points)) points.push_back({-p.x, -p.y, -p.z});
  EXPECT_LT(rounding(points).step(), 1e-13);
}

TEST(rounding_step, significant_digits_give_the_last_place_of_the_largest_values) {
  expect_step(printed("%g", 9.99), 1e-5);
  expect_step(printed("%g", 999), 1e-3);
  expect_step(printed("%g", 0.0999), 1e-7);
  expect_step(printed("%.9g", 9.99), 1e-8);
  expect_step(printed("%.9g", 99900), 1e-4);
}

TEST(rounding_step, significant_digits_show_where_the_values_span_one_decade_only) {
  // Between 0.1 and 5.7 six digits are six decimals for the small values and five for the large ones.
  std::vector<Vec3> points;
  Random random(1);
  const auto coordinate = [&] {
    char text[64];
    std::snprintf(text, sizeof text, "%g", random.uniform(0.1, 5.7));
    return std::strtod(text, nullptr);
  };
  for (int i = 0; i < 200; ++i) {
    const double x = coordinate(), y = coordinate();
    points.push_back({x, y, coordinate()});
  }
  expect_step(points, 1e-5);
}

TEST(rounding_step, floats_that_are_no_short_decimals_give_the_last_place_of_the_largest_as_a_float) {
  const std::vector<Vec3> points =
      with(printed("%.17g", 9.99), [](double x) { return static_cast<double>(static_cast<float>(x)); });
  EXPECT_EQ(rounding_step(points), 0x1p-20);
}

TEST(rounding_step, floats_printed_to_more_places_than_they_have_give_their_own_last_place) {
  // As exporters do that hold floats: six decimals, nine digits, or as many as tell one float from the next.
  const auto as_float = [](double x) { return static_cast<float>(x); };
  const auto decimals = [&](const char* format) {
    return [=](double x) {
      char text[64];
      std::snprintf(text, sizeof text, format, static_cast<double>(as_float(x)));
      return std::strtod(text, nullptr);
    };
  };
  const auto fewest_digits = [&](double x) {
    char text[64];
    const auto end = std::to_chars(text, text + sizeof text - 1, as_float(x)).ptr;
    *end = 0;
    return std::strtod(text, nullptr);
  };
  EXPECT_EQ(rounding_step(with(printed("%.17g", 250), decimals("%.6f"))), 0x1p-16);
  EXPECT_EQ(rounding_step(with(printed("%.17g", 31), decimals("%.6f"))), 0x1p-19);
  EXPECT_EQ(rounding_step(with(printed("%.17g", 9.99), decimals("%.9g"))), 0x1p-20);
  EXPECT_EQ(rounding_step(with(printed("%.17g", 31), fewest_digits)), 0x1p-19);
  EXPECT_EQ(rounding_step(with(printed("%.17g", 9990), fewest_digits)), 0x1p-10);
  // Six digits are coarser than floats.
  expect_step(with(printed("%.17g", 9.99), decimals("%g")), 1e-5);
}

TEST(rounding_step, floats_of_few_binades_give_the_last_place_of_the_largest) {
  const auto between_20_and_100 = [](double x) { return static_cast<double>(static_cast<float>(60 + 40 * x)); };
  EXPECT_EQ(rounding_step(with(printed("%.17g", 1), between_20_and_100)), 0x1p-17);
}

TEST(rounding_step, a_zero_that_arithmetic_has_missed_hides_no_digits) {
  for (const char* format : {"%g", "%.6f", "%.9g"}) {
    std::vector<Vec3> points = printed(format, 9.99);
    const double step = rounding_step(points);
    points.front().z = 6.12323e-17;
    points.back().x = -1.22465e-15;
    EXPECT_EQ(rounding_step(points), step) << format;
  }
}

TEST(rounding_step, digits_are_counted_across_a_power_of_ten) {
  // All values are of two decades, the largest just in the higher one.
  Random random(1);
  const auto coordinate = [&] {
    char text[64];
    std::snprintf(text, sizeof text, "%.6g", random.uniform(52, 104));
    return std::strtod(text, nullptr);
  };
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) {
    const double x = coordinate(), y = coordinate();
    points.push_back({x, y, coordinate()});
  }
  expect_step(points, 1e-3);
}

TEST(rounding_step, a_one_beside_numbers_below_it_adds_no_digit) {
  std::vector<Vec3> points = printed("%g", 0.999);
  const double step = rounding_step(points);
  points.front() = {1, 1, 1};
  points.back().x = -1;
  EXPECT_EQ(rounding_step(points), step);
}

TEST(rounding_step, decimals_far_from_the_origin_show) {
  for (const auto& [format, origin, step] :
       {std::tuple("%.3f", 5e6, 1e-3), {"%.6f", 5e6, 1e-6}, {"%.3f", 1.3e9, 1e-3}, {"%.1f", 5e10, 1e-1}}) {
    Random random(1);
    std::vector<Vec3> points;
    const auto coordinate = [&, format = format, origin = origin] {
      char text[64];
      std::snprintf(text, sizeof text, format, origin + random.uniform(-100, 100));
      return std::strtod(text, nullptr);
    };
    for (int i = 0; i < 50; ++i) {
      const double x = coordinate(), y = coordinate();
      points.push_back({x, y, coordinate()});
    }
    expect_step(points, step);
  }
}

TEST(rounding_step, digits_show_at_every_scale) {
  for (const double scale : {1e-12, 1e-9, 1e-6, 1e3, 1e6, 1e9, 1e10, 1e11, 1e12})
    expect_step(printed("%g", 9.99 * scale), 1e-5 * scale);
}

TEST(rounding_step, each_coordinate_has_its_own) {
  std::vector<Vec3> points = printed("%g", 9.99);
  const std::vector<Vec3> larger = printed("%g", 999);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].y = larger[i].y;
  RunControl control;
  const Vec3 steps = rounding_of(points, control).steps;
  EXPECT_NEAR(steps.x / 1e-5, 1, 1e-12);
  EXPECT_NEAR(steps.y / 1e-3, 1, 1e-12);
  EXPECT_NEAR(steps.z / 1e-5, 1, 1e-12);
}

TEST(rounding_step, full_doubles_give_the_last_place_of_the_largest_double) {
  EXPECT_EQ(rounding_step(printed("%.17g", 9.99)), 0x1p-49);
}

TEST(rounding_step, many_whole_numbers_have_a_step_of_one_and_a_cube_has_none) {
  expect_step(printed("%.0f", 100), 1);
  EXPECT_EQ(rounding_step({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}), 0x1p-52);
}

TEST(rounding_step, the_origin_alone_has_none) { EXPECT_EQ(rounding_step(std::vector<Vec3>{{0, 0, 0}}), 0); }

TEST(rounding_step, scaling_by_powers_of_two_scales_it) {
  std::vector<std::vector<Vec3>> families = {printed("%.6f", 10), printed("%.3f", 10), printed("%g", 10),
                                             printed("%.9g", 10), printed("%.0f", 10), printed("%.17g", 10)};
  families.push_back(with(families.back(), [](double x) { return static_cast<double>(static_cast<float>(x)); }));
  // A step of its own for each coordinate.
  families.push_back(families.back());
  for (Vec3& p : families.back()) p = {p.x, 16 * p.y, 1024 * p.z};
  // Squares of the largest and the smallest are no doubles, nor are the largest times ten to the number of decimals.
  for (std::size_t i = 0; i < families.size(); ++i)
    for (const int k : {-600, -60, -40, -7, -1, 1, 3, 40, 60, 600, 1000}) {
      const double scale = std::ldexp(1.0, k);
      EXPECT_EQ(rounding_step(with(families[i], [&](double x) { return scale * x; })),
                scale * rounding_step(families[i]))
          << "family " << i << ", 2^" << k;
    }
}

TEST(rounding_step, one_value_among_many_can_change_it) {
  std::vector<Vec3> points = printed("%.6f", 9.99, 20'000);
  expect_step(points, 1e-6);
  points.back().y = 1.0 / 3;
  EXPECT_EQ(rounding_step(points), 0x1p-49);
  // One number with seven decimals does not prove these, but that six are wrong.
  points.back().y = 9.1234567;
  EXPECT_EQ(rounding_step(points), 0x1p-49);
  EXPECT_NEAR(rounding(points).possible_step() / 1e-7, 1, 1e-9);
}

TEST(rounding_step, the_order_of_the_values_does_not_matter) {
  for (const auto& [format, n] : {std::pair("%.6f", 200), {"%g", 200}, {"%.17g", 200}, {"%g", 20'000}}) {
    std::vector<Vec3> points = printed(format, 10, n);
    const double step = rounding_step(points);
    EXPECT_EQ(rounding_step(std::vector<Vec3>(points.rbegin(), points.rend())), step) << format;
    for (Vec3& p : points) p = {p.z, -p.x, p.y};
    EXPECT_EQ(rounding_step(points), step) << format;
  }
}

/// Steps that are the same for all coordinates.
Rounding steps(double proven, double likely, double possible) {
  return {{proven, proven, proven}, {likely, likely, likely}, {possible, possible, possible}, true};
}

TEST(automatic_tolerance, small_steps_count_without_doubt_be_they_proven_or_not) {
  for (const Rounding& rounding : {steps(1e-7, 1e-7, 1e-7), steps(1e-16, 1e-12, 1e-7)}) {
    const AutomaticTolerance tolerance = automatic_tolerance(rounding, 1);
    EXPECT_DOUBLE_EQ(tolerance.value, 2.6e-7);
    EXPECT_EQ(tolerance.if_bent, tolerance.value);
    EXPECT_EQ(tolerance.if_noisy, tolerance.value);
  }
}

TEST(automatic_tolerance, it_never_falls_below_the_floor) {
  const Rounding full = steps(1e-16, 1e-16, 1e-16), none;
  EXPECT_DOUBLE_EQ(automatic_tolerance(full, 20).value, 20e-9);
  EXPECT_DOUBLE_EQ(automatic_tolerance(none, 20).if_noisy, 20e-9);
}

TEST(automatic_tolerance, coarse_steps_count_only_where_noise_is_seen_and_never_beyond_the_ceiling) {
  const AutomaticTolerance whole = automatic_tolerance(steps(1, 1, 1), 2000);
  EXPECT_DOUBLE_EQ(whole.value, 2e-6);
  EXPECT_DOUBLE_EQ(whole.if_bent, 2e-3);
  EXPECT_DOUBLE_EQ(whole.if_noisy, 0.2);
  EXPECT_DOUBLE_EQ(whole.explained, 2.6);
  const AutomaticTolerance coarse = automatic_tolerance(steps(1e-5, 1e-5, 1e-5), 1);
  EXPECT_DOUBLE_EQ(coarse.value, 1e-9);
  EXPECT_DOUBLE_EQ(coarse.if_bent, 1e-6);
  EXPECT_DOUBLE_EQ(coarse.if_noisy, 2.6e-5);
}

TEST(automatic_tolerance, a_coarse_step_that_is_not_proven_explains_a_millionth_of_the_diagonal_at_most) {
  const AutomaticTolerance crowned = automatic_tolerance(steps(1e-14, 1e-9, 0.01), 223);
  EXPECT_DOUBLE_EQ(crowned.value, 223e-9);
  EXPECT_DOUBLE_EQ(crowned.if_bent, 223e-6);
  EXPECT_EQ(crowned.if_noisy, crowned.if_bent);
}

}  // namespace
}  // namespace remesh
