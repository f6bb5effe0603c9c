#include "core/geometry/planes/projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

std::vector<Edge3> edges_of(const std::vector<Vec3>& loop) {
  std::vector<Edge3> edges;
  for (std::size_t i = 0; i < loop.size(); ++i) edges.push_back({loop[i], loop[(i + 1) % loop.size()]});
  return edges;
}

Frame frame_of(const std::vector<Vec3>& loop, ReferenceAxis axis = ReferenceAxis::kDominantEdge,
               const Vec3& direction = {}, double grid = kPatchGrid) {
  return make_frame(normalized(newell_normal(loop)), loop[0], loop, edges_of(loop), axis, direction, grid);
}

void expect_near(const Vec3& a, const Vec3& b, double error = 1e-15) {
  EXPECT_NEAR(a.x, b.x, error);
  EXPECT_NEAR(a.y, b.y, error);
  EXPECT_NEAR(a.z, b.z, error);
}

const std::vector<Vec3> kRectangle = {{0, 0, 0}, {1, 0, 0}, {1, 3, 0}, {0, 3, 0}};

TEST(make_frame, the_longest_edge_gives_the_axis_away_from_its_smaller_end) {
  const Frame frame = frame_of(kRectangle);
  expect_near(frame.x_axis, {0, 1, 0});
  expect_near(frame.y_axis, {-1, 0, 0});
  expect_near(frame.normal, {0, 0, 1});
}

TEST(make_frame, of_equally_long_edges_the_one_with_the_smallest_end_counts_wherever_the_loop_begins) {
  std::vector<Vec3> loop = {{5, 0, 0}, {9, 3, 0}, {6, 7, 0}, {2, 4, 0}};  // a square of side 5
  std::set<Vec3> axes;
  for (int i = 0; i < 4; ++i) {
    std::rotate(loop.begin(), loop.begin() + 1, loop.end());
    axes.insert(
        make_frame({0, 0, 1}, {2, 4, 0}, loop, edges_of(loop), ReferenceAxis::kDominantEdge, {}, kPatchGrid).x_axis);
  }
  EXPECT_EQ(axes.size(), 1u);
  expect_near(*axes.begin(), {0.6, -0.8, 0});  // from (2,4) to (5,0), the smaller of the two that begin there
}

TEST(make_frame, the_given_axis_is_projected_into_the_plane) {
  expect_near(frame_of(kRectangle, ReferenceAxis::kX).x_axis, {1, 0, 0});
  expect_near(frame_of(kRectangle, ReferenceAxis::kGiven, {-2, 0, 7}).x_axis, {-1, 0, 0});
  expect_near(frame_of(kRectangle, ReferenceAxis::kGiven, {1e-200, 1e-200, 0}).x_axis,
              {std::sqrt(0.5), std::sqrt(0.5), 0});
}

TEST(make_frame, an_axis_along_the_normal_gives_way_to_the_next) {
  expect_near(frame_of(kRectangle, ReferenceAxis::kGiven, {0, 0, 1}).x_axis, {1, 0, 0});
  const std::vector<Vec3> across_x = {{0, 0, 0}, {0, 2, 0}, {0, 2, 1}, {0, 0, 1}};
  expect_near(frame_of(across_x, ReferenceAxis::kX).x_axis, {0, 1, 0});
}

TEST(make_frame, axes_are_orthonormal_and_right_handed_and_all_points_lie_within_the_unit_square) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const double scale = std::pow(10, random.uniform(-6, 6));
    const polygons::Placement place = polygons::random_placement(seed, scale);
    std::vector<Vec3> loop;
    for (const Vec2 p : polygons::star_with_holes(seed, 20, 1).outer) loop.push_back(place(p));
    for (const ReferenceAxis axis : {ReferenceAxis::kX, ReferenceAxis::kDominantEdge, ReferenceAxis::kGiven}) {
      const Frame frame = frame_of(loop, axis, {0.3, -0.2, 0.1});
      EXPECT_NEAR(norm(frame.x_axis), 1, 1e-15);
      EXPECT_NEAR(norm(frame.y_axis), 1, 1e-15);
      EXPECT_NEAR(dot(frame.x_axis, frame.normal), 0, 1e-15);
      EXPECT_NEAR(dot(frame.y_axis, frame.normal), 0, 1e-15);
      EXPECT_NEAR(dot(cross(frame.x_axis, frame.y_axis), frame.normal), 1, 1e-14);
      int exponent = 0;
      EXPECT_EQ(std::frexp(frame.scale, &exponent), 0.5);
      for (const Vec3& p : loop) {
        const Vec2 uv = to_plane(frame, p);
        EXPECT_LE(std::max(std::fabs(uv.x), std::fabs(uv.y)), 1);
        EXPECT_EQ(std::nearbyint(uv.x / frame.grid) * frame.grid, uv.x);
        // The way back leads to p again, within the rounding of the coordinates and of the grid.
        const Vec3 back = frame.origin + frame.scale * (uv.x * frame.x_axis + uv.y * frame.y_axis);
        EXPECT_LT(norm(back - p), frame.scale * 0x1p-39 + 1e-14 * norm(p));
      }
    }
  }
}

STAGE(make_frame, test::kScale) {
  const polygons::Placement place = polygons::random_placement(3, 1);
  std::vector<Vec3> loop;
  for (const Vec2 p : polygons::star_with_holes(3, 20, 1).outer) loop.push_back(place(p));
  // The normal is the caller's: unit, so the same.
  const Vec3 normal = normalized(newell_normal(loop));
  for (Vec3& p : loop) p = trial.scale * p;
  const Frame frame = make_frame(normal, loop[0], loop, edges_of(loop), ReferenceAxis::kDominantEdge, {}, kPatchGrid);
  trial.same(frame.x_axis, frame.y_axis, trial.length(frame.scale), trial.length(frame.origin));
  for (const Vec3& p : loop) trial.same(to_plane(frame, p));
}

TEST(to_plane, a_turned_rectangle_is_a_rectangle_again) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const polygons::Placement place = polygons::random_placement(seed, 1);
    const std::vector<Vec3> loop = {place({0, 0}), place({3, 0}), place({3, 2}), place({0, 2})};
    const Frame frame = frame_of(loop);
    std::set<double> xs, ys;
    for (const Vec3& p : loop) {
      xs.insert(to_plane(frame, p).x);
      ys.insert(to_plane(frame, p).y);
    }
    EXPECT_EQ(xs.size(), 2u) << seed;
    EXPECT_EQ(ys.size(), 2u) << seed;
  }
}

TEST(newell_normal, it_is_twice_the_area_along_the_normal) {
  expect_near(newell_normal(kRectangle), {0, 0, 6});
  const std::vector<Vec3> l = {{1, 1, 5}, {1, 2, 5}, {0, 2, 5}, {0, 0, 5}, {2, 0, 5}, {2, 1, 5}};
  expect_near(newell_normal(l), {0, 0, 6});
}

}  // namespace
}  // namespace remesh
