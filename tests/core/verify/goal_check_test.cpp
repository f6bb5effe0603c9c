#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "tests/core/verify/refined.h"
#include "tests/support/invariance.h"

namespace remesh {
namespace {

constexpr UnrefinedReason kAllReasons[] = {UnrefinedReason::kInputAngle,    UnrefinedReason::kAcrossInputAngle,
                                           UnrefinedReason::kSizeFloor,     UnrefinedReason::kMinEdgeLength,
                                           UnrefinedReason::kBudget,        UnrefinedReason::kBoundaryLocked,
                                           UnrefinedReason::kOutputRounding};

/// Returns the verdict on quality. Everything else must be right.
bool is_good(const Example& e) {
  const Verdict v = e.verify();
  EXPECT_TRUE(v.surface && v.conforming && v.delaunay) << all_words(v);
  EXPECT_EQ(v.quality.value(), v.failures.empty()) << all_words(v);
  return v.quality.value();
}

Vec3 on_ray(double degrees, double radius) {
  const double angle = degrees * 3.14159265358979323846 / 180;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

double least_angle_deg(const Example& e, std::size_t f) {
  double least = 180;
  for (int i = 0; i < 3; ++i) {
    const Vec3& at = e.positions[e.faces[f][i].value];
    const Vec3 a = normalized(e.positions[e.faces[f][(i + 1) % 3].value] - at);
    const Vec3 b = normalized(e.positions[e.faces[f][(i + 2) % 3].value] - at);
    least = std::min(least, std::acos(dot(a, b)) * 180 / 3.14159265358979323846);
  }
  return least;
}

/// Makes a wedge of which every face below the bound is listed. The reason of the first is its corner, and that of the
/// others is the angle across which they lie.
Example certified_wedge(double degrees, int shells, double bound) {
  Example e = wedge(degrees, shells, bound);
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (least_angle_deg(e, f) < bound)
      list(e, f,
           f == e.face_at({0, 0, 0}, on_ray(0, 1), on_ray(degrees, 1)) ? UnrefinedReason::kInputAngle
                                                                       : UnrefinedReason::kAcrossInputAngle);
  return e;
}

/// Returns whether the reason holds for any of the listed faces. Each face is tried alone, and the others get a
/// reason that always holds.
bool is_any_certified(Example e, UnrefinedReason reason) {
  bool is_any = false;
  for (std::size_t i = 0; i < e.unrefined.size(); ++i) {
    std::fill(e.reasons.begin(), e.reasons.end(), UnrefinedReason::kSizeFloor);
    EXPECT_TRUE(is_good(e));
    e.reasons[i] = reason;
    is_any = is_good(e) || is_any;
  }
  return is_any;
}

// Faces and bounds.

TEST(verify_goals, bounds_that_all_faces_meet_are_met) {
  Example e = refined_cube(2);
  *e.goals = angle_goal(33);
  e.goals->max_edge_length = std::sqrt(0.5);
  e.goals->max_area = 0.125;
  e.goals->min_edge_length = 0.5;
  e.goals->max_faces = e.faces.size();
  EXPECT_TRUE(is_good(e));
  for (const double scale : {1e-100, 1e100}) EXPECT_TRUE(is_good(scaled(e, scale)));
}

TEST(verify_goals, each_bound_that_faces_miss_is_found) {
  const std::function<void(Goals&)> tighten[] = {
      [](Goals& g) { g.min_angle_deg = 45.001; }, [](Goals& g) { g.max_edge_length = 0.70710; },
      [](Goals& g) { g.max_area = 0.12499; },     [](Goals& g) { g.min_edge_length = 0.50001; },
      [](Goals& g) { g.max_faces = 47; },         [](Goals& g) { g.split_boundaries = false; }};
  for (const auto& change : tighten) {
    Example e = refined_cube(2);
    ASSERT_TRUE(is_good(e));
    change(*e.goals);
    EXPECT_FALSE(is_good(e));
  }
}

TEST(verify_goals, the_faces_listed_are_exactly_those_that_miss) {
  // One corner of the square is far out: two of its four triangles have small angles.
  Example e = refined(shapes::from_lists({{0, 0, 0}, {9, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}),
                      shapes::from_lists({{0, 0, 0}, {9, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1.5, 1, 0}},
                                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
                      angle_goal(25));
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (least_angle_deg(e, f) < 25) list(e, f, UnrefinedReason::kSizeFloor);
  ASSERT_EQ(e.unrefined.size(), 2u);
  EXPECT_TRUE(is_good(e));
  for (std::size_t f = 0; f < e.faces.size(); ++f) {
    Example other = e;
    const auto at = std::find(other.unrefined.begin(), other.unrefined.end(), FaceId(f));
    if (at == other.unrefined.end()) {
      list(other, f, UnrefinedReason::kSizeFloor);
    } else {
      other.reasons.pop_back();
      other.unrefined.erase(at);
    }
    EXPECT_FALSE(is_good(other)) << f;
    EXPECT_TRUE(blames(other.verify(), other.face_patch[f]));
  }
}

TEST(verify_goals, at_a_bound_to_rounding_a_face_may_be_listed_or_not) {
  for (const double share : {1 - 1e-12, 1.0, 1 + 1e-12}) {
    Example e = refined_cube(2);
    e.goals->max_edge_length = share * std::sqrt(0.5);
    e.goals->min_angle_deg = share * 45;
    EXPECT_TRUE(is_good(e));
    for (std::size_t f = 0; f < e.faces.size(); f += 2) list(e, f, UnrefinedReason::kSizeFloor);
    EXPECT_TRUE(is_good(e));
  }
}

TEST(verify_goals, a_face_of_no_area_kept_as_it_is_counts_as_below_any_angle) {
  const PolygonMesh flat = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}, {{0, 1, 2}});
  Example e = refined(Example());
  e.surface = shapes::surface(flat);
  e.surface_patch.assign(1, PatchId(0));
  e.frames.push_back({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2, 0x1p-40});
  e.positions = flat.positions.items();
  e.faces = {{VertexId(0), VertexId(1), VertexId(2)}};
  e.face_patch = {PatchId(0)};
  e.plane_tolerance = 1e-9;
  e.project();
  EXPECT_TRUE(is_good(e));
  *e.goals = angle_goal(1);
  EXPECT_FALSE(is_good(e));
  for (const UnrefinedReason reason : kAllReasons) {
    Example listed = e;
    list(listed, 0, reason);
    EXPECT_EQ(is_good(listed), reason == UnrefinedReason::kSizeFloor);
  }
}

// Reasons.

TEST(verify_goals, certificates_of_input_angles_hold_at_input_angles) {
  for (const double degrees : {3.0, 10.0, 20.0, 24.0}) {
    const Example e = certified_wedge(degrees, 4, 25);
    ASSERT_GE(e.unrefined.size(), 1u);
    EXPECT_TRUE(is_good(e)) << degrees;
  }
}

TEST(verify_goals, certificates_hold_where_a_vertex_stays_in_the_line_of_the_shells) {
  // The input has a vertex where the second shell is: the sides are two chains each, and one line.
  Example with = certified_wedge(5, 4, 25);
  with.surface = shapes::surface(
      shapes::from_lists({{0, 0, 0}, on_ray(0, 2), on_ray(0, 4), on_ray(5, 4)}, {{0, 1, 3}, {1, 2, 3}}));
  with.surface_patch.assign(2, PatchId(0));
  EXPECT_TRUE(is_good(with));
}

TEST(verify_goals, a_wrong_certificate_is_found) {
  const Example e = certified_wedge(10, 4, 25);
  ASSERT_GE(e.unrefined.size(), 3u);
  for (std::size_t i = 0; i < e.unrefined.size(); ++i) {
    Example other = e;
    const bool is_corner = e.reasons[i] == UnrefinedReason::kInputAngle;
    other.reasons[i] = is_corner ? UnrefinedReason::kAcrossInputAngle : UnrefinedReason::kInputAngle;
    // The corner's own triangle has both: its shortest side joins the first shell's points.
    EXPECT_EQ(is_good(other), is_corner) << i;
  }
}

TEST(verify_goals, points_on_different_shells_certify_nothing) {
  // The second shell's left point is a little further out.
  Example e = certified_wedge(10, 4, 25);
  move_vertex(e, e.positions[4], on_ray(10, 2.01));
  e.make_delaunay();
  EXPECT_FALSE(is_good(e));
  // It may be further out within rounding.
  e = certified_wedge(10, 4, 25);
  move_vertex(e, e.positions[4], (1 + 1e-13) * e.positions[4]);
  e.make_delaunay();
  EXPECT_TRUE(e.verify().quality.value());
}

TEST(verify_goals, a_longer_side_across_an_input_angle_certifies_nothing) {
  // A flat triangle stands across the corner, its longest side on one shell.
  const std::vector<Vec3> points{{0, 0, 0}, on_ray(0, 4), on_ray(40, 4), on_ray(40, 3), on_ray(0, 3), on_ray(20, 3.21)};
  Example e =
      refined(shapes::from_lists({points[0], points[1], points[2]}, {{0, 1, 2}}),
              shapes::from_lists(points, {{0, 4, 3}, {4, 5, 3}, {4, 1, 5}, {1, 2, 5}, {2, 3, 5}}), angle_goal(25));
  const std::size_t flat = e.face_at(points[3], points[4], points[5]);
  ASSERT_LT(least_angle_deg(e, flat), 25);
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (least_angle_deg(e, f) < 25) list(e, f, UnrefinedReason::kSizeFloor);
  EXPECT_FALSE(is_any_certified(e, UnrefinedReason::kAcrossInputAngle));
}

TEST(verify_goals, a_side_of_new_vertices_across_a_right_angle_certifies_nothing) {
  // A corner cut by a short edge, under a far point: the shortest edge's ends are as far from the corner, at 90
  // degrees.
  const PolygonMesh input = shapes::sheet(4, 4, 1, 1);
  Example e = refined(input, input, angle_goal(25));
  split_edge(e, {0, 0, 0}, {4, 0, 0}, {0.5, 0, 0});
  split_edge(e, {0, 0, 0}, {0, 4, 0}, {0, 0.5, 0});
  std::size_t needles = 0;
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (least_angle_deg(e, f) < 25) {
      list(e, f, UnrefinedReason::kAcrossInputAngle);
      ++needles;
    }
  ASSERT_GE(needles, 1u);
  EXPECT_FALSE(is_good(e));
  for (UnrefinedReason& reason : e.reasons) reason = UnrefinedReason::kSizeFloor;
  EXPECT_TRUE(is_good(e));
}

TEST(verify_goals, an_input_angle_that_an_inner_edge_divides_certifies_nothing) {
  // Forty degrees, halved by an edge to a new vertex inside.
  const std::vector<Vec3> points{{0, 0, 0}, on_ray(0, 3), on_ray(40, 3), on_ray(20, 2)};
  Example e = refined(shapes::from_lists({points[0], points[1], points[2]}, {{0, 1, 2}}),
                      shapes::from_lists(points, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}), angle_goal(15));
  e.goals->min_angle_deg = 20.5;
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (least_angle_deg(e, f) < 20.5) list(e, f, UnrefinedReason::kSizeFloor);
  ASSERT_EQ(e.unrefined.size(), 2u);
  EXPECT_FALSE(is_any_certified(e, UnrefinedReason::kInputAngle));
}

TEST(verify_goals, an_input_angle_does_not_explain_another_small_one) {
  // A triangle of 10 and 12 degrees: at either the other one is below the bound as well.
  const PolygonMesh needle = shapes::from_lists({{0, 0, 0}, {10, 0, 0}, {5.5, 1, 0}}, {{0, 1, 2}});
  Example e = refined(needle, needle, angle_goal(25));
  list(e, 0, UnrefinedReason::kInputAngle);
  EXPECT_FALSE(is_good(e));
  e.reasons[0] = UnrefinedReason::kSizeFloor;
  EXPECT_TRUE(is_good(e));
}

TEST(verify_goals, an_input_angle_does_not_explain_a_size) {
  Example e = certified_wedge(10, 4, 25);
  ASSERT_TRUE(is_any_certified(e, UnrefinedReason::kInputAngle));
  ASSERT_TRUE(is_any_certified(e, UnrefinedReason::kAcrossInputAngle));
  e.goals->max_edge_length = 0.9;
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (std::find(e.unrefined.begin(), e.unrefined.end(), FaceId(f)) == e.unrefined.end())
      list(e, f, UnrefinedReason::kSizeFloor);
  EXPECT_FALSE(is_any_certified(e, UnrefinedReason::kInputAngle));
  EXPECT_FALSE(is_any_certified(e, UnrefinedReason::kAcrossInputAngle));
}

TEST(verify_goals, a_locked_boundary_is_a_reason_only_where_one_is_locked) {
  // Two cubes side by side: one of them may be frozen.
  const PolygonMesh cubes = shapes::joined(shapes::box({1, 1, 1}), shapes::moved(shapes::box({1, 1, 1}), {3, 0, 0}));
  Example e = refined(cubes, cubes);
  e.goals->max_edge_length = 0.9;
  for (std::size_t f = 0; f < e.faces.size(); ++f) list(e, f, UnrefinedReason::kBoundaryLocked);
  EXPECT_FALSE(is_good(e));
  e.goals->split_boundaries = false;
  EXPECT_TRUE(is_good(e));
  e.goals->split_boundaries = true;
  // One side of the first cube is frozen, and with it its edges: those are the edges of all its sides but the opposite.
  e.frozen.assign(e.frames.size(), 0);
  const PatchId top = e.face_patch[e.face_at({0, 0, 1}, {1, 0, 1}, {1, 1, 1})];
  e.frozen[top.value] = 1;
  EXPECT_FALSE(is_good(e));
  const Verdict verdict = e.verify();
  EXPECT_FALSE(blames(verdict, top));
  for (std::size_t f = 0; f < e.faces.size(); ++f) {
    const auto is_in_first = [&](VertexId v) { return e.positions[v.value].x < 2; };
    const auto is_low = [&](VertexId v) { return e.positions[v.value].z == 0; };
    const bool is_beside = std::all_of(e.faces[f].begin(), e.faces[f].end(), is_in_first) &&
                           !std::all_of(e.faces[f].begin(), e.faces[f].end(), is_low);
    EXPECT_EQ(blames(verdict, e.face_patch[f]), !is_beside) << f;
  }
  e.frozen.assign(e.frames.size(), 1);
  EXPECT_TRUE(is_good(e));
  e.frozen.pop_back();
  EXPECT_FALSE(e.verify().surface);
}

// Gaps.

Goals gap_goal(double proximity, double gradation = 1.5) {
  Goals goals = no_goals();
  goals.proximity = proximity;
  goals.gradation = gradation;
  return goals;
}

/// Returns whether the claim is good without any face listed.
bool is_met(const PolygonMesh& mesh, const Goals& goals) { return is_good(refined(mesh, mesh, goals)); }

/// Returns whether the claim is good with all faces listed.
bool is_missed_by_all(const PolygonMesh& mesh, const Goals& goals) {
  Example e = refined(mesh, mesh, goals);
  for (std::size_t f = 0; f < e.faces.size(); ++f) list(e, f, UnrefinedReason::kSizeFloor);
  return is_good(e);
}

PolygonMesh two_sheets(double gap) {
  return shapes::joined(shapes::sheet(2, 2, 4, 4), shapes::moved(shapes::sheet(2, 2, 4, 4), {0, 0, gap}));
}

TEST(verify_goals, edges_longer_than_a_gap_have_to_be_listed_and_shorter_ones_must_not) {
  // Edges of 0.5, and of 0.71 across the squares: with a tenth more they need gaps of 0.643.
  const double needed = std::sqrt(0.5) / Goals::kSizeSlack;
  for (const double proximity : {1.0, 2.0, 0.25}) {
    const Goals goals = gap_goal(proximity);
    EXPECT_TRUE(is_met(two_sheets(1.03 * needed * proximity), goals)) << proximity;
    EXPECT_FALSE(is_missed_by_all(two_sheets(1.03 * needed * proximity), goals)) << proximity;
    EXPECT_FALSE(is_met(two_sheets(0.97 * needed * proximity), goals)) << proximity;
    EXPECT_TRUE(is_missed_by_all(two_sheets(0.97 * needed * proximity), goals)) << proximity;
  }
}

TEST(verify_goals, a_gap_is_found_in_any_unit_and_wherever_a_part_is) {
  const PolygonMesh near = two_sheets(0.3), far = two_sheets(1.5);
  for (const double scale : {1e-100, 1e-3, 1e100}) {
    Example e = refined(near, near, gap_goal(1));
    EXPECT_FALSE(is_good(scaled(e, scale)));
    e = refined(far, far, gap_goal(1));
    EXPECT_TRUE(is_good(scaled(e, scale)));
  }
  const Vec3 by{0x1p20, -0x1p21, 0x1p19};
  EXPECT_FALSE(is_met(shapes::moved(near, by), gap_goal(1)));
  EXPECT_TRUE(is_met(shapes::moved(far, by), gap_goal(1)));
}

TEST(verify_goals, walls_slots_and_hollows_have_gaps) {
  EXPECT_FALSE(is_met(shapes::box({1, 1, 0.1}, 3), gap_goal(1)));
  EXPECT_TRUE(is_met(shapes::box({1, 1, 1}, 3), gap_goal(1)));
  const PolygonMesh hollow = shapes::joined(
      shapes::box({1, 1, 1}, 3), shapes::turned_over(shapes::moved(shapes::box({0.8, 0.8, 0.8}, 3), {0.1, 0.1, 0.1})));
  EXPECT_FALSE(is_met(hollow, gap_goal(1)));
}

TEST(verify_goals, faces_that_meet_at_an_edge_have_no_gap_but_two_pages_beside_each_other_have) {
  // An edge of 1 across; near the sharp edge it is longer than the way across.
  for (const double degrees : {3.0, 20.0, 35.0, 41.0, 60.0, 120.0}) {
    const double angle = degrees * 3.14159265358979323846 / 180;
    const PolygonMesh pages = shapes::from_lists({{0, 0, 0},
                                                  {0, 1, 0},
                                                  {1, 0, 0},
                                                  {1, 1, 0},
                                                  {std::cos(angle), 0, std::sin(angle)},
                                                  {std::cos(angle), 1, std::sin(angle)}},
                                                 {{0, 2, 1}, {2, 3, 1}, {0, 1, 4}, {1, 5, 4}});
    EXPECT_TRUE(is_met(pages, gap_goal(1))) << degrees;
    // The second page is lifted off the edge by a hundredth.
    const PolygonMesh apart = shapes::from_lists({{0, 0, 0},
                                                  {0, 1, 0},
                                                  {1, 0, 0},
                                                  {1, 1, 0},
                                                  {0, 0, 0.01},
                                                  {0, 1, 0.01},
                                                  {std::cos(angle), 0, 0.01 + std::sin(angle)},
                                                  {std::cos(angle), 1, 0.01 + std::sin(angle)}},
                                                 {{0, 2, 1}, {2, 3, 1}, {4, 5, 6}, {5, 7, 6}});
    EXPECT_FALSE(is_met(apart, gap_goal(1))) << degrees;
  }
}

TEST(verify_goals, what_a_closed_surface_hides_is_no_gap) {
  // A step of 0.1 in a block: from one tread to the other it is through the riser.
  const std::vector<Vec2> outline{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0.9}, {0, 0.9}};
  std::vector<Vec3> points;
  for (const double z : {0.0, 0.3})
    for (const Vec2& p : outline) points.push_back({p.x, p.y, z});
  std::vector<std::vector<std::uint32_t>> faces;
  for (const std::array<std::uint32_t, 3>& t :
       {std::array{0u, 1u, 4u}, std::array{0u, 4u, 5u}, std::array{1u, 2u, 3u}, std::array{1u, 3u, 4u}}) {
    faces.push_back({t[0], t[2], t[1]});
    faces.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    faces.push_back({i, j, j + 6});
    faces.push_back({i, j + 6, i + 6});
  }
  const PolygonMesh step = shapes::from_lists(points, faces);
  const auto are_treads_blamed = [&](const PolygonMesh& mesh) {
    const Example e = refined(mesh, mesh, gap_goal(0.9));
    const Verdict v = e.verify();
    bool is_any = false;
    for (std::size_t f = 0; f < e.faces.size(); ++f)
      is_any = is_any || (e.frames[e.face_patch[f]].normal.y > 0.5 && blames(v, e.face_patch[f]));
    return is_any;
  };
  EXPECT_FALSE(are_treads_blamed(step));
  // A surface with an open side hides nothing.
  faces.pop_back();
  EXPECT_TRUE(are_treads_blamed(shapes::from_lists(points, faces)));
}

TEST(verify_goals, patches_that_cross_have_no_gap) {
  const PolygonMesh crossing = shapes::joined(
      shapes::sheet(2, 2, 2, 2), shapes::moved(shapes::rotated(shapes::sheet(2, 2, 2, 2), {0, 1, 0}, 10), {0, 0, 0.1}));
  Example e = refined(crossing, crossing, gap_goal(1));
  EXPECT_FALSE(e.verify().all_true());
  e.allow_intersections();
  ASSERT_FALSE(e.intersecting_patches.empty());
  EXPECT_TRUE(is_good(e));
}

TEST(verify_goals, a_size_is_no_small_angle) {
  // Both bounds are missed: an angle of the input explains only the one.
  const PolygonMesh needle = shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 1, 0}}, {{0, 1, 2}});
  Example e = refined(needle, needle, angle_goal(25));
  list(e, 0, UnrefinedReason::kInputAngle);
  EXPECT_TRUE(is_good(e));
  const PolygonMesh two = shapes::joined(needle, shapes::moved(needle, {0, 0, 0.5}));
  e = refined(two, two, angle_goal(25));
  for (const std::size_t f : {0, 1}) list(e, f, UnrefinedReason::kInputAngle);
  EXPECT_TRUE(is_good(e));
  e.goals->proximity = 1;
  EXPECT_FALSE(is_good(e));
  e.reasons.assign(2, UnrefinedReason::kSizeFloor);
  EXPECT_TRUE(is_good(e));
}

