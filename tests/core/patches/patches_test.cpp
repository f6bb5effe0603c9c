#include "core/patches/planar/patches.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Patches where every face has been put into the same region.
PatchSet patches_of_one_region(const StageChain& chain) {
  Regions regions;
  regions.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  regions.deviation.push_back(0);
  regions.of_face.assign(chain.surface.face_count(), RegionId(0));
  return patches(chain.surface, chain.adjacency, regions, chain.control);
}

void expect_holds(const PatchSet& set, std::size_t faces) {
  ASSERT_EQ(set.of_face.size(), faces);
  ASSERT_EQ(set.face_begin.size(), set.count() + 1);
  ASSERT_EQ(set.faces.size(), faces);
  std::uint32_t first_before = 0;
  for (std::uint32_t p = 0; p < set.count(); ++p) {
    const auto list = set.faces_of(PatchId(p));
    ASSERT_FALSE(list.empty());
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
    for (const FaceId f : list) EXPECT_EQ(set.of_face[f], PatchId(p));
    if (p > 0) {
      EXPECT_GT(list[0].value, first_before) << "numbered by the first face";
    }
    first_before = list[0].value;
  }
}

TEST(patches, coplanar_faces_that_touch_in_a_vertex_only_are_two) {
  const StageChain chain(shapes::two_squares_touching_at_a_vertex(2));
  const PatchSet set = patches_of_one_region(chain);
  EXPECT_EQ(set.count(), 2u);
  expect_holds(set, chain.surface.face_count());
}

TEST(patches, a_sheet_is_one) {
  const StageChain chain(shapes::sheet(3, 2, 30, 20));
  const PatchSet set = patches_of_one_region(chain);
  EXPECT_EQ(set.count(), 1u);
  expect_holds(set, chain.surface.face_count());
}

TEST(patches, an_edge_of_three_faces_connects_nothing) {
  const StageChain chain(shapes::three_pages(2));
  const PatchSet set = patches_of_one_region(chain);
  EXPECT_EQ(set.count(), 3u);
  expect_holds(set, chain.surface.face_count());
}

TEST(patches, neighbours_that_run_the_same_way_are_not_connected) {
  const StageChain chain(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(patches_of_one_region(chain).count(), 2u);
}

TEST(patches, each_piece_carries_the_plane_of_its_region) {
  const StageChain chain(shapes::box({1, 2, 3}, 2));
  EXPECT_EQ(chain.patches.count(), 6u);
  expect_holds(chain.patches, chain.surface.face_count());
  for (std::uint32_t p = 0; p < 6; ++p)
    for (const FaceId f : chain.patches.faces_of(PatchId(p)))
      EXPECT_GT(dot(chain.patches.planes[PatchId(p)].normal, chain.geometry[f].normal), 0.999);
}

TEST(is_patch_boundary, the_border_and_edges_between_patches_are_edges_inside_are_not) {
  const StageChain chain(with_groups(shapes::sheet(2, 1, 2, 1), {0, 0, 1, 1}));
  int boundary = 0, inside = 0;
  for (std::uint32_t h = 0; h < chain.surface.corners.size(); ++h)
    ++(is_patch_boundary(chain.adjacency, chain.patches, h) ? boundary : inside);
  EXPECT_EQ(boundary, 8);
  EXPECT_EQ(inside, 4);
}

}  // namespace
}  // namespace remesh
