#include "core/geometry/triangles/overlap.h"

#include <gtest/gtest.h>

namespace remesh {
namespace {

const Triangle kFirst{VertexId(0), VertexId(1), VertexId(2)}, kSecond{VertexId(3), VertexId(4), VertexId(5)};

bool overlaps(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double tolerance = 0) {
  const std::vector<Vec3> p{a[0], a[1], a[2], b[0], b[1], b[2]};
  const bool result = do_overlap(kFirst, kSecond, p, tolerance);
  EXPECT_EQ(do_overlap(kSecond, kFirst, p, tolerance), result);
  return result;
}

TEST(do_overlap, triangles_in_a_plane_do_if_they_have_area_in_common) {
  const std::array<Vec3, 3> t{Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 2, 0}};
  EXPECT_TRUE(overlaps(t, t));
  EXPECT_TRUE(overlaps(t, {t[0], t[2], t[1]}));
  EXPECT_TRUE(overlaps(t, {Vec3{1, -1, 0}, Vec3{1, 3, 0}, Vec3{0.5, 1, 0}}));
  EXPECT_FALSE(overlaps(t, {Vec3{1, 0, 0}, Vec3{3, 0, 0}, Vec3{2, -1, 0}}));  // along a part of an edge
  EXPECT_FALSE(overlaps(t, {Vec3{1, 1, 0}, Vec3{3, 1, 0}, Vec3{1, 3, 0}}));
}

TEST(do_overlap, what_crosses_or_lies_above_does_not_but_within_the_tolerance) {
  const std::array<Vec3, 3> t{Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 2, 0}};
  EXPECT_FALSE(overlaps(t, {Vec3{0.5, 0.5, -1}, Vec3{0.6, 0.5, 1}, Vec3{0.5, 0.6, 1}}));
  const std::array<Vec3, 3> tilted{Vec3{0, 0, -0.001}, Vec3{2, 0, 0.001}, Vec3{0, 2, 0.001}};
  EXPECT_FALSE(overlaps(t, tilted));
  EXPECT_TRUE(overlaps(t, tilted, 0.01));
}

TEST(meeting_place, it_is_in_both_boxes) {
  const std::vector<Vec3> p{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {2, 1, 1}, {1, 2, 1}};
  EXPECT_EQ(meeting_place(kFirst, kSecond, p), (Vec3{1.5, 1.5, 0}));
}

}  // namespace
}  // namespace remesh
