#include "core/patches/planar/essential_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using Points = std::vector<Vec3>;

Points flat_points(const std::vector<Vec2>& points) {
  Points result;
  for (const Vec2 p : points) result.push_back({p.x, p.y, 0});
  std::sort(result.begin(), result.end());
  return result;
}

/// Expects that every loop vertex that was removed lies within the tolerance of the chord that replaces it, in order
/// along it. A loop has at least three essential vertices, if it has as many vertices at all. If all essential vertices
/// are said to be on loops, none lies inside a patch.
void expect_essential(const StageChain& chain) {
  for (std::uint32_t f = 0; f < chain.surface.face_count() && chain.essential.are_on_loops; ++f) {
    const PatchId p = chain.patches.of_face[FaceId(f)];
    std::set<VertexId> rim;
    for (std::uint32_t l = chain.loops.patch_begin[p.value]; l < chain.loops.patch_begin[p.value + 1]; ++l)
      for (const std::uint32_t h : chain.loops.loop(l)) rim.insert(chain.adjacency.from(h));
    for (const VertexId v : chain.surface.face(FaceId(f))) EXPECT_TRUE(!chain.essential[v] || rim.count(v) == 1) << v;
  }
  for (std::uint32_t l = 0; l + 1 < chain.loops.loop_begin.size(); ++l) {
    std::vector<VertexId> loop;
    for (const std::uint32_t h : chain.loops.loop(l)) loop.push_back(chain.adjacency.from(h));
    const auto first = std::find_if(loop.begin(), loop.end(), [&](VertexId v) { return chain.essential[v] != 0; });
    ASSERT_NE(first, loop.end());
    std::rotate(loop.begin(), first, loop.end());
    loop.push_back(loop.front());
    std::size_t count = 0;
    for (std::size_t i = 0; i + 1 < loop.size();) {
      ++count;
      std::size_t j = i + 1;
      while (!chain.essential[loop[j]]) ++j;
      const Vec3 a = chain.surface.local[loop[i]], b = chain.surface.local[loop[j]];
      double reached = 0;
      for (std::size_t k = i + 1; k < j; ++k) {
        const Vec3 ap = chain.surface.local[loop[k]] - a;
        const double along = dot(ap, b - a) / norm_squared(b - a);
        EXPECT_LE(norm(ap - along * (b - a)), chain.tolerance * (1 + 1e-9) + 1e-15);
        EXPECT_GT(along, reached);
        EXPECT_LT(along, 1);
        reached = along;
      }
      i = j;
    }
    const auto distinct = std::set<VertexId>(loop.begin(), loop.end()).size();
    EXPECT_GE(count, std::min<std::size_t>(3, distinct));
  }
}

TEST(essential_vertices, a_finely_cut_square_keeps_its_corners) {
  const StageChain chain(shapes::sheet(2, 1, 6, 4));
  EXPECT_EQ(chain.essential_places(), flat_points({{0, 0}, {2, 0}, {2, 1}, {0, 1}}));
  expect_essential(chain);
}

TEST(essential_vertices, a_finely_cut_ring_keeps_eight) {
  const StageChain chain(shapes::ring(4));
  EXPECT_EQ(chain.essential_places().size(), 8u);
  expect_essential(chain);
}

TEST(essential_vertices, a_collinear_vertex_is_kept_where_patches_meet) {
  // Two patches beside a third one: their common corner is in the middle of the third one's straight side.
  const PolygonMesh mesh = with_groups(shapes::sheet(2, 2, 2, 2), {0, 0, 1, 1, 2, 2, 2, 2});
  const StageChain chain(mesh);
  EXPECT_TRUE(chain.is_essential({1, 1, 0}));
  EXPECT_TRUE(chain.is_essential({1, 0, 0}));
  EXPECT_FALSE(chain.is_essential({1, 2, 0}));
  expect_essential(chain);
}

TEST(essential_vertices, a_vertex_inside_a_patch_goes) {
  const StageChain chain(shapes::noisy_sheet(4, 1));
  EXPECT_EQ(chain.essential_places(), flat_points({{0, 0}, {4, 0}, {4, 4}, {0, 4}}));
}

TEST(essential_vertices, the_ends_of_a_fin_inside_a_patch_stay) {
  const StageChain chain(
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}},
                         {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}, {4, 5, 7, 6}}));
  EXPECT_EQ(chain.essential_places().size(), 8u);
}

TEST(essential_vertices, what_touches_a_patch_inside_in_one_vertex_is_a_point_of_it) {
  // A pyramid standing on its tip, in the middle of a sheet.
  PolygonMesh mesh = shapes::joined(
      shapes::sheet(2, 2, 2, 2),
      shapes::from_lists({{1, 1, 0}, {0.5, 0.5, 1}, {1.5, 0.5, 1}, {1, 1.5, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}));
  const StageChain chain(mesh);
  EXPECT_TRUE(chain.is_essential({1, 1, 0}));
  EXPECT_FALSE(chain.essential.are_on_loops);
  expect_essential(chain);
}

TEST(essential_vertices, two_fans_pinched_at_a_vertex_keep_it) {
  // Two sheets with straight sides that touch in the middle of those sides.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {0, -1, 1}, {0, 1, -1}, {0, -1, 3}},
                         {{1, 0, 4}, {0, 3, 4}, {0, 2, 3}, {0, 5, 7}, {0, 7, 6}});
  const StageChain chain(mesh);
  EXPECT_TRUE(chain.is_essential({0, 0, 0}));
}

