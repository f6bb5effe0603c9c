#include "core/mending/edges/t_junctions.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

struct SplitResult {
  Surface surface;
  std::vector<Diagnostic> diagnostics;
  bool is_changed = false;
};

SplitResult split(const PolygonMesh& mesh, double tolerance, MendMode mend = MendMode::kYes,
                  const std::vector<std::uint8_t>& keep_verbatim = {}) {
  RunControl control;
  SplitResult result{shapes::surface(mesh), {}, false};
  const Adjacency edges(result.surface.vertex_count(), result.surface.face_begin, result.surface.corners, control);
  result.is_changed = split_t_junctions(result.surface, edges, tolerance / result.surface.unit, keep_verbatim, mend,
                                        result.diagnostics, control);
  return result;
}

std::size_t open_edges(const Surface& surface) {
  RunControl control;
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  std::size_t count = 0;
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) count += edges.half_edges(EdgeId(e)).size() == 1;
  return count;
}

std::vector<VertexId> loop_of(const Surface& surface, std::size_t f) {
  const auto loop = surface.face(FaceId(f));
  return {loop.begin(), loop.end()};
}

/// Makes a large triangle below y = 0 along x, and `n` small ones above, whose corners lie on its edge, raised by
/// `off`.
PolygonMesh comb(int n, double off = 0) {
  std::vector<Vec3> points{{0, 0, 0}, {0.5, -1, 0}, {1, 0, 0}};
  std::vector<std::vector<std::uint32_t>> faces{{0, 1, 2}};
  std::vector<std::uint32_t> base{0};
  for (int i = 1; i < n; ++i) {
    base.push_back(static_cast<std::uint32_t>(points.size()));
    points.push_back({static_cast<double>(i) / n, off, 0});
  }
  base.push_back(2);
  for (int i = 0; i < n; ++i) {
    points.push_back({(i + 0.5) / n, 1, 0});
    faces.push_back({base[i], base[i + 1], static_cast<std::uint32_t>(points.size() - 1)});
  }
  return shapes::from_lists(points, faces);
}

TEST(split_t_junctions, vertices_on_an_open_edge_come_into_its_face_in_order) {
  const PolygonMesh mesh = comb(4);
  EXPECT_EQ(open_edges(shapes::surface(mesh)), 3u + 3 * 4);
  const SplitResult result = split(mesh, 1e-9);
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(open_edges(result.surface), 2u + 2 * 4);
  EXPECT_EQ(loop_of(result.surface, 0),
            (std::vector<VertexId>{VertexId(0), VertexId(1), VertexId(2), VertexId(5), VertexId(4), VertexId(3)}));
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].code, DiagnosticCode::kTJunction);
  EXPECT_EQ(result.diagnostics[0].count, 3u);
  EXPECT_EQ(result.diagnostics[0].elements, (std::vector<std::uint64_t>{3, 4, 5}));
}

TEST(split_t_junctions, only_vertices_within_the_tolerance_do) {
  EXPECT_TRUE(split(comb(3, 1e-4), 2e-4).is_changed);
  EXPECT_TRUE(split(comb(3, -1e-4), 2e-4).is_changed);
  EXPECT_FALSE(split(comb(3, 1e-4), 0.5e-4).is_changed);
}

TEST(split_t_junctions, a_vertex_near_the_end_of_an_edge_is_a_matter_of_welding) {
  const PolygonMesh mesh = shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.001, 0, 0}, {0.5, -1, 0}, {0, -1, 0}}, {{0, 1, 2}, {3, 5, 4}});
  EXPECT_FALSE(split(mesh, 0.01).is_changed);
  EXPECT_TRUE(split(mesh, 0.0001).is_changed);
}

TEST(split_t_junctions, where_nothing_is_to_be_mended_or_a_face_takes_none_it_stays) {
  const SplitResult found = split(comb(4), 1e-9, MendMode::kNo);
  EXPECT_FALSE(found.is_changed);
  ASSERT_EQ(found.diagnostics.size(), 1u);
  EXPECT_EQ(found.diagnostics[0].count, 3u);
  EXPECT_EQ(loop_of(found.surface, 0).size(), 3u);
  EXPECT_FALSE(split(comb(4), 1e-9, MendMode::kYes, {1, 0, 0, 0, 0}).is_changed);
}

