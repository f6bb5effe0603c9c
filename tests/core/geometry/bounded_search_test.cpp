/// Tests the bounds on the search for intersections: what is found within them, and what is told of the rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/triangles/triangle_intersection.h"
#include "tests/support/hostile_families.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using FacePairs = std::vector<std::pair<FaceId, FaceId>>;

constexpr std::size_t kAllPairs = std::size_t{1} << 32;

/// Returns the triangles of a family, with each larger polygon as a fan.
TriangleMesh triangles_of(std::string_view family, std::size_t size) {
  const PolygonMesh polygons = hostile::family(family).make(size);
  TriangleMesh mesh;
  mesh.positions = polygons.positions;
  for (std::uint32_t f = 0; f < polygons.face_count(); ++f) {
    const auto loop = polygons.face(FaceId(f));
    for (std::size_t i = 2; i < loop.size(); ++i) mesh.faces.push_back({loop[0], loop[i - 1], loop[i]});
  }
  return mesh;
}

/// Makes a fan of needles in a plane, from one corner to many places along a line, and a small wall that stands on the
/// line at each place. So each needle passes below the walls before its own. This is what triangulating the base of a
/// comb comes to.
TriangleMesh needles_below_walls(std::uint32_t size) {
  TriangleMesh mesh;
  const VertexId corner = mesh.positions.push_back({0, -1, 0});
  for (std::uint32_t i = 0; i < size; ++i) {
    const VertexId a = mesh.positions.push_back({2.0 * i, 0, 0}), b = mesh.positions.push_back({2.0 * i + 1, 0, 0});
    mesh.faces.push_back({corner, b, a});
    mesh.faces.push_back({a, b, mesh.positions.push_back({2.0 * i, 5, 1})});
  }
  return mesh;
}

SelfIntersections find(const TriangleMesh& mesh, const SearchLimits& limits) {
  RunControl control;
  return self_intersections(mesh.positions.items(), mesh.faces.items(), {}, limits, control);
}

FacePairs all_pairs(const TriangleMesh& mesh) {
  // The coordinates of these families are small, so they need no scaling.
  FacePairs pairs;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::uint32_t g = f + 1; g < mesh.faces.size(); ++g)
      if (do_intersect(mesh.faces[FaceId(f)], mesh.faces[FaceId(g)], mesh.positions.items()))
        pairs.emplace_back(FaceId(f), FaceId(g));
  return pairs;
}

TEST(bounded_search, a_search_that_is_cut_short_finds_some_pairs_and_estimates_all) {
  for (const char* family : {"soup_in_a_cube", "soup_in_a_plane", "planks"}) {
    const TriangleMesh mesh = triangles_of(family, 1000);
    const FacePairs all = all_pairs(mesh);
    SearchLimits limits(all.size() / 4);
    limits.is_estimate_wanted = true;
    const SelfIntersections some = find(mesh, limits);
    EXPECT_FALSE(some.is_complete) << family;
    EXPECT_EQ(some.pairs.size(), all.size() / 4) << family;
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.pairs.begin(), some.pairs.end())) << family;
    EXPECT_GT(some.searched, 0) << family;
    EXPECT_LT(some.searched, 1) << family;
    EXPECT_NEAR(some.estimated_pairs, static_cast<double>(all.size()), 0.2 * static_cast<double>(all.size())) << family;
    EXPECT_EQ(find(mesh, kAllPairs).pairs, all) << family;
  }
}

TEST(bounded_search, it_ends_soon_after_the_steps_that_are_allowed) {
  const TriangleMesh mesh = triangles_of("spanning_needles", 4000);
  const std::uint64_t all = find(mesh, kAllPairs).steps;
  for (const std::uint64_t part : {3, 10, 40}) {
    const SelfIntersections some = find(mesh, {kAllPairs, all / part});
    EXPECT_FALSE(some.is_complete);
    EXPECT_GE(some.steps, all / part);
    EXPECT_LT(some.steps, all / part + all / 4) << part;
    EXPECT_LT(some.searched, 1);
  }
  EXPECT_TRUE(find(mesh, {kAllPairs, all}).is_complete);
}

