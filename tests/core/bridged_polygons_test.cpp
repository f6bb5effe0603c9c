// Tests random polygons that are one face each, because their holes hang on bridges. The result has their area.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "core/geometry/exact/predicates.h"
#include "core/remesh.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using polygons::Loop;

/// Returns whether the closed segments touch anywhere but in a common end.
bool is_blocked_by(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const auto is_between = [](Vec2 p, Vec2 q, Vec2 x) {
    return orient2d(p, q, x) == 0 && std::min(p, q) < x && x < std::max(p, q);
  };
  if (is_between(a, b, c) || is_between(a, b, d) || is_between(c, d, a) || is_between(c, d, b)) return true;
  if (a == c || a == d || b == c || b == d) return (a == c && b == d) || (a == d && b == c);
  return orient2d(a, b, c) * orient2d(a, b, d) <= 0 && orient2d(c, d, a) * orient2d(c, d, b) <= 0;
}

bool is_blocked(Vec2 a, Vec2 b, const Loop& loop) {
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (is_blocked_by(a, b, loop[i], loop[(i + 1) % loop.size()])) return true;
  return false;
}

/// Turns a polygon into one loop, in which each hole hangs on a random bridge.
/// Output: how many holes found a corner of the outline that no other bridge uses.
std::size_t hang_holes(const polygons::Polygon& polygon, Random& random, Loop& outline) {
  outline = polygon.outer;
  std::size_t hung = 0;
  for (const Loop& hole : polygon.holes) {
    std::map<Vec2, int> times;
    for (const Vec2 p : outline) ++times[p];
    std::vector<std::pair<std::size_t, std::size_t>> bridges;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (times[outline[i]] > 1) continue;
      for (std::size_t j = 0; j < hole.size(); ++j) {
        const auto blocks = [&](const Loop& loop) { return is_blocked(outline[i], hole[j], loop); };
        if (!blocks(outline) && std::none_of(polygon.holes.begin(), polygon.holes.end(), blocks))
          bridges.push_back({i, j});
      }
    }
    if (bridges.empty()) return hung;
    const auto [at, from] = bridges[static_cast<std::size_t>(random.below(static_cast<int>(bridges.size())))];
    Loop detour;
    for (std::size_t k = 0; k <= hole.size(); ++k) detour.push_back(hole[(from + k) % hole.size()]);
    detour.push_back(outline[at]);
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(at) + 1, detour.begin(), detour.end());
    ++hung;
  }
  return hung;
}

TEST(bridged_polygons, their_holes_come_back_as_loops_and_their_area_is_kept) {
  std::size_t tested = 0, most_holes = 0;
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const polygons::Polygon polygon = seed % 2 ? polygons::star_with_holes(seed, 8 + seed, 1 + seed % 4)
                                               : polygons::rectilinear_with_holes(seed, 4 + seed / 4);
    Loop loop;
    if (hang_holes(polygon, random, loop) < polygon.holes.size()) continue;
    PolygonMesh mesh = shapes::polygon(loop);
    if (seed % 3) mesh = solids::placed(mesh, polygons::random_placement(seed, seed % 3 == 1 ? 1 : 1e6));
    const Vec3 a = mesh.positions[VertexId(0)], b = mesh.positions[VertexId(1)];
    const double unit = norm(b - a) / norm(loop[1] - loop[0]), area = unit * unit * polygons::area(polygon);
    RunControl control;
    const Result result = remesh_surface(mesh, unrefined(), {}, control);
    EXPECT_TRUE(result.report.verified.all_true());
    ASSERT_EQ(result.report.patches.size(), 1u);
    EXPECT_EQ(result.report.patches[0].loops, 1 + polygon.holes.size());
    EXPECT_NEAR(result.report.output.area, area, 1e-9 * area);
    EXPECT_EQ(result.report.output.intersecting_pairs, 0u);
    EXPECT_EQ(result.mesh.faces.size(), result.mesh.positions.size() + 2 * polygon.holes.size() - 2);
    ++tested;
    most_holes = std::max(most_holes, polygon.holes.size());
  }
  EXPECT_GT(tested, 40u);
  EXPECT_GE(most_holes, 5u);
}

}  // namespace
}  // namespace remesh
