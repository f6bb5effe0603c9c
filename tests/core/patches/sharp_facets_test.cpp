#include "core/patches/sharp_facets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

std::vector<int> sharp(const PolygonMesh& mesh, double max_angle_deg) {
  const StageChain chain(mesh);
  RunControl control;
  const auto found = find_sharp_facets(chain.surface, chain.adjacency, chain.patches, chain.loops, chain.essential,
                                       max_angle_deg, control);
  std::vector<int> result;
  for (std::uint32_t p = 0; p < found.size(); ++p) result.push_back(found[PatchId(p)]);
  return result;
}

/// A right-angled triangle whose smallest angle is given.
PolygonMesh right_triangle(double angle_deg) {
  return shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, std::tan(angle_deg * std::numbers::pi / 180), 0}}, {{0, 1, 2}});
}

TEST(sharp_facets, a_corner_below_the_bound_is_sharp) {
  EXPECT_EQ(sharp(right_triangle(24), 25), std::vector<int>{1});
  EXPECT_EQ(sharp(right_triangle(26), 25), std::vector<int>{0});
}

TEST(sharp_facets, corners_that_point_inwards_count_with_the_angle_inside) {
  // The notch in this square has an angle of 20 degrees outside of it, and so 340 degrees inside.
  const double half = std::tan(10 * std::numbers::pi / 180);
  const PolygonMesh notched = shapes::polygon({{0, 0}, {2, 0}, {2, 2}, {1 + half, 2}, {1, 1}, {1 - half, 2}, {0, 2}});
  EXPECT_EQ(sharp(notched, 25), std::vector<int>{0});
}

TEST(sharp_facets, vertices_inside_of_straight_sides_are_no_corners) {
  EXPECT_EQ(sharp(shapes::box({1, 2, 3}, 4), 60), std::vector<int>(6, 0));
}

TEST(sharp_facets, a_slit_is_not_sharp_but_its_corners_with_the_outline_may_be) {
  const PolygonMesh sheet =
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}},
                         {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}, {4, 5, 7, 6}});
  EXPECT_EQ(sharp(sheet, 60), (std::vector<int>{0, 0}));
}

}  // namespace
}  // namespace remesh
