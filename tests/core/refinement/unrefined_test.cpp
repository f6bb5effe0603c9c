#include "core/refinement/goals/unrefined.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace remesh {
namespace {

Goals no_goals() {
  Options options;
  options.refine = false;
  return goals_of(options, 1);
}

/// Returns whether one triangle is found. It does not matter for which reason.
bool is_found(const Vec3& a, const Vec3& b, const Vec3& c, const Goals& goals) {
  const std::vector<Vec3> positions{a, b, c};
  const std::vector<Triangle> faces{{VertexId(0), VertexId(1), VertexId(2)}};
  const std::vector<UnrefinedReason> reasons{UnrefinedReason::kBudget};
  RunControl control;
  return !find_unrefined(positions, faces, reasons, {}, goals, control).faces.empty();
}

/// Returns whether a triangle is found that has this angle at the origin, and two equal angles.
bool is_angle_found(double degrees, double bound, double scale = 1) {
  const double angle = degrees * std::numbers::pi / 180;
  Goals goals = no_goals();
  goals.min_angle_deg = bound;
  const Vec3 tip{scale * 10 * std::cos(angle), 0, scale * 10 * std::sin(angle)};
  return is_found({0, 0, 0}, {scale * 10, 0, 0}, tip, goals) || is_found(tip, {0, 0, 0}, {scale * 10, 0, 0}, goals);
}

TEST(find_unrefined, an_angle_below_the_bound_is_found_at_any_corner_and_scale) {
  for (const double scale : {1.0, 1e-200, 1e150, 1e-30}) {
    for (const double bound : {1.0, 20.7, 25.0, 33.0}) {
      EXPECT_TRUE(is_angle_found(bound - 1e-6, bound, scale)) << bound << ' ' << scale;
      EXPECT_FALSE(is_angle_found(bound + 1e-6, bound, scale)) << bound << ' ' << scale;
    }
  }
}

TEST(find_unrefined, a_degenerate_triangle_is_found_wherever_there_is_a_bound_on_angles) {
  Goals goals = no_goals();
  goals.min_angle_deg = 1;
  EXPECT_TRUE(is_found({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, goals));
  EXPECT_TRUE(is_found({1, 1, 1}, {1, 1, 1}, {1, 1, 1}, goals));
  EXPECT_FALSE(is_found({1, 1, 1}, {1, 1, 1}, {1, 1, 1}, no_goals()));
}

TEST(find_unrefined, an_edge_above_the_bound_is_found_but_for_rounding) {
  Goals goals = no_goals();
  goals.max_edge_length = 5;
  EXPECT_FALSE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4, 0}, goals));
  EXPECT_FALSE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4 * (1 + 1e-12), 0}, goals));
  EXPECT_TRUE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4 * (1 + 1e-7), 0}, goals));
}

TEST(find_unrefined, an_area_above_the_bound_is_found_but_for_rounding) {
  Goals goals = no_goals();
  goals.max_area = 6;
  EXPECT_FALSE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4, 0}, goals));
  EXPECT_FALSE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4 * (1 + 1e-12), 0}, goals));
  EXPECT_TRUE(is_found({0, 0, 0}, {3, 0, 0}, {3, 4 * (1 + 1e-7), 0}, goals));
}

TEST(find_unrefined, without_goals_nothing_is_found) {
  EXPECT_FALSE(is_found({0, 0, 0}, {1e9, 0, 0}, {5e8, 1e-3, 0}, no_goals()));
}

/// `n` triangles on a line, every third one a needle; reasons go round.
struct Row {
  explicit Row(std::uint32_t n) {
    for (std::uint32_t f = 0; f < n; ++f) {
      const double x = 2.0 * f, height = f % 3 == 0 ? 0.001 : 1;
      for (const Vec3& p : {Vec3{x, 0, 0}, Vec3{x + 1, 0, 0}, Vec3{x, height, 0}}) positions.push_back(p);
      faces.push_back({VertexId(3 * f), VertexId(3 * f + 1), VertexId(3 * f + 2)});
      reasons.push_back(static_cast<UnrefinedReason>(f % 2 == 0 ? 3 : 1));
    }
  }
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;
  std::vector<UnrefinedReason> reasons;
};

TEST(find_unrefined, faces_come_in_order_with_their_reasons) {
  const Row row(40'000);
  Goals goals = no_goals();
  goals.min_angle_deg = 25;
  RunControl control;
  const UnrefinedFaces found = find_unrefined(row.positions, row.faces, row.reasons, {}, goals, control);
  ASSERT_EQ(found.faces.size(), 13'334u);
  ASSERT_EQ(found.reasons.size(), found.faces.size());
  for (std::uint32_t i = 0; i < found.faces.size(); ++i) {
    EXPECT_EQ(found.faces[i], FaceId(3 * i));
    EXPECT_EQ(found.reasons[i], row.reasons[3 * i]);
  }
}

TEST(summarise_unrefined, reasons_come_in_their_order_with_the_first_hundred_places) {
  const Row row(900);
  Goals goals = no_goals();
  goals.min_angle_deg = 25;
  RunControl control;
  const UnrefinedFaces found = find_unrefined(row.positions, row.faces, row.reasons, {}, goals, control);
  const std::vector<Unrefined> summary = summarise_unrefined(found, row.positions, row.faces, Goals{}, control);
  ASSERT_EQ(summary.size(), 2u);
  EXPECT_EQ(summary[0].reason, UnrefinedReason::kAcrossInputAngle);
  EXPECT_EQ(summary[1].reason, UnrefinedReason::kMinEdgeLength);
  for (const Unrefined& u : summary) {
    EXPECT_EQ(u.count, 150u);
    EXPECT_EQ(u.places.size(), 100u);
  }
  // The centroid of the second needle, face 3.
  EXPECT_NEAR(summary[0].places[0].x, 6 + 1.0 / 3, 1e-12);
  EXPECT_NEAR(summary[0].places[0].y, 0.001 / 3, 1e-15);
  EXPECT_TRUE(summarise_unrefined({}, row.positions, row.faces, Goals{}, control).empty());
}

}  // namespace
}  // namespace remesh
