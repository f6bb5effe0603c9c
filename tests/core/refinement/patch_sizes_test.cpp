#include "core/refinement/refiner/patch_sizes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/patch_subject.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// The sizes of a square of 8 by 8 model units.
struct Square {
  explicit Square(const Options& options)
      : subject(shapes::sheet(8, 8, 1, 1), options), sizes(subject.patch(), subject.criteria, subject.chain.control) {}

  /// Returns a length of model units in the plane.
  double in_plane(double length) const { return length / subject.chart().scale({}); }
  Vec2 at(double x, double y) const { return subject.chart().to_plane({x, y, 0}); }
  Vec2 middle() const { return at(4, 4); }

  PatchSubject subject;
  PatchSizes sizes;
};

TEST(patch_sizes, without_a_goal_for_sizes_any_triangle_is_small_enough) {
  Options options;
  options.min_angle_deg = 30;
  const Square square(options);
  EXPECT_FALSE(square.subject.criteria.has_sizes());
  EXPECT_FALSE(square.sizes.do_vary());
  EXPECT_FALSE(square.sizes.has_fixed_sides());
  EXPECT_FALSE(square.sizes.is_area_bounded());
  EXPECT_FALSE(square.sizes.is_too_long(square.at(0, 0), square.at(8, 8)));
  EXPECT_FALSE(square.sizes.is_too_large_anywhere(square.at(0, 0), {6, 1, 2, 2}));
  EXPECT_EQ(square.sizes.for_new_triangle(square.at(0, 0), square.middle()), HUGE_VAL);
}

TEST(patch_sizes, a_largest_edge_counts_everywhere_alike) {
  Options options;
  options.max_edge_length = 2;
  const Square square(options);
  EXPECT_FALSE(square.sizes.do_vary());
  EXPECT_FALSE(square.sizes.is_too_long(square.at(1, 1), square.at(3, 1)));
  EXPECT_TRUE(square.sizes.is_too_long(square.at(1, 1), square.at(3.1, 1)));
  const auto is_too_large = [&](Vec2 a, Vec2 b, Vec2 c) {
    return square.sizes.is_too_large(a, b, c, measure_spanned(a, b, c));
  };
  EXPECT_FALSE(is_too_large(square.at(0, 0), square.at(1, 0), square.at(0, 1)));
  EXPECT_TRUE(is_too_large(square.at(0, 0), square.at(2, 0), square.at(0, 2)));
  EXPECT_EQ(square.sizes.for_new_triangle(square.at(0, 0), square.middle()), square.in_plane(2));
  EXPECT_TRUE(square.sizes.allows_when_thinned(square.in_plane(2), square.middle()));
  EXPECT_FALSE(square.sizes.allows_when_thinned(square.in_plane(2.01), square.middle()));
  const PlaneSizes lattices = square.sizes.of_lattices();
  EXPECT_TRUE(lattices.is_uniform);
  EXPECT_EQ(lattices.at(square.middle()), square.in_plane(2));
}

TEST(patch_sizes, a_largest_area_bounds_areas_and_not_edges) {
  Options options;
  options.max_area = 2;
  const Square square(options);
  EXPECT_TRUE(square.sizes.is_area_bounded());
  const auto is_too_large = [&](Vec2 a, Vec2 b, Vec2 c) {
    return square.sizes.is_too_large(a, b, c, measure_spanned(a, b, c));
  };
  EXPECT_FALSE(is_too_large(square.at(0, 0), square.at(8, 0), square.at(0, 0.5)));
  EXPECT_TRUE(is_too_large(square.at(0, 0), square.at(2.1, 0), square.at(0, 2)));
}

TEST(patch_sizes, beside_sides_that_stay_larger_triangles_are_allowed) {
  Options options;
  options.max_edge_length = 0.5;
  options.split_boundaries = false;
  const Square square(options);
  ASSERT_TRUE(square.sizes.has_fixed_sides());
  EXPECT_EQ(square.sizes.why_fixed(), UnrefinedReason::kBoundaryLocked);
  EXPECT_TRUE(square.sizes.do_vary());
  EXPECT_FALSE(square.sizes.is_area_bounded());
  EXPECT_TRUE(square.sizes.allows(square.in_plane(7.9), square.at(4, 0)));
  EXPECT_FALSE(square.sizes.allows(square.in_plane(0.51), square.middle()));
  EXPECT_TRUE(square.sizes.allows(square.in_plane(0.5), square.middle()));
  EXPECT_GT(square.sizes.for_new_triangle(square.at(0, 0), square.at(4, 0.5)),
            square.sizes.for_new_triangle(square.at(0, 0), square.at(4, 1)));
  const PlaneSizes lattices = square.sizes.of_lattices();
  EXPECT_FALSE(lattices.is_uniform);
  EXPECT_EQ(lattices.at(square.middle()), square.in_plane(0.5));
  // A triangle is never larger than any may be, but its size is still compared with what was asked for.
  const TriangleMeasures measures = measure_spanned(square.at(0, 0), square.at(8, 0), square.at(0, 8));
  EXPECT_FALSE(square.sizes.is_too_large_anywhere(square.at(0, 0), measures));
  EXPECT_TRUE(square.sizes.is_larger_than_asked(square.at(0, 0), measures));
}

TEST(patch_sizes, sides_that_may_be_cut_are_not_fixed) {
  Options options;
  options.max_edge_length = 0.5;
  EXPECT_FALSE(Square(options).sizes.has_fixed_sides());
  options.max_edge_length = 20;
  options.split_boundaries = false;
  EXPECT_FALSE(Square(options).sizes.has_fixed_sides()) << "the sides are short enough";
}

}  // namespace
}  // namespace remesh
