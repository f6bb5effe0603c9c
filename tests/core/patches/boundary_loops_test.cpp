#include "core/patches/planar/boundary_loops.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/planes/projection.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Expects that every boundary half-edge of a patch is in exactly one loop of that patch, and that each loop is closed.
void expect_loops(const StageChain& chain) {
  const BoundaryLoops& loops = chain.loops;
  std::vector<int> uses(chain.surface.corners.size(), 0);
  ASSERT_EQ(loops.patch_begin.size(), chain.patches.count() + 1);
  ASSERT_EQ(loops.patch_begin.back() + 1, loops.loop_begin.size());
  ASSERT_EQ(loops.loop_begin.back(), loops.half_edges.size());
  for (std::uint32_t p = 0; p < chain.patches.count(); ++p) {
    std::uint32_t first_before = 0;
    for (std::uint32_t l = loops.patch_begin[p]; l < loops.patch_begin[p + 1]; ++l) {
      const auto loop = loops.loop(l);
      ASSERT_GE(loop.size(), 2u);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        ++uses[loop[i]];
        EXPECT_EQ(chain.adjacency.to(loop[i]), chain.adjacency.from(loop[(i + 1) % loop.size()]));
        EXPECT_EQ(chain.patches.of_face[chain.adjacency.face_of(loop[i])], PatchId(p));
      }
      EXPECT_EQ(loop[0], *std::min_element(loop.begin(), loop.end())) << "begins at its first half-edge";
      if (l > loops.patch_begin[p]) {
        EXPECT_GT(loop[0], first_before) << "loops in the order of their first half-edges";
      }
      first_before = loop[0];
    }
  }
  for (std::uint32_t h = 0; h < uses.size(); ++h)
    EXPECT_EQ(uses[h], is_patch_boundary(chain.adjacency, chain.patches, h) ? 1 : 0) << h;
}

/// Twice the signed area of each loop of patch 0 about +z, ascending.
std::vector<double> signed_areas(const StageChain& chain) {
  std::vector<double> areas;
  for (std::uint32_t l = 0; l < chain.loop_count(PatchId(0)); ++l) {
    areas.push_back(newell_normal(chain.loop_points(l)).z / 2);
  }
  std::sort(areas.begin(), areas.end());
  return areas;
}

TEST(boundary_loops, outer_loops_run_counter_clockwise_and_holes_clockwise) {
  for (const int cuts : {1, 4}) {
    const StageChain chain(shapes::ring(cuts));
    EXPECT_EQ(signed_areas(chain), (std::vector<double>{-36, 64}));
    expect_loops(chain);
  }
}

TEST(boundary_loops, a_closed_box_has_one_loop_a_side) {
  const StageChain chain(shapes::box({1, 1, 1}, 3));
  for (std::uint32_t p = 0; p < 6; ++p) EXPECT_EQ(chain.loop_count(PatchId(p)), 1u);
  expect_loops(chain);
}

TEST(boundary_loops, holes_that_touch_in_a_vertex_are_walked_as_the_surface_turns) {
  // Where the two empty cells touch, the patch's faces form two fans: around each of them one hole's edge is followed
  // by the other's.
  const StageChain chain(shapes::flat({"####", "#.##", "##.#", "####"}));
  EXPECT_EQ(signed_areas(chain), (std::vector<double>{-2, 16}));
  expect_loops(chain);
}

TEST(boundary_loops, a_notch_that_meets_the_border_in_a_vertex_makes_one_loop_that_touches_itself) {
  // The faces at the touching vertex are two fans; the patch hangs together round the hole.
  const StageChain chain(shapes::flat({"###", "#.#", "##."}));
  ASSERT_EQ(chain.patches.count(), 1u);
  EXPECT_EQ(signed_areas(chain), (std::vector<double>{7}));
  EXPECT_EQ(chain.loops.loop(0).size(), 16u);
  expect_loops(chain);
}

TEST(boundary_loops, a_slit_is_walked_on_both_sides) {
  // A sheet with a fin on an edge in its middle: that edge has three faces, so the sheet's patch ends on both sides.
  PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}},
                         {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}, {4, 5, 7, 6}});
  const StageChain chain(mesh);
  ASSERT_EQ(chain.patches.count(), 2u);
  EXPECT_EQ(signed_areas(chain), (std::vector<double>{0, 6}));
  EXPECT_EQ(chain.loop_count(chain.patch_of(0)), 2u);
  expect_loops(chain);
}

TEST(boundary_loops, a_bridge_polygon_has_its_hole_as_a_loop) {
  const StageChain chain(
      shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}}));
  EXPECT_EQ(signed_areas(chain), (std::vector<double>{-16, 64}));
  expect_loops(chain);
}

TEST(boundary_loops, an_island_in_a_hole_is_a_patch_of_its_own) {
  const StageChain chain(shapes::flat({"#####", "#...#", "#.#.#", "#...#", "#####"}));
  ASSERT_EQ(chain.patches.count(), 2u);
  EXPECT_EQ(chain.loop_count(chain.patch_of(0)), 2u);
  expect_loops(chain);
}

TEST(boundary_loops, random_drawings_keep_what_they_promise) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::vector<std::string> rows;
    unsigned state = seed * 7919u;
    for (int y = 0; y < 7; ++y) {
      std::string row;
      for (int x = 0; x < 7; ++x) {
        state = state * 1664525u + 1013904223u;
        row += (state >> 24) % 3 == 0 ? '.' : '#';
      }
      rows.push_back(row);
    }
    const StageChain chain(shapes::flat({rows.begin(), rows.end()}));
    expect_loops(chain);
    double enclosed = 0;
    for (std::uint32_t l = 0; l + 1 < chain.loops.loop_begin.size(); ++l)
      enclosed += newell_normal(chain.loop_points(l)).z / 2;
    EXPECT_DOUBLE_EQ(enclosed, static_cast<double>(chain.surface.face_count()) / 2) << "the patches' area";
  }
}

}  // namespace
}  // namespace remesh
