#include "core/refinement/segments/corner_rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/gap_search.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"
#include "tests/support/time_to_stop.h"

// The effect of corner rings on whole surfaces is tested in tests/core/refinement_sharp_corners_test.cpp.

namespace remesh {
namespace {

SegmentTable planned(const StageChain& chain, const SizeField& sizes, const Goals& goals, RunControl& control) {
  SegmentTable table(chain.surface, chain.triangulated, IdVector<PatchId, std::uint8_t>(chain.meshes.size()), sizes,
                     goals, control);
  table.plan_cuts(chain.triangulated, sizes, goals, control);
  return table;
}

/// Returns the distances of a side's cuts from the corner at the origin, ascending.
std::vector<double> distances(const StageChain& chain, const SegmentTable& table, const SizeField& sizes,
                              const Vec3& end) {
  for (std::uint32_t s = 0; s < table.size(); ++s) {
    const BoundarySegment& segment = table[SegmentId(s)];
    const std::set<VertexId> ends{segment.from, segment.to};
    if (ends != std::set<VertexId>{chain.at({0, 0, 0}), chain.at(end)}) continue;
    std::vector<double> found;
    for (const double t : table.size_cuts(SegmentId(s), sizes)) found.push_back(norm(table.position(SegmentId(s), t)));
    std::sort(found.begin(), found.end());
    return found;
  }
  ADD_FAILURE() << "no such side";
  return {};
}

TEST(corner_rings, the_sides_of_a_corner_are_cut_by_turns_in_pieces_that_grow) {
  const double degrees = 3, size = 0.1, bound = 25, tangent = std::tan(bound * std::numbers::pi / 180);
  const double angle = degrees * std::numbers::pi / 180, width = 2 * std::sin(angle / 2);
  StageChain chain(shapes::triangle(degrees, 1, 1));
  const SizeField sizes(size);
  const Goals goals = goals_of(with_angle(bound), 1);
  const SegmentTable table = planned(chain, sizes, goals, chain.control);
  std::vector<double> a = distances(chain, table, sizes, {1, 0, 0}),
                      b = distances(chain, table, sizes, {std::cos(angle), std::sin(angle), 0});
  ASSERT_GT(std::min(a.size(), b.size()), 10u);
  EXPECT_EQ(a[0], size);
  EXPECT_NEAR(b[0], size, 1e-12);
  if (a[1] < b[1]) std::swap(a, b);
  // Behind the last rings, each side is cut on its own.
  const double near = 0.8 * size / width;
  for (std::size_t i = 1; i < std::min(a.size(), b.size()) && a[i] < near; ++i) {
    EXPECT_LT(a[i - 1], b[i]);
    EXPECT_LT(b[i], a[i]);
    EXPECT_LE(a[i] - a[i - 1], size * (1 + 1e-9));
    // The angles at the base of a triangle whose top is on the other side.
    EXPECT_GE(width * b[i] / (a[i] - b[i]), tangent) << i;
    EXPECT_GE(width * b[i] / (b[i] - a[i - 1]), tangent) << i;
    if (i > 1) {
      EXPECT_GE(width * a[i - 1] / (b[i] - a[i - 1]), tangent) << i;
      EXPECT_GE(width * a[i - 1] / (a[i - 1] - b[i - 1]), tangent) << i;
    }
  }
}

/// A triangle beside the x axis, and far from it two sheets that are near each other. Thus sizes vary, but at the
/// triangle the size is the largest.
struct WhereSizesVary {
  static constexpr double kSize = 0.1;

  WhereSizesVary(double degrees, double other_side)
      : chain(shapes::joined(shapes::triangle(degrees, 1, other_side), sheets())),
        goals(goals_of(options(), 1)),
        gaps(chain.surface, chain.adjacency, chain.patches, 1e-12, chain.control),
        sizes(chain.surface, &gaps, {}, goals, 1e-12, chain.control),
        table(planned(chain, sizes, goals, chain.control)) {
    EXPECT_FALSE(sizes.is_uniform());
  }
  std::vector<double> distances_to(const Vec3& end) { return distances(chain, table, sizes, end); }

  static PolygonMesh sheets() {
    const PolygonMesh sheet = shapes::moved(shapes::sheet(1, 1, 1, 1), {9, 0, 0});
    return shapes::joined(sheet, shapes::moved(sheet, {0, 0, 0.05}));
  }
  static Options options() {
    Options options = with_angle(25);
    options.max_edge_length = kSize;
    options.proximity = 1;
    return options;
  }

