#include "core/mending/edges/seams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/mending/weld/weld.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"
#include "tests/support/torn.h"

namespace remesh {
namespace {

constexpr double kSeamTolerance = 1e-9;

struct Closed {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

Closed close(const PolygonMesh& mesh, MendMode mend = MendMode::kYes, double tolerance = kSeamTolerance,
             bool takes_alike = false) {
  RunControl control;
  std::vector<Diagnostic> of_weld;
  Closed result{weld(mesh, {}, of_weld, control), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners, control);
  Seams seams({tolerance / result.surface.unit, takes_alike});
  result.is_changed = seams.close(result.surface, edges, mend, control);
  seams.report(result.diagnostics);
  result.surface.detach();  // the mesh may be gone when it is looked at
  return result;
}

/// Counts the edges by the number of their faces. A face with two equal corners in a row has no edge between these.
std::map<std::size_t, int> faces_at_edges(const Surface& surface) {
  std::map<std::pair<VertexId, VertexId>, std::size_t> uses;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i)
      if (const VertexId a = loop[i], b = loop[(i + 1) % loop.size()]; a != b) ++uses[std::minmax(a, b)];
  }
  std::map<std::size_t, int> counts;
  for (const auto& [edge, n] : uses) ++counts[n];
  return counts;
}

bool is_closed(const Surface& surface) {
  const auto counts = faces_at_edges(surface);
  return counts.size() == 1 && counts.begin()->first == 2;
}

std::uint64_t count_of(const Closed& result) {
  return result.diagnostics.empty() ? 0 : result.diagnostics.front().count;
}

/// Expects that every vertex is used, and that every corner is within the tolerance of where it was.
void expect_in_place(const PolygonMesh& before, const Surface& after, double tolerance = kSeamTolerance) {
  ASSERT_EQ(after.corners.size(), before.corners.size());
  std::vector<int> uses(after.vertex_count());
  for (std::size_t c = 0; c < before.corners.size(); ++c) {
    const VertexId v = after.corners[c];
    ++uses[v.value];
    EXPECT_LE(norm(after.positions[v] - before.positions[before.corners[c]]), tolerance * (1 + 1e-6));
    EXPECT_EQ(after.local[v], after.to_local(after.positions[v]));
  }
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 0), 0);
}

TEST(seams, both_sides_of_a_torn_solid_become_one_again) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const PolygonMesh& whole :
         {shapes::sphere(3), shapes::box({1, 2, 3}, 4), shapes::quad_box({2, 1, 1}, 3), shapes::l_bracket(3)}) {
      const PolygonMesh mesh = torn::in_two(whole, torn::above_a_plane(seed), torn::noise(seed, kSeamTolerance / 4));
      const Closed result = close(mesh);
      EXPECT_TRUE(is_closed(result.surface));
      EXPECT_EQ(result.surface.vertex_count(), whole.vertex_count());
      EXPECT_EQ(count_of(result), torn::edges_between(whole, torn::above_a_plane(seed)));
      ASSERT_EQ(result.diagnostics.size(), 1u);
      EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kSeam);
      expect_in_place(mesh, result.surface);
    }
}

TEST(seams, facets_that_were_all_computed_by_themselves_become_one_solid) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh whole = shapes::sphere(2);
    const PolygonMesh mesh = torn::into_facets(whole, torn::noise(seed, kSeamTolerance / 8));
    const Closed result = close(mesh);
    EXPECT_TRUE(is_closed(result.surface));
    EXPECT_EQ(result.surface.vertex_count(), whole.vertex_count());
    expect_in_place(mesh, result.surface);
  }
}

TEST(seams, a_crack_wider_than_the_tolerance_stays) {
  const PolygonMesh mesh = torn::in_two(shapes::sphere(2), torn::above_a_plane(1), [](const Vec3& p) {
    return p + Vec3{0, 0, 2e-9};
  });
  const Closed result = close(mesh);
  EXPECT_FALSE(result.is_changed);
  EXPECT_TRUE(result.diagnostics.empty());
}