TEST(essential_vertices, a_round_boundary_without_a_corner_keeps_three_or_more) {
  for (const double tolerance : {1e-9, 1e-3, 0.05, 0.2}) {
    const StageChain chain(shapes::plate_with_round_hole(64), tolerance);
    expect_essential(chain);
    EXPECT_GE(chain.essential_places().size(), 4u + 3u) << tolerance;
    if (tolerance < 1e-6) {
      EXPECT_EQ(chain.essential_places().size(), 4u + 64u);
    }
    if (tolerance == 0.05) {
      EXPECT_LT(chain.essential_places().size(), 4u + 32u);
    }
  }
}

TEST(essential_vertices, a_closed_boundary_within_the_tolerance_of_a_line_stays_whole) {
  // A hole 1 long and 2e-4 wide: its two sides are one chord within the tolerance. The sheet around it is given in
  // triangles, because an outline that runs around the hole would be cut there as a spike.
  const StageChain chain(
      shapes::from_lists(
          {{-1, -1, 0}, {2, -1, 0}, {2, 1, 0}, {-1, 1, 0}, {0, 0, 0}, {0.5, 1e-4, 0}, {1, 0, 0}, {0.5, -1e-4, 0}},
          {{0, 1, 7}, {1, 6, 7}, {1, 2, 6}, {2, 5, 6}, {2, 3, 5}, {3, 4, 5}, {3, 0, 4}, {0, 7, 4}}),
      1e-3);
  EXPECT_EQ(chain.essential_places().size(), 8u);
}

TEST(essential_vertices, a_crack_thinner_than_the_tolerance_does_not_close) {
  // Open from corner to corner of an inner edge: two boundaries between the same two vertices.
  const StageChain chain(shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {1, 1e-5, 0}, {1, -1e-5, 0}, {1, 2, 0}, {1, -2, 0}},
                                            {{0, 2, 4}, {2, 1, 4}, {3, 0, 5}, {1, 3, 5}}),
                         1e-3);
  EXPECT_TRUE(chain.is_essential({1, 1e-5, 0}));
  EXPECT_TRUE(chain.is_essential({1, -1e-5, 0}));
}

TEST(essential_vertices, a_thin_patch_does_not_vanish) {
  // A sliver of another group between two sheets, 1e-5 wide, pointed at both ends.
  const PolygonMesh mesh =
      with_groups(shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {1, 1e-5, 0}, {1, -1e-5, 0}, {1, 2, 0}, {1, -2, 0}},
                                     {{0, 2, 4}, {2, 1, 4}, {3, 0, 5}, {1, 3, 5}, {0, 3, 2}, {3, 1, 2}}),
                  {0, 0, 1, 1, 2, 2});
  const StageChain chain(mesh, 1e-3);
  EXPECT_TRUE(chain.is_essential({1, 1e-5, 0}));
  EXPECT_TRUE(chain.is_essential({1, -1e-5, 0}));
}

TEST(essential_vertices, a_boundary_that_folds_back_keeps_its_vertices) {
  // Along x: 0, 2, 1, 3 within the tolerance of one line. It is given in triangles, because a polygon with this outline
  // would be cut there as one with a spike.
  const StageChain chain(shapes::from_lists({{0, 0, 0}, {2, 1e-5, 0}, {1, 2e-5, 0}, {3, 3e-5, 0}, {3, 2, 0}, {0, 2, 0}},
                                            {{0, 1, 2}, {2, 3, 4}, {2, 4, 5}, {2, 5, 0}}),
                         1e-3);
  EXPECT_TRUE(chain.is_essential({2, 1e-5, 0}));
  EXPECT_TRUE(chain.is_essential({1, 2e-5, 0}));
}

TEST(essential_vertices, small_steps_that_add_up_are_seen) {
  // An arc that leaves its chord by less than the tolerance from vertex to vertex, but by far more as a whole.
  std::vector<Vec2> points = {{100, 50}, {0, 50}};
  for (int i = 0; i <= 100; ++i) points.push_back({static_cast<double>(i), 1e-4 * i * (100 - i)});
  std::reverse(points.begin() + 2, points.end());
  std::reverse(points.begin(), points.end());
  const StageChain chain(shapes::polygon(points), 1e-3);
  expect_essential(chain);
  EXPECT_GT(chain.essential_places().size(), 10u);
  EXPECT_LT(chain.essential_places().size(), 60u);
}

TEST(essential_vertices, forced_vertices_stay) {
  const StageChain chain(shapes::sheet(2, 1, 4, 1), 1e-6, {{1, 0, 0}});
  EXPECT_TRUE(chain.is_essential({1, 0, 0}));
  EXPECT_EQ(chain.essential_places().size(), 5u);
}

TEST(essential_vertices, neighbours_agree_on_what_stays) {
  // One answer a vertex, whatever the patch: edges of a box cut unevenly.
  const StageChain chain(shapes::box({1, 2, 3}, 5));
  EXPECT_EQ(chain.essential_places().size(), 8u);
  expect_essential(chain);
}

TEST(essential_vertices, random_patches_with_noise_keep_what_is_promised) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    polygons::Loop loop = polygons::grown(seed, 25, 10).outer;
    polygons::Loop fine;  // every side cut, with noise of half the tolerance
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
      fine.push_back(a);
      for (int k = 1; k < 4; ++k) {
        const Vec2 p = a + (k / 4.0) * (b - a);
        fine.push_back({p.x + random.uniform(-5e-7, 5e-7), p.y + random.uniform(-5e-7, 5e-7)});
      }
    }
    const StageChain chain(shapes::polygon(fine), 1e-6);
    expect_essential(chain);
    EXPECT_LE(chain.essential_places().size(), loop.size()) << seed;
  }
}

}  // namespace
}  // namespace remesh
