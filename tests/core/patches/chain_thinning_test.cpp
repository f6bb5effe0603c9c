#include "core/patches/chains/chain_thinning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

const AnalyticSurface kCylinder{SurfaceKind::kCylinder, {}, {0, 0, 1}, 1, 0, 0};

ChainRoom everywhere(std::size_t nodes, double tolerance) {
  return {std::vector<double>(nodes, tolerance), std::vector<double>(nodes - 1, tolerance), false};
}

/// Points of a wave on a cylinder of radius 1, at uneven steps.
std::vector<Vec3> wave(std::size_t count, double turn, unsigned seed) {
  Random random(seed);
  std::vector<double> angles{0, turn};
  while (angles.size() < count) angles.push_back(random.uniform(0, turn));
  std::sort(angles.begin(), angles.end());
  std::vector<Vec3> points;
  for (const double a : angles) points.push_back({std::cos(a), std::sin(a), 0.3 * std::sin(2 * a)});
  return points;
}

/// Returns whether the nodes between two others may be dropped, by formulas of its own.
bool may_join(const std::vector<Vec3>& points, std::size_t i, std::size_t j, const ChainLimits& limits) {
  if (j == i + 1) return true;
  const double length = norm(points[j] - points[i]);
  double reached = 0;
  for (std::size_t k = i + 1; k <= j; ++k) {
    const Vec3 &a = points[i], &p = points[k];
    const double turn = std::fabs(std::remainder(std::atan2(p.y, p.x) - std::atan2(a.y, a.x), 2 * std::numbers::pi));
    if (turn > limits.max_turn * (1 + 1e-8)) return false;
    if (k == j) break;
    const double along = dot(p - a, points[j] - a) / length;
    if (along <= reached || along >= length) return false;
    if (std::sqrt(std::max(0.0, norm_squared(p - a) - along * along)) > limits.tolerance * (1 + 1e-6)) return false;
    reached = along;
  }
  return true;
}

/// Returns the fewest pieces, found by dynamic programming.
std::size_t fewest_pieces(const std::vector<Vec3>& points, const ChainLimits& limits) {
  std::vector<std::size_t> pieces(points.size(), std::numeric_limits<std::size_t>::max());
  pieces[0] = 0;
  for (std::size_t j = 1; j < points.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      if (may_join(points, i, j, limits)) pieces[j] = std::min(pieces[j], pieces[i] + 1);
  return pieces.back();
}

TEST(chain_thinning, few_nodes_stay_and_all_others_are_near_their_chords) {
  const AnalyticSurface* const surface = &kCylinder;
  for (unsigned seed = 0; seed < 60; ++seed)
    for (const ChainLimits& limits :
         {ChainLimits{0.01, std::numbers::pi}, {0.1, std::numbers::pi}, {10, 0.4}, {0.03, 0.7}}) {
      const auto points = wave(40, 2.5, seed);
      const auto kept =
          thin_chain(points, {&surface, 1}, limits, everywhere(points.size(), limits.tolerance), RunControl());
      ChainLimits used = limits;
      used.max_turn = turn_limit(limits.max_turn);
      std::size_t before = 0;
      for (const std::uint32_t k : kept) {
        ASSERT_LT(before, k);
        EXPECT_TRUE(may_join(points, before, k, used));
        before = k;
      }
      ASSERT_LT(before, points.size() - 1);
      EXPECT_TRUE(may_join(points, before, points.size() - 1, used));
      const std::size_t fewest = fewest_pieces(points, used);
      EXPECT_GE(kept.size() + 1, fewest);
      EXPECT_LE(kept.size() + 1, fewest + 1);
    }
}

TEST(chain_thinning, a_closed_chain_keeps_three_nodes) {
  const AnalyticSurface* const surface = &kCylinder;
  for (const std::size_t count : {4u, 5u, 7u, 30u}) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
      const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
      points.push_back({std::cos(a), std::sin(a), 0});
    }
    points.push_back(points.front());
    const auto kept = thin_chain(points, {&surface, 1}, {100, 2 * std::numbers::pi / 3}, everywhere(points.size(), 100),
                                 RunControl());
    EXPECT_GE(kept.size(), 2u) << count;
    if (count == 30) {
      EXPECT_EQ(kept, (std::vector<std::uint32_t>{10, 20}));
    }
  }
}

TEST(chain_thinning, evenly_spaced_nodes_stay_at_even_distances) {
  const AnalyticSurface* const surface = &kCylinder;
  std::vector<Vec3> points;
  for (int i = 0; i <= 52; ++i) points.push_back({std::cos(0.02 * i), std::sin(0.02 * i), 0});
  // Pieces of 0.3 are allowed: the longest ones would leave 7 steps of 52 for the last one.
  const auto kept = thin_chain(points, {&surface, 1}, {1, 0.3}, everywhere(points.size(), 1), RunControl());
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{13, 26, 39}));
}

TEST(chain_thinning, a_node_without_room_stays) {
  const AnalyticSurface* const surface = &kCylinder;
  const auto points = wave(30, 1.5, 3);
  ChainRoom room = everywhere(points.size(), 10);
  room.at_node[17] = 0;
  const auto kept = thin_chain(points, {&surface, 1}, {10, std::numbers::pi}, room, RunControl());
  EXPECT_TRUE(std::find(kept.begin(), kept.end(), 17u) != kept.end());
  EXPECT_LT(kept.size(), 5u);
}

TEST(chain_thinning, long_chains_take_time_in_proportion) {
  // If each piece looked at all nodes before it, this would take minutes.
  const AnalyticSurface* const surface = &kCylinder;
  std::vector<Vec3> points;
  for (int i = 0; i <= 400'000; ++i) points.push_back({std::cos(5e-6 * i), std::sin(5e-6 * i), 0});
  const auto kept = thin_chain(points, {&surface, 1}, {1, 0.5}, everywhere(points.size(), 1), RunControl());
  EXPECT_EQ(kept.size(), 3u);
}

}  // namespace
}  // namespace remesh