TEST(split_t_junctions, a_closed_surface_and_inner_vertices_are_left_alone) {
  EXPECT_FALSE(split(shapes::box({1, 1, 1}, 3), 0.1).is_changed);
  // A fin that stands on the inner edges of a plate: not the plate's boundary.
  PolygonMesh mesh = shapes::welded(
      shapes::joined(shapes::sheet(4, 4, 4, 4), shapes::from_lists({{1, 2, 0}, {3, 2, 0}, {2, 2, 1}}, {{0, 1, 2}})));
  EXPECT_FALSE(split(mesh, 1e-9).is_changed);
}

/// Makes a wedge along x whose sides are `width` apart at its end, and a triangle that touches its middle line there.
PolygonMesh wedge_and_tip(double width, double at) {
  return shapes::from_lists(
      {{0, 0, 0}, {1, -width / 2, 0}, {1, width / 2, 0}, {at, 0, 0.0001}, {0.5, 0, 1}, {0.6, 0, 1}},
      {{0, 1, 2}, {3, 4, 5}});
}

TEST(split_t_junctions, a_vertex_near_two_edges_of_a_face_is_handed_to_it_once) {
  const SplitResult result = split(wedge_and_tip(0.06, 0.2), 0.01);
  EXPECT_TRUE(result.is_changed);
  EXPECT_EQ(loop_of(result.surface, 0).size(), 4u);
}

TEST(split_t_junctions, a_face_that_is_as_thin_as_the_tolerance_is_handed_none) {
  EXPECT_FALSE(split(wedge_and_tip(0.01, 0.5), 0.01).is_changed);
}

/// Returns the number of edges with two half-edges that run the same way.
std::size_t edges_used_twice_one_way(const Surface& surface) {
  RunControl control;
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  std::size_t count = 0;
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
    const auto around = edges.half_edges(EdgeId(e));
    count += around.size() == 2 && edges.from(around[0]) == edges.from(around[1]);
  }
  return count;
}

/// Makes two plates on both sides of a line through the origin, which is the only corner that they share. Their edges
/// run along each other and end a tenth of the noise apart. On the line stand two fins, whose corners are up to `noise`
/// apart.
PolygonMesh plates_and_fins(const Vec3& along, const Vec3& across, double noise, std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  const auto about = [&](const Vec3& p, double size) { return p + size * Vec3{any(random), any(random), any(random)}; };
  const Vec3 up = cross(along, across);
  std::vector<Vec3> points{{0, 0, 0},       about(along, noise / 10),  about(along, noise / 10),  along + across,
                           along - across,  about(0.4 * along, noise), about(0.4 * along, noise), 0.3 * along + up,
                           0.5 * along + up};
  return shapes::welded(shapes::from_lists(points, {{0, 1, 3}, {2, 0, 4}, {5, 7, 8}, {6, 8, 7}}));
}

TEST(split_t_junctions, edges_that_run_along_each_other_take_near_vertices_in_the_same_order) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> any;
  const auto expect_two_sides = [&](const Vec3& along, const Vec3& across, double noise) {
    const PolygonMesh mesh = plates_and_fins(along, across, noise, random);
    ASSERT_EQ(edges_used_twice_one_way(shapes::surface(mesh)), 0u);
    const SplitResult result = split(mesh, 1e-6);
    EXPECT_EQ(edges_used_twice_one_way(result.surface), 0u) << noise;
    if (mesh.vertex_count() < 9) return;  // the noise is too small for some places
    EXPECT_EQ(loop_of(result.surface, 0).size() + loop_of(result.surface, 1).size(), 10u);
  };
  for (int i = 0; i < 300; ++i) {
    const double noise = std::pow(10, -8 - i % 10);
    expect_two_sides({1, 0, 0}, {0, 1, 0}, noise);
    const Vec3 along = (1 / std::sqrt(3)) * Vec3{any(random), any(random), any(random)};
    const Vec3 across = cross(along, {any(random), any(random), any(random)});
    expect_two_sides(along, (1 / norm(across)) * across, noise);
  }
}