TEST(verify_goals, edges_that_grow_too_fast_have_to_be_listed) {
  // A square with one corner cut off: beside the short edge, one of 5.6 across.
  const PolygonMesh mesh = shapes::polygon({{0, 0}, {4, 0}, {4, 4}, {0.25, 4}, {0, 3.75}});
  const PolygonMesh triangles = shapes::fan_triangulated(mesh);
  Goals goals = no_goals();
  EXPECT_TRUE(is_good(refined(mesh, triangles, goals)));
  goals.gradation = 1.5;
  EXPECT_FALSE(is_good(refined(mesh, triangles, goals)));
  goals.gradation = 5;
  EXPECT_TRUE(is_good(refined(mesh, triangles, goals)));
  Example e = refined(mesh, triangles, goals);
  list(e, 0, UnrefinedReason::kSizeFloor);
  EXPECT_FALSE(is_good(e));
}

TEST(verify_goals, floors_and_budgets_are_reasons_only_where_there_are_some) {
  Example e = refined(shapes::sheet(2, 2, 1, 1), shapes::sheet(2, 2, 1, 1), no_goals());
  e.goals->max_edge_length = 1;
  for (const UnrefinedReason reason : {UnrefinedReason::kMinEdgeLength, UnrefinedReason::kBudget}) {
    Example listed = e;
    for (std::size_t f = 0; f < e.faces.size(); ++f) list(listed, f, reason);
    EXPECT_FALSE(is_good(listed));
    listed.goals->min_edge_length = 0.1;
    listed.goals->max_faces = 2;
    EXPECT_TRUE(is_good(listed));
  }
}

