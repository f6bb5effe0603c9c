// Tests that by default, the number of faces stays in proportion to the input, however thin its needles and slits are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/refinement/goals/goals.h"
#include "core/remesh.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

std::uint64_t triangles_of(const PolygonMesh& mesh) { return mesh.corners.size() - 2 * mesh.face_count(); }
std::uint64_t in_proportion(const PolygonMesh& mesh) { return 20 * triangles_of(mesh) + 1000; }

/// A strip of needles in one plane: two rails of length 1, a height apart, with every second vertex on each of them.
PolygonMesh strip_of_needles(int count, double height) {
  PolygonMesh mesh;
  for (int i = 0; i <= count; ++i)
    mesh.positions.push_back({static_cast<double>(i) / count, i % 2 == 0 ? 0 : height, i % 3 == 0 ? 0.0 : 1e-3});
  for (int i = 0; i + 2 <= count; ++i) {
    const int odd = i % 2;
    for (const int k : {i, i + 1 + odd, i + 2 - odd}) mesh.corners.push_back(VertexId(static_cast<std::size_t>(k)));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

TEST(refinement_floor, thin_plates_stay_in_proportion_and_tell_what_is_left) {
  for (const double height : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const PolygonMesh mesh = shapes::box({1, 0.7, height});
    const Result result = refined(mesh);
    expect_promises(mesh, {}, result);
    EXPECT_LE(result.mesh.faces.size(), in_proportion(mesh)) << height;
    EXPECT_GT(result.report.min_edge_length, 0) << height;
    EXPECT_GT(listed(result.report, UnrefinedReason::kSizeFloor), 0u) << height;
    EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kSizeFloor))
        << listed_in_words(result.report);
    EXPECT_GE(shortest_edge(result.mesh), std::min(height, result.report.min_edge_length) * (1 - 1e-9)) << height;
  }
}

TEST(refinement_floor, even_thinner_plates_stay_in_proportion) {
  for (const double height : {1e-7, 1e-8, 1e-9, 1e-10}) {
    const PolygonMesh mesh = shapes::box({1, 0.7, height});
    const Result result = refined(mesh);
    EXPECT_TRUE(result.report.verified.all_true()) << height;
    EXPECT_LE(result.mesh.faces.size(), in_proportion(mesh)) << height;
    EXPECT_EQ(listed(result.report), faces_beyond(result.mesh, bounds_of({})).size()) << height;
  }
}

TEST(refinement_floor, long_beams_stay_long) {
  const PolygonMesh mesh = shapes::box({1, 1, 1000});
  const Result result = refined(mesh);
  expect_promises(mesh, {}, result);
  EXPECT_LE(result.mesh.faces.size(), in_proportion(mesh));
  // A beam that needs fewer faces has no floor.
  const PolygonMesh shorter = shapes::box({1, 1, 100});
  const Result whole = refined(shorter);
  expect_promises(shorter, {}, whole);
  EXPECT_EQ(whole.report.min_edge_length, 0);
  EXPECT_TRUE(whole.report.unrefined.empty()) << listed_in_words(whole.report);
}

TEST(refinement_floor, rows_of_needles_stay_in_proportion_to_their_number) {
  for (const int count : {10, 100, 1000})
    for (const double height : {1e-4, 1e-6, 1e-8}) {
      const PolygonMesh mesh = strip_of_needles(count, height);
      const Result result = refined(mesh);
      EXPECT_TRUE(result.report.verified.all_true()) << count << " of height " << height;
      EXPECT_LE(result.mesh.faces.size(), in_proportion(mesh)) << count << " of height " << height;
      EXPECT_EQ(listed(result.report), faces_beyond(result.mesh, bounds_of({})).size())
          << count << " of height " << height << ": " << listed_in_words(result.report);
    }
}

TEST(refinement_floor, a_floor_of_0_makes_edges_of_any_length) {
  const PolygonMesh mesh = shapes::box({1, 0.7, 1e-3});
  Options options;
  options.min_edge_length = 0;
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_GT(result.mesh.faces.size(), in_proportion(mesh));
  EXPECT_TRUE(result.report.unrefined.empty()) << listed_in_words(result.report);
  EXPECT_EQ(result.report.min_edge_length, 0);
}

TEST(refinement_floor, the_floor_in_the_report_asks_for_the_same_mesh) {
  const PolygonMesh mesh = shapes::box({1, 0.7, 1e-5});
  const Result found = refined(mesh, {}, 1);
  for (const int workers : {2, 8}) {
    const Result again = refined(mesh, {}, workers);
    EXPECT_EQ(again.mesh.positions, found.mesh.positions) << workers << " workers";
    EXPECT_EQ(again.mesh.faces, found.mesh.faces) << workers << " workers";
  }
  Options options;
  options.min_edge_length = found.report.min_edge_length;
  const Result asked = refined(mesh, options);
  EXPECT_EQ(asked.mesh.positions, found.mesh.positions);
  EXPECT_EQ(asked.mesh.faces, found.mesh.faces);
  EXPECT_EQ(listed(asked.report, UnrefinedReason::kMinEdgeLength), listed(found.report, UnrefinedReason::kSizeFloor));
}