TEST(split_t_junctions, corners_on_both_sides_of_a_seam_do_not_twist_it) {
  // As a mixer's blades meet its shaft, where the sine of a full turn was not quite 0.
  const PolygonMesh mesh = shapes::from_lists({{0.04, 0, 0.08},
                                               {0.0393923, -0.00694593, 0.08},
                                               {0.04, 0, 0.09},
                                               {0.0393923, 0.00694593, 0.09},
                                               {0.04, 9.79717e-18, 0.08},
                                               {0.04, 9.79717e-18, 0.09},
                                               {0, 0, 0.08},
                                               {0.1, 0, 0.08},
                                               {0, 0.1, 0.08},
                                               {-0.1, 0, 0.08},
                                               {0, -0.1, 0.08},
                                               {0.1, -2.44929e-17, 0.08}},
                                              {{1, 0, 2}, {5, 4, 3}, {6, 7, 8}, {6, 8, 9}, {6, 9, 10}, {6, 10, 11}});
  const SplitResult result = split(mesh, 2e-7);
  EXPECT_EQ(result.diagnostics.at(0).count, 4u);
  EXPECT_EQ(edges_used_twice_one_way(result.surface), 0u);
  EXPECT_EQ(open_edges(result.surface), 12u);
}

TEST(split_t_junctions, a_vertex_that_would_twist_the_surface_is_left_where_it_is) {
  // A band of seven squares whose ends meet after half a turn, given with a vertex more on one of them.
  constexpr int kSquares = 7;
  std::vector<Vec3> points;
  for (int i = 0; i <= kSquares; ++i) {
    const double around = 2 * M_PI * i / kSquares, turn = around / 2;
    for (const double side : {-0.3, 0.3})
      points.push_back({(1 + side * std::cos(turn)) * std::cos(around), (1 + side * std::cos(turn)) * std::sin(around),
                        side * std::sin(turn)});
  }
  points[2 * kSquares] = points[1];
  points[2 * kSquares + 1] = points[0];
  points.push_back(0.5 * points[0] + 0.5 * points[1]);
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < kSquares; ++i) faces.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  faces.back() = {2 * kSquares - 2, 2 * kSquares, 2 * kSquares + 2, 2 * kSquares + 1, 2 * kSquares - 1};
  const PolygonMesh mesh = shapes::welded(shapes::from_lists(points, faces));
  const SplitResult result = split(mesh, 1e-6);
  EXPECT_FALSE(result.is_changed);
  ASSERT_EQ(result.diagnostics.size(), 1u);
  EXPECT_EQ(result.diagnostics[0].count, 1u);
  EXPECT_NE(result.diagnostics[0].message.find("twist"), std::string::npos);
}

TEST(split_t_junctions, faces_that_look_the_wrong_way_are_joined_all_the_same) {
  PolygonMesh mesh = comb(4);
  std::reverse(mesh.corners.begin(), mesh.corners.begin() + 3);
  const SplitResult result = split(mesh, 1e-9);
  EXPECT_EQ(open_edges(result.surface), 2u + 2 * 4);
  EXPECT_EQ(edges_used_twice_one_way(result.surface), 4u);
}

TEST(split_t_junctions, very_many_long_edges_side_by_side_do_not_take_quadratic_time) {
  PolygonMesh mesh;
  constexpr int kFaces = 100'000;
  for (int i = 0; i < kFaces; ++i) {
    const double y = 1e-3 * i;
    for (const Vec3& p : {Vec3{0, y, 0}, Vec3{1000, y + 1000, 0}, Vec3{1000, y + 1000, 1e-3}})
      mesh.corners.push_back(mesh.positions.push_back(p));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  EXPECT_FALSE(split(mesh, 1e-6).is_changed);
}

/// Makes `n` large triangles whose edges run along one line, and as many small ones with a corner on it.
PolygonMesh bundle(int n) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), {a, b, c});
    faces.push_back({first, first + 1, first + 2});
  };
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n, end = 1e-3 * i / n;
    add({-1 - end, 0, 0}, {2 + end, 0, 0}, {0.5, std::cos(angle), std::sin(angle)});
    const double at = (i + 1.0) / (n + 1);
    add({at, 0, 0}, {at, -0.1, 0.001}, {at + 0.3 / n, -0.1, 0});
  }
  return shapes::from_lists(points, faces);
}