// Least lengths.

TEST(verify_goals, what_was_short_before_may_stay_short) {
  Example e = cube();
  *(e.goals = no_goals());
  e.goals->min_edge_length = 10;
  EXPECT_TRUE(is_good(e));
}

TEST(verify_goals, short_edges_are_allowed_across_a_small_input_angle_only) {
  Example e = certified_wedge(10, 4, 25);
  // The shells are a unit apart; the shortest edge across is a sixth.
  e.goals->min_edge_length = 1;
  EXPECT_TRUE(is_good(e));
  e.goals->min_edge_length = 1.01;
  EXPECT_FALSE(is_good(e));

  // The edges run from side to side of a strip.
  const PolygonMesh strip = shapes::from_lists({{0, 0, 0}, {8, 0, 0}, {8, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  e = refined(strip, strip);
  split_edge(e, {0, 0, 0}, {8, 0, 0}, {4, 0, 0});
  split_edge(e, {8, 1, 0}, {0, 1, 0}, {4, 1, 0});
  e.goals->min_edge_length = 1;
  EXPECT_TRUE(is_good(e));
  e.goals->min_edge_length = 1.01;
  EXPECT_FALSE(is_good(e));
}

// The next tests are about the list itself.

TEST(verify_goals, a_list_that_does_not_fit_together_fails_as_a_whole) {
  const std::function<void(Example&)> spoil[] = {[](Example& e) { e.reasons.pop_back(); },
                                                 [](Example& e) { std::swap(e.unrefined[0], e.unrefined[1]); },
                                                 [](Example& e) { e.unrefined[1] = e.unrefined[0]; },
                                                 [](Example& e) { e.unrefined.back() = FaceId(e.faces.size()); },
                                                 [](Example& e) { e.goals->max_area = std::nan(""); }};
  for (const auto& change : spoil) {
    Example e = certified_wedge(10, 4, 25);
    change(e);
    const Verdict v = e.verify();
    EXPECT_FALSE(v.surface || v.conforming || v.delaunay || v.quality.value());
  }
}

STAGE(verify_goals, test::kWorkers) {
  Example e = refined_cube(4);
  e.goals->max_edge_length = 0.3;
  e.goals->min_edge_length = 0.26;
  for (std::size_t f = 0; f < e.faces.size(); f += 5) list(e, f, kAllReasons[f % 6]);
  const Verdict verdict = e.verify();
  EXPECT_FALSE(verdict.quality.value());
  trial.in_order(verdict.failures, verdict.failed_patches);
}

}  // namespace
}  // namespace remesh