TEST(refinement_floor, the_lowest_floor_that_serves_is_taken) {
  const PolygonMesh mesh = shapes::box({1, 0.7, 1e-5});
  Options options;
  options.min_edge_length = refined(mesh).report.min_edge_length / 2;
  EXPECT_GT(refined(mesh, options).mesh.faces.size(), in_proportion(mesh));
}

/// A prism of a convex outline, whose sides turn by equal angles and shrink by a factor from one to the next.
PolygonMesh prism_of_many_widths(int sides, double factor, double height) {
  std::vector<Vec2> outline;
  Vec2 at{0, 0};
  double width = 1, angle = 0;
  for (int i = 0; i < sides; ++i) {
    outline.push_back(at);
    at = {at.x + width * std::cos(angle), at.y + width * std::sin(angle)};
    angle += std::numbers::pi / (sides + 1);
    width *= factor;
  }
  outline.push_back(at);
  outline.push_back({at.x - 3, at.y + 1});
  return shapes::prism(outline, height);
}

/// Returns whether a surface has more triangles below the default bound on angles than another, or a smaller least
/// angle.
bool has_worse_angles(const TriangleMesh& mesh, const TriangleMesh& other) {
  const double least = smallest_angle_deg(mesh);
  if (faces_beyond(mesh, bounds_of({})).size() > faces_beyond(other, bounds_of({})).size()) return true;
  return least < 25 && least < smallest_angle_deg(other) * (1 - 1e-9);
}