TEST(split_t_junctions, where_there_are_far_too_many_none_is_split_and_that_is_told) {
  const tbb::global_control more_threads_than_cores(tbb::global_control::max_allowed_parallelism, 8);
  EXPECT_TRUE(split(bundle(20), 1e-9).is_changed);
  const PolygonMesh mesh = bundle(1000);
  const auto diagnostics = tbb::task_arena(1).execute([&] {
    const SplitResult result = split(mesh, 1e-9);
    EXPECT_FALSE(result.is_changed);
    return result.diagnostics;
  });
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].code, DiagnosticCode::kTJunction);
  EXPECT_GT(diagnostics[0].count, mesh.corners.size());
  EXPECT_LT(diagnostics[0].count, 8 * mesh.corners.size());
  EXPECT_NE(diagnostics[0].message.find("so many"), std::string::npos);
  for (const MendMode mend : {MendMode::kYes, MendMode::kNo}) {
    const SplitResult result = tbb::task_arena(8).execute([&] { return split(mesh, 1e-9, mend); });
    ASSERT_EQ(result.diagnostics.size(), 1u);
    EXPECT_EQ(result.diagnostics[0].count, diagnostics[0].count);
    EXPECT_EQ(result.diagnostics[0].elements, diagnostics[0].elements);
  }
}

TEST(split_t_junctions, edges_along_each_other_with_all_vertices_on_them_do_not_take_quadratic_time) {
  EXPECT_FALSE(split(bundle(50'000), 1e-9).is_changed);  // 5e9 junctions
}

/// Makes squares above each other. Each is nearer to the first one than the one before, always by the same factor.
PolygonMesh nearing_sheets(int n, double last) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i < n; ++i) {
    const double z = std::pow(last, static_cast<double>(i) / n);
    const auto first = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), {{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}});
    faces.push_back({first, first + 1, first + 2, first + 3});
  }
  return shapes::from_lists(points, faces);
}

/// Returns the number of pairs of a face and a vertex on one of its edges. It looks at all pairs.
std::size_t junctions_of_all_pairs(const PolygonMesh& mesh, double tolerance) {
  std::set<std::pair<std::size_t, std::uint32_t>> found;
  for (std::size_t f = 0; f + 1 < mesh.face_begin.size(); ++f)
    for (std::uint32_t h = mesh.face_begin[f]; h < mesh.face_begin[f + 1]; ++h) {
      const std::uint32_t next = h + 1 == mesh.face_begin[f + 1] ? mesh.face_begin[f] : h + 1;
      const Vec3 a = mesh.positions[mesh.corners[h]], b = mesh.positions[mesh.corners[next]];
      for (const VertexId v : mesh.corners) {
        const Vec3 p = mesh.positions[v];
        const double along = dot(p - a, b - a) / norm_squared(b - a);
        const auto loop =
            std::span(mesh.corners).subspan(mesh.face_begin[f], mesh.face_begin[f + 1] - mesh.face_begin[f]);
        if (along > 0 && along < 1 && norm(p - (a + along * (b - a))) <= tolerance && norm(p - a) > tolerance &&
            norm(p - b) > tolerance && std::find(loop.begin(), loop.end(), v) == loop.end())
          found.insert({f, v.value});
      }
    }
  return found.size();
}

TEST(split_t_junctions, those_found_are_those_of_all_pairs) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::size_t total = 0;
  for (int i = 0; i < 60; ++i) {
    PolygonMesh mesh = i % 3 == 0 ? bundle(10) : i % 3 == 1 ? nearing_sheets(30, 1e-6) : comb(12);
    const double tolerance = std::pow(10, -3 - i % 4);
    for (Vec3& p : mesh.positions) p += 2 * tolerance * Vec3{any(random), any(random), any(random)};
    if (i % 2 == 0) mesh = shapes::rotated(mesh, {any(random), 1, any(random)}, 180 * any(random));
    const SplitResult result = split(mesh, tolerance, MendMode::kNo);
    const std::size_t count = result.diagnostics.empty() ? 0 : result.diagnostics[0].count;
    EXPECT_EQ(count, junctions_of_all_pairs(mesh, tolerance)) << i;
    total += count;
  }
  EXPECT_GT(total, 1000u);
}

TEST(split_t_junctions, very_many_vertices_near_the_ends_of_as_many_edges_do_not_take_quadratic_time) {
  EXPECT_FALSE(split(nearing_sheets(60'000, 1e-12), 1e-9).is_changed);
}

}  // namespace
}  // namespace remesh
