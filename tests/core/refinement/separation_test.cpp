#include "core/refinement/separation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/remesh.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

TEST(separate_new_vertices, sheets_that_lie_in_one_another_are_refined_and_share_no_new_vertex) {
  // Three squares, of which the first and the last look the same way.
  const std::vector<Vec3> square{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}};
  std::vector<Vec3> points;
  for (int sheet = 0; sheet < 3; ++sheet)
    for (const Vec3& p : square) points.push_back(p + Vec3{1e6, 2e6, 3e6});
  const PolygonMesh sheets = shapes::from_lists(points, {{0, 1, 2, 3}, {7, 6, 5, 4}, {8, 9, 10, 11}});
  Options options;
  options.max_edge_length = 0.25;
  options.repair.duplicates = false;
  RunControl control;
  const Result result = remesh_surface(sheets, options, {}, control);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.unrefined.empty()) << "nothing stands in the way";
  std::vector<Vec3> positions = result.mesh.positions.items();
  EXPECT_GT(positions.size(), 300u);
  std::sort(positions.begin(), positions.end());
  EXPECT_EQ(std::adjacent_find(positions.begin(), positions.end()), positions.end());
  for (const Vec3& p : positions) EXPECT_NEAR(p.z, 3e6, 1e-9);
}

}  // namespace
}  // namespace remesh