TEST(refinement_floor, a_lower_one_leads_to_too_many_faces_or_to_worse_angles) {
  for (const PolygonMesh& mesh :
       {prism_of_many_widths(6, 0.9, 300), prism_of_many_widths(24, 0.9, 300), prism_of_many_widths(16, 0.9, 60)}) {
    Options options;
    options.refine = false;
    const TriangleMesh before = refined(mesh, options).mesh;
    options = {};
    options.max_output_faces = 100'000;
    const Result result = refined(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_LE(result.mesh.faces.size(), in_proportion(mesh));
    EXPECT_FALSE(has_worse_angles(result.mesh, before));
    ASSERT_GT(result.report.min_edge_length, 0);
    options.min_edge_length = 0.9 * result.report.min_edge_length;
    const TriangleMesh lower = refined(mesh, options).mesh;
    EXPECT_TRUE(lower.faces.size() > in_proportion(mesh) || has_worse_angles(lower, before))
        << lower.faces.size() << " faces with a floor of " << *options.min_edge_length;
  }
}

/// The sheet of a nose whose strips become narrower towards its tip: a curve that is extruded by 1.
PolygonMesh nose_of_strips(int strips, double power) {
  PolygonMesh mesh;
  for (int i = 0; i <= strips; ++i) {
    const double s = 2.0 * i / strips - 1;
    const Vec3 at{0.04 * std::copysign(std::pow(std::fabs(s), power), s), -0.05 * std::pow(std::fabs(s), power - 1), 0};
    mesh.positions.push_back(at);
    mesh.positions.push_back(at + Vec3{0, 0, 1});
  }
  for (int i = 0; i < strips; ++i)
    for (const int k : {0, 1, 3, 0, 3, 2}) {
      mesh.corners.push_back(VertexId(static_cast<std::size_t>(2 * i + k)));
      if (mesh.corners.size() % 3 == 0) mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
  return mesh;
}

TEST(refinement_floor, no_worse_angles_are_left_than_there_were) {
  int floors = 0;
  for (const int strips : {20, 40, 80})
    for (const double power : {2.0, 3.0, 4.0}) {
      const PolygonMesh mesh = nose_of_strips(strips, power);
      const Result result = refined(mesh);
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_FALSE(has_worse_angles(result.mesh, shapes::as_triangles(mesh))) << strips << " strips, " << power;
      floors += result.report.min_edge_length > 0 ? 1 : 0;
    }
  EXPECT_GE(floors, 3);
}

STAGE(refinement_floor, test::kExtremeScale) {
  const PolygonMesh mesh = trial.of(prism_of_many_widths(6, 0.9, 300));
  trial.same(trial.length(refined(mesh).report.min_edge_length));
}

TEST(refinement_floor, a_limit_below_the_proportion_is_a_budget) {
  const PolygonMesh mesh = shapes::box({1, 0.7, 1e-5});
  Options options;
  options.max_output_faces = 300;
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_LE(result.mesh.faces.size(), 300u);
  EXPECT_EQ(result.report.min_edge_length, 0);
  EXPECT_GT(listed(result.report, UnrefinedReason::kBudget), 0u) << listed_in_words(result.report);
}

TEST(refinement_floor, what_sizes_ask_for_is_made) {
  const PolygonMesh mesh = shapes::box({1, 1, 1});
  const Options options = with_length(0.02);
  const Result result = refined(mesh, options);
  EXPECT_GT(result.mesh.faces.size(), in_proportion(mesh));
  EXPECT_EQ(result.report.min_edge_length, 0);
  EXPECT_TRUE(result.report.unrefined.empty()) << listed_in_words(result.report);
}

TEST(keep_in_proportion, is_for_everything_but_given_sizes) {
  // Numbers of faces for ten triangles.
  const auto allowed = [](const Options& options) {
    Goals goals = goals_of(options, 1);
    keep_in_proportion(goals, options, 1, 10);
    return goals.faces_without_min_edge;
  };
  EXPECT_EQ(allowed({}), 1'200u);
  EXPECT_EQ(allowed(with_angle(33)), 1'200u);
  EXPECT_EQ(allowed(with_length(1)), Goals::kNoLimit);
  Options options;
  options.max_edge_fraction = 0.1;
  EXPECT_EQ(allowed(options), Goals::kNoLimit);
  options = {};
  options.max_area = 1;
  EXPECT_EQ(allowed(options), Goals::kNoLimit);
  options = {};
  options.gradation = 1.5;
  EXPECT_EQ(allowed(options), 1'200u);
  options.elements_per_circle = 16;
  EXPECT_EQ(allowed(options), 1'200u);
  options = {};
  options.proximity = 1;
  EXPECT_EQ(allowed(options), 20'400u);
  options.elements_per_circle = 16;
  EXPECT_EQ(allowed(options), 5'400u);
  options = {};
  options.min_edge_length = 0;
  EXPECT_EQ(allowed(options), Goals::kNoLimit);
  options = {};
  options.refine = false;
  EXPECT_EQ(allowed(options), Goals::kNoLimit);
}

TEST(refinement_floor, a_plate_keeps_the_proximity_that_is_asked_for) {
  Options options;
  options.proximity = 0.25;
  for (const bool has_circles : {false, true}) {
    if (has_circles) options.elements_per_circle = 16;
    const Result result = refined(shapes::box({100, 100, 1}), options);
    EXPECT_EQ(result.report.min_edge_length, 0);
    EXPECT_TRUE(result.report.unrefined.empty()) << listed_in_words(result.report);
    // No edge is longer than four gaps and a tenth. So there are at least as many faces as equilateral triangles.
    const double longest = 1.1 * 4;
    EXPECT_GT(static_cast<double>(result.mesh.faces.size()), 2 * 100 * 100 / (std::sqrt(3.0) / 4 * longest * longest));
  }
}

TEST(refinement_floor, holds_with_gaps_that_ask_for_far_more) {
  // The gap is 0.01, so the two large faces would have over a million triangles.
  const PolygonMesh plate = shapes::box({10, 10, 0.01});
  Options options;
  options.proximity = 0.5;
  const Result result = refined(plate, options);
  EXPECT_LE(result.mesh.faces.size(), 40 * 12 + 20'000u);
  EXPECT_GT(result.report.min_edge_length, 0);
  EXPECT_GT(2 * listed(result.report, UnrefinedReason::kSizeFloor), result.mesh.faces.size())
      << listed_in_words(result.report);
}

TEST(refinement_floor, holds_beside_curved_surfaces_and_with_gradation) {
  // A pin of 24 facets, and apart from it a sheet of 20 strips that are 40 long and 0.002 wide.
  const PolygonMesh mesh =
      shapes::joined(shapes::cylinder(24, 5, 10), shapes::moved(shapes::sheet(40, 0.04, 1, 20), {0, 20, 0}));
  const auto bent = [&](PolygonMesh strips) {
    // The strips must not lie in one plane.
    for (Vec3& p : strips.positions)
      if (p.y >= 20) p.z = 0.3 * (p.y - 20) * (p.y - 20);
    return strips;
  };
  Options options;
  options.elements_per_circle = 16;
  const PolygonMesh part = bent(mesh);
  const Result circles = refined(part, options);
  EXPECT_LE(circles.mesh.faces.size(), in_proportion(part));
  options.proximity = 0.25;
  EXPECT_LE(refined(part, options).mesh.faces.size(), 40 * part.face_count() + 5'000);
  options = {};
  options.gradation = 1.2;
  EXPECT_LE(refined(part, options).mesh.faces.size(), in_proportion(part));
}

TEST(refinement_floor, triangles_that_cross_everywhere_stay_in_proportion) {
  Random random(3);
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 150; ++i) {
    const double x = random.unit(), y = random.unit();
    positions.push_back({x, y, random.unit()});
    if (i % 3 == 2) faces.push_back({i - 2, i - 1, i});
  }
  Options options;
  options.proximity = 0.25;
  options.elements_per_circle = 16;
  const Result result = refined(shapes::from_lists(positions, faces), options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(result.mesh.faces.size(), 40 * 50 + 5'000u);
}

}  // namespace
}  // namespace remesh
