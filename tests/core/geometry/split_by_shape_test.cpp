#include "core/geometry/trees/split_by_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Splits triangles in halves. Returns for each whether it is in the first half.
std::vector<bool> halves(const std::vector<Vec3>& corners) {
  RunControl control;
  std::vector<ShapedItem> items;
  for (std::uint32_t i = 0; i + 2 < corners.size(); i += 3) {
    const Triangle face{VertexId(i), VertexId(i + 1), VertexId(i + 2)};
    items.push_back({place_of(face, corners), reach_of(face, corners), 0, FaceId(i / 3)});
  }
  split_by_shape(items, items.size() / 2, control);
  std::vector<bool> is_first(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) is_first[items[i].face.value] = i < items.size() / 2;
  return is_first;
}

/// Adds a needle of this width from one place to another.
void add_needle(std::vector<Vec3>& corners, const Vec3& from, const Vec3& to) {
  corners.insert(corners.end(), {from, from + Vec3{1e-4, 2e-4, -1e-4}, to});
}

/// Returns how often two neighbours are in different halves.
int changes(const std::vector<bool>& is_first) {
  int count = 0;
  for (std::size_t i = 1; i < is_first.size(); ++i) count += is_first[i] != is_first[i - 1];
  return count;
}

TEST(split_by_shape, needles_side_by_side_are_split_between_them_whatever_their_lengths) {
  // They lie askew to the axes, and their ends are spread far more than the needles are apart.
  Random random(1);
  const Vec3 along{2, 1, 2}, across{1, 2, -2};
  std::vector<Vec3> corners;
  for (int i = 0; i < 200; ++i)
    add_needle(corners, 0.001 * i * across - random.unit() * along, 0.001 * i * across + (1 + random.unit()) * along);
  EXPECT_EQ(changes(halves(corners)), 1);
}

TEST(split_by_shape, needles_that_cross_at_one_place_are_split_by_direction) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 200; ++i) {
    const double angle = std::numbers::pi / 2 * (i + 0.5) / 200;
    const Vec3 way{std::cos(angle), std::sin(angle), 0.3};
    add_needle(corners, -way, way);
  }
  EXPECT_EQ(changes(halves(corners)), 1);
}

TEST(split_by_shape, large_triangles_are_split_from_small_ones_at_the_same_place) {
  Random random(2);
  std::vector<Vec3> corners;
  for (int i = 0; i < 200; ++i) {
    const double size = i < 100 ? 0.01 : 1;
    const Vec3 middle = 0.05 * Vec3{random.unit(), random.unit(), random.unit()};
    corners.insert(corners.end(), {middle - size * Vec3{1, 1, 0}, middle + size * Vec3{1, 0, 1}, middle});
  }
  EXPECT_EQ(changes(halves(corners)), 1);
}

TEST(split_by_shape, sheets_askew_to_the_axes_are_split_between_them_however_they_are_divided_into_triangles) {
  // The centres of the triangles' boxes do not lie in the sheets.
  const Vec3 u{2, 1, 2}, v{1, 2, -2}, normal{-2, 2, 1};
  std::vector<Vec3> corners;
  for (int i = 0; i < 100; ++i) {
    const Vec3 at = 0.001 * i * normal;
    const std::vector<Vec3> sheet{at - u - v, at + u - v, at + u + v, at - u + v};
    for (const int k : {0, 2})
      for (const int corner : {k, k + 1, k + 2 + (i % 3 == 0 ? 0 : 1)}) corners.push_back(sheet[corner % 4]);
  }
  EXPECT_EQ(changes(halves(corners)), 1);
}

TEST(split_by_shape, triangles_without_extent_are_split_all_the_same) {
  const std::vector<bool> is_first = halves(std::vector<Vec3>(30, Vec3{1, 2, 3}));
  EXPECT_EQ(std::count(is_first.begin(), is_first.end(), true), 5);
}

TEST(split_by_shape, needles_of_any_size_are_split_alike) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 64; ++i) add_needle(corners, {0, 0.1 * i, 0}, {1, 0.1 * i + 0.5, 0.01 * i});
  const std::vector<bool> expected = halves(corners);
  ASSERT_EQ(changes(expected), 1);
  for (const int exponent : {-1000, -600, 500, 1000}) {
    std::vector<Vec3> scaled = corners;
    for (Vec3& p : scaled) p = std::ldexp(1.0, exponent) * p;
    EXPECT_EQ(halves(scaled), expected) << exponent;
  }
}

STAGE(split_by_shape, test::kStop) {
  std::vector<ShapedItem> items(4);
  split_by_shape(items, 2, trial.control);
}

}  // namespace
}  // namespace remesh
