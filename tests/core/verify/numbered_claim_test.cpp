#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/verify/cases.h"

namespace remesh {
namespace {

TEST(verify, a_vertex_moved_by_one_last_place_is_found) {
  Example e = cube();
  Vec3& p = e.positions[e.vertex_at({1, 1, 1}).value];
  p.x = std::nextafter(p.x, 2);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 3u);
}

TEST(verify, a_negative_zero_is_not_the_same_bits) {
  Example e = cube();
  e.positions[e.vertex_at({0, 0, 0}).value].x = -0.0;
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, a_vertex_that_is_not_finite_is_found) {
  Example e = cube();
  e.positions[0].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, two_output_vertices_at_one_place_are_a_crack) {
  Example e = cube();
  const std::size_t f = 0;
  e.positions.push_back(e.positions[e.faces[f][0].value]);
  e.faces[f][0] = VertexId(e.positions.size() - 1);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[f]));
}
}  // namespace
}  // namespace remesh