TEST(seams, it_is_told_and_left_if_it_is_not_to_be_mended) {
  const PolygonMesh whole = shapes::sphere(2);
  const PolygonMesh mesh = torn::in_two(whole, torn::above_a_plane(1), torn::noise(1, kSeamTolerance / 4));
  const Closed result = close(mesh, MendMode::kNo);
  EXPECT_FALSE(result.is_changed);
  EXPECT_EQ(result.surface.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(count_of(result), torn::edges_between(whole, torn::above_a_plane(1)));
}

STAGE(seams, test::kNumbering) {
  const Closed closed = close(trial.of(torn::into_facets(shapes::sphere(2), torn::noise(3, kSeamTolerance / 3))));
  for (const Vec3& p : closed.surface.positions) trial.piece(p);
  trial.same(count_of(closed));
}

TEST(seams, two_sheets_on_each_other_stay_two) {
  const PolygonMesh sheet = shapes::sheet(3, 2, 3, 2);
  for (const PolygonMesh& other : {shapes::turned_over(sheet), sheet}) {
    const Closed result = close(shapes::joined(sheet, shapes::moved(other, {0, 0, 0.5e-9})));
    EXPECT_FALSE(result.is_changed);
    EXPECT_EQ(result.surface.vertex_count(), 2 * sheet.vertex_count());
  }
}

TEST(seams, two_open_boxes_side_by_side_stay_two) {
  // The boxes have no lids, and a wall of one lies on a wall of the other.
  PolygonMesh box = shapes::quad_box({1, 1, 1}, 2);
  const PolygonMesh open = torn::only(box, [&](FaceId f) {
    const auto loop = box.face(f);
    return std::any_of(loop.begin(), loop.end(), [&](VertexId v) { return box.positions[v].z < 1; });
  });
  const Closed result = close(shapes::joined(open, shapes::moved(open, {1 + 0.5e-9, 0, 0})));
  EXPECT_FALSE(result.is_changed);
}

TEST(seams, boxes_whose_mouths_meet_become_one) {
  PolygonMesh box = shapes::quad_box({1, 1, 1}, 2);
  const auto half = [&](double z) {
    return torn::only(box, [&](FaceId f) {
      const auto loop = box.face(f);
      return std::any_of(loop.begin(), loop.end(), [&](VertexId v) { return box.positions[v].z != z; });
    });
  };
  const Closed result = close(shapes::joined(half(1), shapes::moved(half(0), {0, 0, 1 + 0.5e-9})));
  EXPECT_TRUE(is_closed(result.surface));
}

TEST(seams, pages_of_a_book_that_lie_beside_each_other_are_not_joined_in_pairs) {
  // Three sheets whose edges are one to rounding: two of them would be as good as any other two.
  const Vec3 a{0, 0, 0}, b{0, 0, 1};
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3, off = i * 1e-10;
    points.insert(points.end(), {a + Vec3{off, 0, 0}, b + Vec3{off, 0, 0}, {std::cos(angle), std::sin(angle), 0.5}});
    faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    if (i % 2 == 1) std::swap(faces.back()[0], faces.back()[1]);
  }
  EXPECT_FALSE(close(shapes::from_lists(points, faces)).is_changed);
}

TEST(seams, edges_that_run_the_same_way_are_no_partners) {
  const PolygonMesh left = shapes::sheet(1, 1, 1, 1);
  const PolygonMesh right = shapes::moved(shapes::turned_over(shapes::sheet(1, 1, 1, 1)), {1 + 0.5e-9, 0, 0});
  EXPECT_FALSE(close(shapes::joined(left, right)).is_changed);
  EXPECT_TRUE(close(shapes::joined(left, shapes::turned_over(right))).is_changed);
}

