// Tests circles, and what holds for all curves.

#include "core/patches/chains/curve_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "tests/support/cut_parts.h"
#include "tests/support/invariance.h"
#include "tests/support/primitives.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using namespace cut_parts;

TEST(curve_cuts, the_rims_of_a_cylinder_get_as_many_equal_pieces_as_were_asked_for) {
  for (const int n : {3, 4, 7, 12, 16, 25, 36, 71, 73, 100, 250}) {
    const Asked asked = elements(n, kRadius, height(kRadius, 72));
    const CutPart part(barrel(), asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    EXPECT_EQ(part.cuts.cut_chains, 2u);
    EXPECT_EQ(part.cuts.capped, 0u);
    for (const std::uint32_t patch : {kTop, kBottom}) {
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
      expect_equal_edges(points, chord(kRadius, n), 1e-12);
      for (const Vec3& p : points) {
        EXPECT_EQ(p.z, patch == kTop ? kHeight : 0);
        EXPECT_NEAR(std::hypot(p.x, p.y), kRadius, 4 * 0x1p-49);  // 2^-49 is a step of numbers from 8 to 16
      }
    }
  }
}

TEST(curve_cuts, pieces_are_no_deeper_below_their_surfaces_than_is_allowed) {
  // A chord of a circle of a cone is below the surface by the cosine of the half angle of its height.
  const double lower = 4, upper = 1, along = 7, cosine = std::cos(std::atan2(lower - upper, along));
  const Part part = part_of(primitives::frustum(72, lower, upper, along));
  for (const double depth : {0.3, 0.1, 0.03, 0.01}) {
    const CutPart cut(part, {lower, kPi, depth, HUGE_VAL});
    std::multiset<std::size_t> rims, expected;
    for (const double radius : {lower, upper}) {
      std::size_t pieces = 6;
      while (height(radius, static_cast<double>(pieces)) * cosine > depth) ++pieces;
      expected.insert(pieces);
    }
    for (std::uint32_t p = 0; p < part.shapes.size(); ++p)
      if (part.shapes[p].kind == SurfaceKind::kPlane) rims.insert(cut.points(cut.first_loop(p)).size());
    EXPECT_EQ(rims, expected) << depth;
  }
}

TEST(curve_cuts, rims_of_a_narrow_patch_have_pieces_that_are_as_short_as_its_width_asks_for) {
  for (const double width : {4.0, 12.0, 30.0}) {
    const Part part = part_of(primitives::cylinder(72, kRadius, width));
    for (const double ratio : {0.5, 1.0, 2.0}) {
      Asked asked = elements(8, kRadius, height(kRadius, 72));
      asked.max_length_per_width = ratio;
      const CutPart cut(part, asked);
      // The input's circle is a polygon, too.
      const double circle = 72 * chord(kRadius, 72);
      const double expected = std::clamp(std::ceil(circle / (ratio * width) * (1 - 1e-9)), 8.0, 72.0);
      for (const std::uint32_t patch : {kTop, kBottom})
        EXPECT_EQ(cut.points(cut.first_loop(patch)).size(), static_cast<std::size_t>(expected))
            << width << " " << ratio;
    }
  }
}

TEST(curve_cuts, as_many_pieces_as_there_are_keep_the_vertices_of_the_input) {
  const CutPart part(barrel(), elements(72, kRadius, height(kRadius, 72)));
  EXPECT_TRUE(part.cuts.positions.empty());
  EXPECT_EQ(part.cuts.cut_chains, 0u);
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
}

TEST(curve_cuts, what_asks_for_no_other_pieces_leaves_the_input) {
  // The default: edges may turn by what the input's facets turn, and move by their height.
  const CutPart part(barrel(), {height(kRadius, 72), 2 * kPi / 72 * (1 - 1e-12)});
  EXPECT_EQ(part.cuts.essential.stays, part.essential.stays);
  EXPECT_TRUE(part.cuts.positions.empty());
}

TEST(curve_cuts, a_division_of_the_number_of_facets_takes_vertices_of_the_input) {
  const CutPart part(barrel(), elements(12, kRadius, height(kRadius, 72)));
  EXPECT_TRUE(part.cuts.positions.empty());
  EXPECT_EQ(part.essential_places().size(), 24u);
}

TEST(curve_cuts, a_tolerance_alone_gives_the_fewest_pieces_within_it_and_never_fewer_than_six_a_circle) {
  std::size_t before = 72;
  for (const double tolerance : {0.012, 0.03, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 100.0}) {
    const CutPart part(barrel(), {tolerance, kPi});
    int fewest = 6;
    while (height(kRadius, fewest) > tolerance) ++fewest;
    const std::size_t count = part.points(part.first_loop(kTop)).size();
    EXPECT_EQ(count, static_cast<std::size_t>(fewest)) << tolerance;
    EXPECT_LE(count, before);
    before = count;
    expect_near(part, tolerance);
  }
}

TEST(curve_cuts, a_tolerance_below_the_height_of_the_inputs_pieces_leaves_them) {
  for (const int n : {12, 100}) {
    const CutPart part(barrel(), {0.9 * height(kRadius, 72), 2 * kPi / n});
    EXPECT_EQ(part.cuts.essential.stays, part.essential.stays) << n;
    EXPECT_TRUE(part.cuts.positions.empty()) << n;
  }
}

TEST(curve_cuts, without_a_curved_patch_everything_stays) {
  Part part = barrel();
  part.mesh = shapes::cylinder(12, 1, 1);
  std::vector<std::uint32_t> groups;
  for (std::uint32_t f = 0; f < part.mesh.face_count(); ++f) groups.push_back(f);
  part.mesh = with_groups(part.mesh, groups);
  part.shapes.assign(groups.size(), {SurfaceKind::kPlane, {}, {}, 0, 0, 0});
  const CutPart cut(part, {1, 1});
  EXPECT_EQ(cut.cuts.essential.stays, cut.essential.stays);
  EXPECT_TRUE(cut.cuts.positions.empty());
}

TEST(curve_cuts, half_cylinders_share_the_pieces_of_a_rim) {
  const Part halves = with_halves(barrel(), kSide, [](const Vec3& p) { return p.y < 0; });
  for (const int n : {4, 6, 8, 12, 16, 100}) {
    const Asked asked = elements(n, kRadius, height(kRadius, 72));
    const CutPart part(halves, asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    EXPECT_EQ(part.cuts.cut_chains, 4u);
    EXPECT_EQ(part.cuts.capped, 0u);
    const std::vector<Vec3> points = part.points(part.first_loop(kTop));
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(kRadius, n), 1e-12);
    // The corners of the seam stay.
    for (const Vec3& corner : {Vec3{kRadius, 0, 0}, Vec3{kRadius, 0, kHeight}})
      EXPECT_TRUE(part.cuts.essential[part.at(corner)]);
    EXPECT_EQ(part.points(part.first_loop(kSide)).size(), static_cast<std::size_t>(n + 2));
  }
}

TEST(curve_cuts, turned_and_moved_rims_have_the_same_counts_and_stay_on_circle_and_plane) {
  const Vec3 by{1000, -300, 50};
  for (const double degrees : {17.0, 93.0, 201.0})
    for (const int n : {7, 12, 16, 100}) {
      const Part input = turned(barrel(), {1, 2, 3}, degrees, by);
      const CutPart part(input, elements(n, kRadius, height(kRadius, 72)), {}, 1e-11 * 1000);
      SCOPED_TRACE(n);
      expect_conforming(part);
      const double step = part.largest_coordinate() * 0x1p-52;
      for (const std::uint32_t patch : {kTop, kBottom}) {
        const std::vector<Vec3> points = part.points(part.first_loop(patch));
        ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
        const AnalyticSurface& side = input.shapes[kSide];
        for (const Vec3& p : points) {
          EXPECT_NEAR(norm(cross(p - side.origin, side.axis)), kRadius, 4 * step);
          EXPECT_NEAR(dot(p - side.origin, side.axis), patch == kTop ? kHeight : 0, 4 * step);
        }
      }
    }
}

TEST(curve_cuts, both_rims_of_a_frustum_are_cut) {
  const double lower = 10, upper = 4;
  for (const int n : {12, 16}) {
    const Asked asked = elements(n, lower, height(lower, 72));
    const CutPart part(part_of(primitives::frustum(72, lower, upper, 9)), asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    expect_equal_edges(part.points(part.first_loop(1)), chord(upper, n), 1e-12);
    expect_equal_edges(part.points(part.first_loop(2)), chord(lower, n), 1e-12);
    EXPECT_EQ(part.points(part.first_loop(1)).size(), static_cast<std::size_t>(n));
    EXPECT_EQ(part.points(part.first_loop(2)).size(), static_cast<std::size_t>(n));
  }
}

TEST(curve_cuts, an_open_sheet_has_corners_where_its_border_bends) {
  // Two arcs of 50 degrees and two rulings, all beside the same patch.
  const CutPart part(part_of(primitives::arc(72, 10, kRadius, kHeight)), elements(36, kRadius, height(kRadius, 72)));
  const std::vector<Vec3> points = part.points(0);
  EXPECT_EQ(points.size(), 12u);  // 50 degrees are five pieces of 10
  std::vector<double> sides = lengths(points);
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(sides[i], chord(kRadius, 36), 1e-12);
  EXPECT_NEAR(sides[10], kHeight, 1e-12);
}

TEST(curve_cuts, a_chain_with_a_forced_vertex_stays_as_it_is) {
  const Part input = barrel();
  const auto& bottom = input.mesh.positions;
  const auto on_bottom = std::find_if(bottom.begin(), bottom.end(), [](const Vec3& p) { return p.z == 0; });
  const CutPart part(input, elements(12, kRadius, height(kRadius, 72)), {*on_bottom});
  expect_conforming(part);
  EXPECT_EQ(part.points(part.first_loop(kBottom)).size(), 72u);
  EXPECT_EQ(part.points(part.first_loop(kTop)).size(), 12u);
}

TEST(curve_cuts, uneven_pieces_are_cut_evenly) {
  // A cylinder whose facets are 5 and 10 degrees wide by turns: 48 facets.
  std::vector<Vec2> base;
  for (int i = 0; i < 24; ++i)
    for (const double degrees : {15.0 * i, 15.0 * i + 5})
      base.push_back({6 * std::cos(degrees * kPi / 180), 6 * std::sin(degrees * kPi / 180)});
  const PolygonMesh mesh = shapes::prism(base, 4);
  std::vector<std::uint32_t> groups;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    groups.push_back(mesh.face(FaceId(f)).size() == 4 ? 0 : mesh.positions[mesh.face(FaceId(f))[0]].z == 0 ? 1 : 2);
  const AnalyticSurface plane{SurfaceKind::kPlane, {}, {}, 0, 0, 0};
  const Part input{with_groups(mesh, groups), {{SurfaceKind::kCylinder, {}, {0, 0, 1}, 6, 0, 0}, plane, plane}};
  for (const int n : {36, 48}) {
    const Asked asked{height(6, n) + height(6, 36), 2 * kPi / n};
    const CutPart part(input, asked);
    SCOPED_TRACE(n);
    expect_conforming(part);
    expect_near(part, asked.tolerance);
    const std::vector<Vec3> points = part.points(part.first_loop(1));
    ASSERT_EQ(points.size(), static_cast<std::size_t>(n));
    expect_equal_edges(points, chord(6, n), 1e-12);
  }
}

std::vector<Part> samples() {
  return {barrel(),
          with_halves(barrel(), kSide, [](const Vec3& p) { return p.y < 0; }),
          part_of(primitives::frustum(48, 10, 4, 9)),
          cut_off(60, 0.7, 0.2),
          cut_off(50, 1.2, 0),
          part_of(primitives::tee(48)),
          part_of(primitives::tube(90, kRadius, 1, 5)),
          with_halves(part_of(primitives::globe(40, 20, 3)), 0, [](const Vec3& p) { return p.z < 0; }),
          segment_of_disc(9, 70),
          part_of(primitives::arc(72, 10, kRadius, kHeight))};
}

STAGE(curve_cuts, test::kScale, test::kNumbering) {
  for (const Part& sample : samples())
    for (const int n : {7, 16}) {
      Part input = scaled(sample, trial.scale);
      if (trial.seed != 0) input.mesh = shapes::renumbered(input.mesh, trial.seed);
      const CutPart part(input, {2 * trial.scale, 2 * kPi / n});
      EXPECT_GT(part.cuts.cut_chains, 0u);
      trial.same(part.cuts.capped, part.cuts.cut_chains);
      for (const Vec3& p : part.essential_places()) trial.same(trial.length(p));
      for (const Vec3& p : part.cuts.positions) trial.same(trial.length(p));
    }
}

STAGE(curve_cuts_alone, test::kStop) {
  const CutPart part(barrel(), {2, 1});
  cut_curves({part.surface, part.adjacency, part.patches, part.loops, part.essential, part.forced, part.pinched},
             part.surfaces, part.rules, trial.control);
}

TEST(curve_cuts, turned_parts_have_the_same_counts) {
  for (const Part& input : samples())
    for (const int n : {7, 16, 25}) {
      const CutPart part(input, {2, 2 * kPi / n});
      const CutPart other(turned(input, {3, -1, 2}, 77, {5, -8, 3}), {2, 2 * kPi / n});
      std::multiset<std::size_t> counts, other_counts;
      for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
        counts.insert(part.points(l).size());
        other_counts.insert(other.points(l).size());
      }
      EXPECT_EQ(other_counts, counts);
    }
}

TEST(curve_cuts, rounded_coordinates_of_floats_are_seen_through) {
  for (const int n : {12, 16, 100}) {
    Part input = turned(barrel(), {1, 2, 3}, 40, {});
    for (Vec3& p : input.mesh.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
    const double step = 0x1p-19;  // of floats from 16 to 32
    const CutPart part(input, elements(n, kRadius, height(kRadius, 72)), {}, 10 * step);
    EXPECT_EQ(part.points(part.first_loop(kTop)).size(), static_cast<std::size_t>(n));
    EXPECT_EQ(part.points(part.first_loop(kBottom)).size(), static_cast<std::size_t>(n));
    for (const Vec3& p : part.cuts.positions)
      EXPECT_NEAR(norm(cross(p - input.shapes[kSide].origin, input.shapes[kSide].axis)), kRadius, 4 * 0x1p-48);
  }
}

}  // namespace
}  // namespace remesh