  StageChain chain;
  Goals goals;
  GapSearch gaps;
  SizeField sizes;
  SegmentTable table;
};

TEST(corner_rings, where_sizes_vary_a_side_that_ends_within_one_is_all_of_the_corner) {
  const double degrees = 4, angle = degrees * std::numbers::pi / 180;
  for (const double shorter : {0.06, 0.08, 0.0999}) {
    WhereSizesVary scene(degrees, shorter);
    const StageChain& chain = scene.chain;
    const SegmentTable& table = scene.table;
    const Vec3 end{shorter * std::cos(angle), shorter * std::sin(angle), 0};
    EXPECT_TRUE(scene.distances_to(end).empty()) << shorter;
    const std::vector<double> cuts = scene.distances_to({1, 0, 0});
    ASSERT_FALSE(cuts.empty());
    EXPECT_NEAR(cuts[0], shorter, 1e-9);
    // If that has to be cut again, then in halves.
    int tried = 0;
    for (std::uint32_t k = 0; k < table.size(); ++k) {
      const BoundarySegment& side = table[SegmentId(k)];
      if (side.from != chain.at({0, 0, 0}) || side.to != chain.at({1, 0, 0})) continue;
      EXPECT_NEAR(table.cut(SegmentId(k), 0, shorter).value_or(0), shorter / 2, 1e-9);
      ++tried;
    }
    EXPECT_EQ(tried, 1);
  }
}

TEST(corner_rings, where_sizes_vary_the_triangle_in_a_wide_corner_is_longer) {
  const auto first_cut = [](double degrees) {
    const std::vector<double> cuts = WhereSizesVary(degrees, 1).distances_to({1, 0, 0});
    return cuts.empty() ? 0 : cuts[0];
  };
  const double needle = first_cut(4), wide = first_cut(10);
  EXPECT_GE(needle, WhereSizesVary::kSize / 2);
  EXPECT_GT(wide, needle);
  EXPECT_LT(wide, WhereSizesVary::kSize);
}

TEST(corner_rings, without_a_size_or_a_bound_on_angles_there_are_none) {
  StageChain chain(shapes::triangle(3, 1, 1));
  for (const auto& [bound, size] : {std::pair(25.0, HUGE_VAL), std::pair(0.0, 0.1)}) {
    Options options = with_angle(bound);
    const Goals goals = goals_of(options, 1);
    const SizeField sizes(size);
    const SegmentTable table = planned(chain, sizes, goals, chain.control);
    const std::vector<double> cuts = distances(chain, table, sizes, {1, 0, 0});
    ASSERT_EQ(cuts.size(), std::isfinite(size) ? 9u : 0u);
    for (std::size_t i = 0; i < cuts.size(); ++i) EXPECT_NEAR(cuts[i], 0.1 * static_cast<double>(i + 1), 1e-12);
  }
}

TEST(corner_rings, a_stop_is_obeyed_soon_on_the_way_along_many_sides) {
  PolygonMesh fan = solids::needle_fan(50'000, 0.007);
  for (Vec3& p : fan.positions) p.z *= 0.012;  // as sharp as from above, but not flat
  StageChain chain(fan);
  const SizeField sizes(3e-4);
  const Goals goals = goals_of(with_angle(25), 1);
  const auto took =
      test::time_to_stop(test::Seconds(0.1), [&](RunControl& control) { planned(chain, sizes, goals, control); });
  ASSERT_TRUE(took) << "it ended before it was stopped";
  // The promise is 100 ms. Without a stop it is some seconds.
  test::expect_within(test::Seconds(0.5), *took);
}

TEST(corner_rings, where_few_faces_are_allowed_many_corners_are_cut_together_for_fewer_pieces) {
  // Each needle would take a million pieces.
  PolygonMesh needles;
  constexpr int kNeedles = 20;
  for (int i = 0; i < kNeedles; ++i) {
    const PolygonMesh needle = shapes::moved(shapes::triangle(1e-5, 1, 1), {0, 2.0 * i, 0});
    needles = i == 0 ? needle : shapes::joined(needles, needle);
  }
  StageChain chain(needles);
  const SizeField sizes(1e-6);
  const auto cuts_of_all = [&](std::uint64_t max_faces) {
    Goals goals = goals_of(with_angle(25), 1);
    goals.max_faces = max_faces;
    const SegmentTable table = planned(chain, sizes, goals, chain.control);
    std::size_t cuts = 0;
    for (std::uint32_t s = 0; s < table.size(); ++s) cuts += table.size_cuts(SegmentId(s), sizes, max_faces).size();
    return cuts;
  };
  EXPECT_LT(cuts_of_all(1000), std::size_t{2} * kNeedles * (1024 + 1000));
  EXPECT_GT(cuts_of_all(1'000'000), std::size_t{2} * kNeedles * 100'000) << "what is allowed is used";
}

}  // namespace
}  // namespace remesh