STAGE(bounded_search, test::kWorkers) {
  SearchLimits limits(20'000, 2'000'000);
  limits.is_estimate_wanted = true;
  for (const char* family : {"soup_in_a_cube", "spanning_needles", "planks", "fan_around_an_edge"}) {
    const SelfIntersections found = find(triangles_of(family, 5000), limits);
    trial.in_order(found.pairs, found.steps, found.searched, found.estimated_pairs);
  }
}

TEST(bounded_search, a_pair_that_is_not_expected_is_found_among_any_number_of_expected_ones) {
  TriangleMesh mesh = triangles_of("soup_in_a_cube", 600);
  const FacePairs all = all_pairs(mesh);
  ASSERT_GT(all.size(), 1000u);
  const FacePairs planted{all[all.size() / 5], all[all.size() / 2], all.back()};
  for (const std::size_t limit : {std::size_t{5}, std::size_t{100}, all.size() - 1}) {
    SearchLimits limits(limit);
    limits.is_expected = [&](FaceId f, FaceId g) {
      return std::find(planted.begin(), planted.end(), std::pair(std::min(f, g), std::max(f, g))) == planted.end();
    };
    const SelfIntersections found = find(mesh, limits);
    EXPECT_TRUE(found.is_complete) << limit;
    EXPECT_FALSE(found.are_all_listed) << limit;
    EXPECT_LE(found.pairs.size(), limit + planted.size());
    EXPECT_TRUE(std::includes(found.pairs.begin(), found.pairs.end(), planted.begin(), planted.end())) << limit;
  }
  SearchLimits limits(2);
  limits.is_expected = [](FaceId, FaceId) { return false; };
  EXPECT_FALSE(find(mesh, limits).is_complete) << "too many that are not expected";
}

TEST(bounded_search, pairs_that_are_not_expected_end_the_search) {
  const TriangleMesh mesh = triangles_of("soup_in_a_cube", 1000);
  const FacePairs all = all_pairs(mesh);
  // Half of all pairs are expected.
  const auto is_expected = [](FaceId f, FaceId g) { return (f.value + g.value) % 2 == 0; };
  const auto unexpected = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [&](const auto& pair) { return !is_expected(pair.first, pair.second); }));
  for (const std::size_t max_pairs : {all.size() / 20, 2 * all.size()}) {
    SearchLimits limits(max_pairs);
    limits.is_expected = is_expected;
    limits.max_unexpected = unexpected;
    EXPECT_EQ(find(mesh, limits).is_complete, max_pairs > unexpected) << "the smaller limit holds";
    limits.max_unexpected = max_pairs / 4;
    const SelfIntersections some = find(mesh, limits);
    EXPECT_EQ(some.is_complete, limits.max_unexpected >= unexpected);
    EXPECT_EQ(some.are_all_listed, some.is_complete);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.pairs.begin(), some.pairs.end()));
  }
}

TEST(bounded_search, one_pair_that_is_not_expected_is_enough_after_many_steps) {
  const TriangleMesh mesh = triangles_of("soup_in_a_cube", 1000);
  const std::uint64_t steps = find(mesh, kAllPairs).steps;
  const FacePairs all = all_pairs(mesh);
  for (const bool is_any_unexpected : {false, true}) {
    SearchLimits limits(kAllPairs);
    limits.is_expected = [&](FaceId f, FaceId g) {
      return !is_any_unexpected || std::pair(std::min(f, g), std::max(f, g)) != all.front();
    };
    limits.max_steps_with_unexpected = steps / 4;
    const SelfIntersections found = find(mesh, limits);
    EXPECT_EQ(found.is_complete, !is_any_unexpected);
    EXPECT_EQ(found.steps < steps, is_any_unexpected);
  }
}

TEST(bounded_search, well_shaped_faces_take_less_than_a_tenth_of_the_steps_that_are_allowed) {
  for (const PolygonMesh& shape : {shapes::sphere(6), shapes::rotated(shapes::box({1, 2, 3}, 40), {1, 2, 3}, 30)}) {
    const TriangleMesh mesh = shapes::as_triangles(shape);
    const auto faces = static_cast<std::uint64_t>(mesh.faces.size());
    const SelfIntersections found = find(mesh, kAllPairs);
    EXPECT_TRUE(found.pairs.empty());
    // The bound without the part that small surfaces have in addition.
    EXPECT_LT(found.steps, (SearchLimits::steps_for(faces) - SearchLimits::steps_for(0)) / 10);
  }
}

TEST(bounded_search, steps_grow_by_less_than_fourteen_in_a_decade_if_few_faces_meet) {
  for (const char* family : {"straight_stack", "askew_stack", "parallel_needles", "fan_around_an_edge"}) {
    const auto steps = [&](std::size_t size) {
      return static_cast<double>(find(triangles_of(family, size), kAllPairs).steps);
    };
    EXPECT_LT(steps(20'000) / steps(2000), 14) << family;
  }
}

TEST(bounded_search, a_fan_of_needles_takes_less_than_a_third_of_the_steps_that_are_allowed) {
  const SelfIntersections found = find(triangles_of("fan_around_a_vertex", 100'000), kAllPairs);
  EXPECT_TRUE(found.pairs.empty());
  EXPECT_LT(found.steps, (SearchLimits::steps_for(100'000) - SearchLimits::steps_for(0)) / 3);
}

TEST(bounded_search, steps_for_needles_below_small_walls_grow_nearly_in_proportion) {
  const auto steps = [](std::uint32_t size) {
    const SelfIntersections found = find(needles_below_walls(size), kAllPairs);
    EXPECT_TRUE(found.pairs.empty());
    return static_cast<double>(found.steps);
  };
  EXPECT_LT(steps(10'000) / steps(2000), 7);
}

TEST(bounded_search, of_needles_that_are_searched_twice_each_pair_is_found_once) {
  // Some triangles stand across the needles, near their ends. Faces with few others in their boxes are searched once,
  // and the rest twice.
  TriangleMesh mesh = needles_below_walls(600);
  for (int i = 50; i < 600; i += 2) {
    const double x = 2 * i, y = -0.05 - 1e-5 * i;
    const VertexId a = mesh.positions.push_back({x, y, -1}), b = mesh.positions.push_back({x + 0.5, y, -1});
    mesh.faces.push_back({a, b, mesh.positions.push_back({x, y, 1})});
  }
  const FacePairs expected = all_pairs(mesh);
  EXPECT_GT(expected.size(), 100u);
  SearchLimits limits(expected.size());
  const SelfIntersections found = find(mesh, limits);
  EXPECT_TRUE(found.is_complete);
  EXPECT_EQ(found.pairs, expected);
}

}  // namespace
}  // namespace remesh
