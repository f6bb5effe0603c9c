#include "core/verify/model/fixed_width_integers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/cgal_plane.h"
#include "tests/support/cgal_space.h"

namespace remesh::verification {
namespace {

double on_grid(double t, double grid) { return std::nearbyint(t / grid) * grid; }

/// Points that are nearly, and often exactly, on a line or a circle.
class NearlyDegenerate {
 public:
  NearlyDegenerate(unsigned seed, double grid) : random_(seed), grid_(grid) {}

  Vec2 on_line(Vec2 a, Vec2 b) {
    const double t = unit_(random_);
    return nudged({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
  }
  Vec2 on_circle() {
    const double angle = 3.2 * unit_(random_);
    return nudged({0.7 * std::cos(angle), 0.7 * std::sin(angle)});
  }
  Vec2 anywhere() { return nudged({unit_(random_), unit_(random_)}); }
  /// One of the corners of a grid of squares: many of these are exactly cocircular or collinear.
  Vec2 lattice() {
    return {static_cast<double>(static_cast<int>(random_() % 5) - 2) / 4,
            static_cast<double>(static_cast<int>(random_() % 5) - 2) / 4};
  }

 private:
  Vec2 nudged(Vec2 p) {
    const auto step = [&] { return (static_cast<int>(random_() % 3) - 1) * grid_; };
    return {on_grid(p.x, grid_) + step(), on_grid(p.y, grid_) + step()};
  }
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{-0.9, 0.9};
  double grid_;
};

class exact : public ::testing::TestWithParam<double> {};

TEST_P(exact, orientation_agrees_with_cgal) {
  const double grid = GetParam();
  NearlyDegenerate points(1, grid);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec2 a = i % 2 ? points.lattice() : points.anywhere(), b = i % 2 ? points.lattice() : points.anywhere();
    const Vec2 c = i % 2 ? points.lattice() : points.on_line(a, b);
    const int expected = cgal_orientation(a, b, c);
    ASSERT_EQ(orientation(a, b, c, grid), expected) << i;
    zeros += expected == 0;
  }
  EXPECT_GT(zeros, 100);
}

TEST_P(exact, in_circle_agrees_with_cgal) {
  const double grid = GetParam();
  NearlyDegenerate points(2, grid);
  int inside = 0, on = 0;
  for (int i = 0; i < 40000; ++i) {
    const auto next = [&] { return i % 2 ? points.lattice() : points.on_circle(); };
    const Vec2 a = next(), d = next();
    Vec2 b = next(), c = next();
    if (orientation(a, b, c, grid) == 0) continue;
    if (orientation(a, b, c, grid) < 0) std::swap(b, c);
    const int side = cgal_in_circle(a, b, c, d);
    ASSERT_EQ(is_inside_circle(a, b, c, d, grid), side > 0) << i;
    inside += side > 0;
    on += side == 0;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(on, 100);
}

INSTANTIATE_TEST_SUITE_P(both_grids, exact, ::testing::Values(kCoarseGrid, kFineGrid));

TEST(exact, numbers_off_the_grid_are_seen) {
  EXPECT_TRUE(is_on_grid({1, -1}, kCoarseGrid));
  EXPECT_TRUE(is_on_grid({0x1p-40, 0}, kCoarseGrid));
  EXPECT_FALSE(is_on_grid({0x1p-41, 0}, kCoarseGrid));
  EXPECT_TRUE(is_on_grid({0x1p-41, 0x1p-100}, kFineGrid));
  EXPECT_FALSE(is_on_grid({0x1p-101, 0}, kFineGrid));
  EXPECT_FALSE(is_on_grid({0, 1 + 0x1p-40}, kCoarseGrid));
  EXPECT_FALSE(is_on_grid({0, NAN}, kCoarseGrid));
}

TEST(exact, collinear_in_space_is_exact) {
  EXPECT_TRUE(is_collinear({0, 0, 0}, {1, 2, 3}, {3, 6, 9}));
  EXPECT_TRUE(is_collinear({1, 1, 1}, {1, 1, 1}, {5, 6, 7}));
  // 0.1 + 0.2 is not 0.3: the three are off a line by the last place.
  EXPECT_FALSE(is_collinear({0, 0, 0}, {0.1, 0.1, 1}, {0.2, 0.3, 2}));
  EXPECT_FALSE(is_collinear({0, 0, 0}, {1, 1, 1}, {2, 2, std::nextafter(2.0, 3.0)}));
  EXPECT_FALSE(is_collinear({1e-8, 1e8, 0}, {2e-8, 1e8, 0}, {1.5e-8, std::nextafter(1e8, 0.0), 0}));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 a{unit(random), unit(random), unit(random)}, d{unit(random), unit(random), unit(random)};
    const double s = std::ldexp(1.0, static_cast<int>(random() % 8)), t = static_cast<double>(random() % 5);
    const Vec3 b = a + s * d, c = a + t * d;
    ASSERT_EQ(is_collinear(a, b, c), cgal_is_collinear(a, b, c)) << i;
  }
}

}  // namespace
}  // namespace remesh::verification