TEST(seams, no_face_collapses) {
  // A seam ends at a face that has both its sides for corners, and would become a line.
  const double w = 0.5e-9;
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {-w, 1, 0}, {w, 1, 0}, {-1, 0.5, 0}, {1, 0.5, 0}, {0, 2, 0}},
                                              {{0, 1, 3}, {2, 0, 4}, {1, 2, 5}});
  const Closed result = close(mesh, MendMode::kYes, 2e-9);
  for (std::uint32_t f = 0; f < 3; ++f) {
    const auto loop = result.surface.face(FaceId(f));
    EXPECT_EQ(std::set<VertexId>(loop.begin(), loop.end()).size(), 3u);
  }
}

TEST(seams, a_long_edge_across_the_end_of_a_seam_loses_the_corner_that_is_there_twice) {
  // A polygon below, with both ends of the seam between the two above it on its upper side.
  const double w = 0.25e-9;
  const PolygonMesh mesh = shapes::from_lists({{-1, -1, 0},
                                               {1, -1, 0},
                                               {1, 0, 0},
                                               {w, 0, 0},
                                               {-w, 0, 0},
                                               {-1, 0, 0},
                                               {1, 1, 0},
                                               {w, 1, 0},
                                               {-w, 1, 0},
                                               {-1, 1, 0}},
                                              {{0, 1, 2, 3, 4, 5}, {3, 2, 6, 7}, {5, 4, 8, 9}});
  const Closed result = close(mesh);
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(result.surface.vertex_count(), 8u);
  EXPECT_EQ(faces_at_edges(result.surface), (std::map<std::size_t, int>{{1, 7}, {2, 3}}));
}

TEST(seams, a_chain_of_near_places_does_not_collapse) {
  // A fan of facets, each with an apex of its own, 0.4 tolerances from the next one.
  constexpr int kFacets = 24;
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < kFacets; ++i) {
    const auto rim = [&](std::uint32_t k) {
      const double angle = 2 * std::numbers::pi * k / (2 * kFacets);
      return Vec3{std::cos(angle), std::sin(angle), 0};
    };
    points.insert(points.end(), {{0.4 * kSeamTolerance * i, 0, 0}, rim(i), rim(i + 1)});
    faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const PolygonMesh mesh = shapes::from_lists(points, faces);
  const Closed result = close(mesh);
  EXPECT_TRUE(result.is_changed);
  expect_in_place(mesh, result.surface);
  const auto counts = faces_at_edges(result.surface);
  EXPECT_EQ(counts.rbegin()->first, 2u);
}

TEST(seams, random_facets_with_noise_about_the_tolerance_never_become_what_is_no_surface) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const PolygonMesh whole = seed % 2 == 0 ? shapes::box({1, 1, 1}, 2) : shapes::three_pages(2);
    const auto of_whole = faces_at_edges(shapes::surface(whole));
    const PolygonMesh mesh = torn::into_facets(whole, torn::noise(seed, kSeamTolerance * (0.2 + 0.02 * seed)));
    const Closed result = close(mesh);
    EXPECT_LE(faces_at_edges(result.surface).rbegin()->first, 2u);
    EXPECT_LE(of_whole.begin()->first, 2u);
    expect_in_place(mesh, result.surface);
    std::map<std::pair<VertexId, VertexId>, int> directed;
    for (std::uint32_t f = 0; f < result.surface.face_count(); ++f) {
      const auto loop = result.surface.face(FaceId(f));
      EXPECT_EQ(std::set<VertexId>(loop.begin(), loop.end()).size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(++directed[std::pair(loop[i], loop[(i + 1) % 3])], 1);
    }
  }
}

TEST(seams, open_edges_on_each_other_by_the_thousand_take_no_quadratic_time) {
  // Triangles that all have one edge, each to itself, within the tolerance.
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 30'000; ++i) {
    const double angle = 1e-4 * i, off = 1e-14 * i;
    points.insert(points.end(), {{off, 0, 0}, {off, 0, 1}, {std::cos(angle), std::sin(angle), 0.5}});
    faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  Closed result;
  test::expect_within(test::Seconds(5), [&] { result = close(shapes::from_lists(points, faces)); });
  EXPECT_FALSE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
}

}  // namespace
}  // namespace remesh
