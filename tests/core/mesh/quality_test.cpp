#include "core/mesh/quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/mending/polygons/polygon_split.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

Quality quality_of(const std::vector<Vec3>& positions, const std::vector<std::vector<std::uint32_t>>& faces) {
  RunControl control;
  return measure_surface(shapes::triangles(shapes::from_lists(positions, faces)), control).quality;
}

MeshStatistics statistics_of(const PolygonMesh& mesh) {
  RunControl control;
  const Adjacency edges(mesh.vertex_count(), mesh.face_begin, mesh.corners, control);
  std::vector<VertexId> triangles;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    if (face.size() == 3) {
      triangles.insert(triangles.end(), face.begin(), face.end());
      continue;
    }
    std::vector<Vec3> points;
    for (const VertexId v : face) points.push_back(mesh.positions[v]);
    for (const auto& [a, b, c] : split_polygon(points, 0, control).triangles)
      triangles.insert(triangles.end(), {face[a], face[b], face[c]});
  }
  return measure_surface(mesh.positions.items(), mesh.face_begin, mesh.corners, edges, triangles, control);
}

std::uint64_t total(const Histogram& histogram) {
  return std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::uint64_t{0});
}

TEST(quality, the_equilateral_triangle_has_the_ideal_values) {
  const Quality q = quality_of({{0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0), 0}}, {{0, 1, 2}});
  EXPECT_NEAR(q.min_angle_deg, 60, 1e-12);
  EXPECT_NEAR(q.max_angle_deg, 60, 1e-12);
  EXPECT_NEAR(q.radius_edge_ratio.mean, 1 / std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(q.aspect_ratio.mean, 1, 1e-14);
  EXPECT_NEAR(q.edge_length.mean, 2, 1e-14);
  EXPECT_NEAR(q.area.mean, std::sqrt(3.0), 1e-14);
}

TEST(quality, the_right_isosceles_triangle_has_known_values) {
  const Quality q = quality_of({{0, 0, 5}, {3, 0, 5}, {0, 3, 5}}, {{0, 1, 2}});
  EXPECT_NEAR(q.min_angle_deg, 45, 1e-12);
  EXPECT_NEAR(q.max_angle_deg, 90, 1e-12);
  EXPECT_NEAR(q.radius_edge_ratio.max, 1 / std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(q.aspect_ratio.max, std::sqrt(2.0) * (2 + std::sqrt(2.0)) / (2 * std::sqrt(3.0)), 1e-14);
  EXPECT_EQ(q.edge_length.min, 3);
  EXPECT_NEAR(q.edge_length.max, 3 * std::sqrt(2.0), 1e-14);
  EXPECT_EQ(q.area.min, 4.5);
}

TEST(quality, a_needle_keeps_its_small_angle_exact) {
  const double h = 1e-9;
  const Quality q = quality_of({{0, 0, 0}, {1, 0, 0}, {1, h, 0}}, {{0, 1, 2}});
  EXPECT_NEAR(q.min_angle_deg * std::numbers::pi / 180 / h, 1, 1e-12);
  EXPECT_NEAR(q.radius_edge_ratio.max * 2 * h, 1, 1e-12);  // R / h, R = half the hypotenuse
  EXPECT_NEAR(q.area.max / h, 0.5, 1e-12);
}

TEST(quality, zero_area_triangles_count_with_angle_0_and_spoil_no_ratio) {
  const Quality q = quality_of({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 1, 3}});
  EXPECT_EQ(q.min_angle_deg, 0);
  EXPECT_EQ(q.max_angle_deg, 180);
  EXPECT_NEAR(q.radius_edge_ratio.max, 1 / std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(q.aspect_ratio.max, 1, 1e-14);
  EXPECT_EQ(q.area.min, 0);
  EXPECT_EQ(total(q.angle_histogram_deg), 6u);
  EXPECT_EQ(total(q.radius_edge_histogram), 1u);
}

TEST(quality, an_edge_of_several_triangles_counts_once) {
  // The diagonal of the square is shared: 4 sides of 1 and one of sqrt(2).
  RunControl control;
  const Quality q = measure_surface(shapes::triangles(shapes::sheet(1, 1, 1, 1)), control).quality;
  EXPECT_NEAR(q.edge_length.mean, (4 + std::sqrt(2.0)) / 5, 1e-15);
}

TEST(quality, extreme_scales_give_the_same_ratios) {
  const auto mesh = shapes::triangles(shapes::box({3, 2, 1}, 2));
  RunControl control;
  const Quality expected = measure_surface(mesh, control).quality;
  for (const int exponent : {1020, 500, -500, -1015}) {
    auto scaled = mesh;
    for (Vec3& p : scaled.positions) p = std::ldexp(1.0, exponent) * p;
    const MeshStatistics s = measure_surface(scaled, control);
    EXPECT_EQ(s.quality.min_angle_deg, expected.min_angle_deg) << exponent;
    EXPECT_EQ(s.quality.aspect_ratio.mean, expected.aspect_ratio.mean) << exponent;
    EXPECT_EQ(s.quality.radius_edge_ratio.max, expected.radius_edge_ratio.max) << exponent;
    EXPECT_EQ(s.quality.edge_length.mean, std::ldexp(expected.edge_length.mean, exponent)) << exponent;
    EXPECT_TRUE(std::isfinite(s.area) && std::isfinite(*s.volume) && std::isfinite(s.quality.area.mean)) << exponent;
  }
}

TEST(quality, a_tiny_triangle_in_a_large_mesh_keeps_its_shape) {
  const double t = 1e-200;
  const Quality q = quality_of({{0, 0, 0}, {t, 0, 0}, {0, t, 0}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_NEAR(q.min_angle_deg, 45, 1e-12);
  EXPECT_NEAR(q.radius_edge_ratio.max, 1 / std::sqrt(2.0), 1e-14);
}

TEST(quality, a_tiny_edge_between_large_triangles_keeps_its_length) {
  for (const double t : {1e-150, 1e-158, 1e-161, 1e-170, 1e-300}) {
    const std::vector<Vec3> corners{{0, 0, 0}, {t, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    EXPECT_EQ(quality_of(corners, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}).edge_length.min, t) << "closed";
    EXPECT_EQ(quality_of(corners, {{0, 2, 1}, {0, 3, 2}, {1, 2, 3}}).edge_length.min, t) << "open there";
  }
}

TEST(quality, agrees_with_a_plain_computation_on_random_triangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-10, 10);
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    for (int k = 0; k < 3; ++k) positions.push_back({coordinate(random), coordinate(random), coordinate(random)});
    faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Quality q = quality_of(positions, faces);

  // Law of cosines and Heron, in long doubles: another way to the same numbers.
  long double min_angle = 180, max_angle = 0, ratio_sum = 0, aspect_sum = 0, area_sum = 0, length_sum = 0;
  std::vector<std::uint64_t> angle_counts(18, 0);
  for (const auto& face : faces) {
    long double l[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = positions[face[(k + 1) % 3]] - positions[face[(k + 2) % 3]];
      l[k] = std::sqrt(static_cast<long double>(d.x) * d.x + static_cast<long double>(d.y) * d.y +
                       static_cast<long double>(d.z) * d.z);
      length_sum += l[k];
    }
    const long double s = (l[0] + l[1] + l[2]) / 2;
    const long double area = std::sqrt(s * (s - l[0]) * (s - l[1]) * (s - l[2]));
    for (int k = 0; k < 3; ++k) {
      const long double a = l[(k + 1) % 3], b = l[(k + 2) % 3];
      const long double angle =
          std::acos((a * a + b * b - l[k] * l[k]) / (2 * a * b)) * 180 / static_cast<long double>(std::numbers::pi);
      min_angle = std::min(min_angle, angle);
      max_angle = std::max(max_angle, angle);
      ++angle_counts[static_cast<std::size_t>(angle / 10)];
    }
    ratio_sum += l[0] * l[1] * l[2] / (4 * area) / std::min({l[0], l[1], l[2]});
    aspect_sum += std::max({l[0], l[1], l[2]}) * 2 * s / (4 * std::sqrt(3.0L) * area);
    area_sum += area;
  }
  const auto n = static_cast<long double>(faces.size());
  EXPECT_NEAR(q.min_angle_deg, static_cast<double>(min_angle), 1e-9);
  EXPECT_NEAR(q.max_angle_deg, static_cast<double>(max_angle), 1e-9);
  EXPECT_NEAR(q.radius_edge_ratio.mean / static_cast<double>(ratio_sum / n), 1, 1e-9);
  EXPECT_NEAR(q.aspect_ratio.mean / static_cast<double>(aspect_sum / n), 1, 1e-9);
  EXPECT_NEAR(q.area.mean / static_cast<double>(area_sum / n), 1, 1e-12);
  EXPECT_NEAR(q.edge_length.mean / static_cast<double>(length_sum / (3 * n)), 1, 1e-12);
  EXPECT_EQ(q.angle_histogram_deg.counts, angle_counts);
  EXPECT_EQ(total(q.radius_edge_histogram), faces.size());
}

/// Returns the angles of triangles in degrees, each computed by an arc tangent.
std::vector<double> plain_angles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Triangle& t : mesh.faces)
    for (int i = 0; i < 3; ++i) {
      const Vec3 at = mesh.positions[t[i]];
      const Vec3 to = mesh.positions[t[(i + 1) % 3]] - at, other = mesh.positions[t[(i + 2) % 3]] - at;
      angles.push_back(std::atan2(std::sqrt(norm_squared(cross(to, other))), dot(to, other)) * 180 / std::numbers::pi);
    }
  return angles;
}

TEST(quality, angles_of_lattice_triangles_are_in_the_bins_of_their_arc_tangents) {
  // All of a lattice of 4 x 4 x 2 points: right angles and halves of them, at many lengths, and zero areas. None has an
  // angle that is a multiple of 10 degrees but 60, 90 and 120, and of these only 90 is exact in doubles.
  std::vector<Vec3> positions;
  for (int i = 0; i < 32; ++i) positions.push_back({1.0 * (i & 3), 1.0 * (i >> 2 & 3), 1.0 * (i >> 4)});
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t a = 0; a < 32; ++a)
    for (std::uint32_t b = 0; b < 32; ++b)
      for (std::uint32_t c = 0; c < 32; ++c)
        if (a != b && b != c && a != c) faces.push_back({a, b, c});
  const TriangleMesh mesh = shapes::triangles(shapes::from_lists(positions, faces));
  std::vector<std::uint64_t> least(18, 0), most(18, 0);
  for (const double angle : plain_angles(mesh))
    for (int k = 0; k < 18; ++k) {
      const bool is_last = k == 17;
      const double doubt = angle == 90 ? 0 : 1e-9;
      least[k] += angle >= 10 * k + doubt && (is_last || angle < 10 * k + 10 - doubt);
      most[k] += angle >= 10 * k - doubt && (is_last || angle < 10 * k + 10 + doubt);
    }
  const Quality q = quality_of(positions, faces);
  for (int k = 0; k < 18; ++k) {
    EXPECT_GE(q.angle_histogram_deg.counts[k], least[k]) << k;
    EXPECT_LE(q.angle_histogram_deg.counts[k], most[k]) << k;
  }
  EXPECT_EQ(total(q.angle_histogram_deg), 3 * faces.size());
  EXPECT_EQ(q.min_angle_deg, 0);
  EXPECT_EQ(q.max_angle_deg, 180);
}

TEST(quality, the_extreme_angles_are_those_of_their_arc_tangents_to_a_few_last_places) {
  // Needles of all sizes beside each other: cosines tell none of their angles from another.
  for (int needle = 0; needle < 60; ++needle) {
    std::vector<Vec3> positions;
    std::vector<std::vector<std::uint32_t>> faces;
    for (int i = 0; i <= needle; ++i) {
      const double height = std::pow(0.6, i), at = 0.1 + 0.7 * std::fmod(0.37 * i, 1);
      const auto n = static_cast<std::uint32_t>(positions.size());
      for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{at, height, 0}}) positions.push_back(p);
      faces.push_back({n, n + 1, n + 2});
    }
    const auto angles = plain_angles(shapes::triangles(shapes::from_lists(positions, faces)));
    const Quality q = quality_of(positions, faces);
    EXPECT_NEAR(q.min_angle_deg / *std::min_element(angles.begin(), angles.end()), 1, 1e-15 * 8) << needle;
    EXPECT_NEAR(q.max_angle_deg / *std::max_element(angles.begin(), angles.end()), 1, 1e-15 * 8) << needle;
  }
}

STAGE(quality, test::kWorkers, test::kStop) {
  const auto mesh = shapes::triangles(shapes::rotated(shapes::noisy_sheet(60, 3), {1, 2, 3}, 40));
  const MeshStatistics s = measure_surface(mesh, trial.control);
  trial.in_order(s.area, s.quality.area.mean, s.quality.aspect_ratio.mean, s.quality.edge_length.mean,
                 s.quality.radius_edge_ratio.mean);
}

TEST(measure_surface, a_box_has_its_area_volume_and_topology) {
  for (const auto& mesh : {shapes::box({3, 2, 1}, 4), shapes::quad_box({3, 2, 1}, 4)}) {
    const MeshStatistics s = statistics_of(mesh);
    EXPECT_EQ(s.vertices, mesh.vertex_count());
    EXPECT_EQ(s.faces, mesh.face_count());
    EXPECT_TRUE(s.closed);
    EXPECT_EQ(s.euler, 2);
    EXPECT_EQ(s.components, 1u);
    EXPECT_EQ(s.boundary_edges, 0u);
    EXPECT_EQ(s.non_manifold_edges, 0u);
    EXPECT_NEAR(s.area, 22, 1e-13);
    EXPECT_NEAR(s.volume.value(), 6, 1e-13);
    EXPECT_EQ(s.bounding_box.max, (Vec3{3, 2, 1}));
  }
}

TEST(measure_surface, the_ring_of_the_specification_has_area_28_exactly) {
  for (const int cuts : {1, 4}) {
    const MeshStatistics s = statistics_of(shapes::ring(cuts));
    EXPECT_EQ(s.area, 28);
    EXPECT_EQ(s.euler, 0);
    EXPECT_FALSE(s.closed);
    EXPECT_FALSE(s.volume.has_value());
    EXPECT_EQ(s.boundary_edges, 8u * static_cast<unsigned>(cuts));
  }
}

TEST(measure_surface, a_body_far_away_keeps_its_volume) {
  const MeshStatistics s = statistics_of(shapes::moved(shapes::box({1, 1, 1}), {1048576, -1048576, 524288}));
  EXPECT_NEAR(s.volume.value(), 1, 1e-9);
}

TEST(measure_surface, an_inside_out_body_has_negative_volume) {
  EXPECT_NEAR(statistics_of(shapes::turned_over(shapes::box({1, 1, 1}))).volume.value(), -1, 1e-15);
}

TEST(measure_surface, a_body_with_one_face_turned_is_closed_without_volume) {
  PolygonMesh mesh = shapes::box({1, 1, 1});
  std::swap(mesh.corners[0], mesh.corners[1]);
  const MeshStatistics s = statistics_of(mesh);
  EXPECT_TRUE(s.closed);
  EXPECT_FALSE(s.volume.has_value());
}

TEST(measure_surface, three_pages_share_one_non_manifold_edge) {
  const MeshStatistics s = statistics_of(shapes::three_pages());
  EXPECT_EQ(s.non_manifold_edges, 1u);
  EXPECT_EQ(s.boundary_edges, 9u);
  EXPECT_FALSE(s.closed);
}

TEST(measure_surface, parts_that_share_a_vertex_are_one_component) {
  EXPECT_EQ(statistics_of(shapes::two_squares_touching_at_a_vertex()).components, 1u);
  EXPECT_EQ(statistics_of(shapes::joined(shapes::box({1, 1, 1}), shapes::box({1, 1, 1}))).components, 2u);
}

TEST(measure_surface, unused_vertices_count_nowhere) {
  PolygonMesh mesh = shapes::sheet(1, 1, 1, 1);
  mesh.positions.push_back({100, 100, 100});
  const MeshStatistics s = statistics_of(mesh);
  EXPECT_EQ(s.vertices, 4u);
  EXPECT_EQ(s.euler, 1);
  EXPECT_EQ(s.bounding_box.max, (Vec3{1, 1, 0}));
}

TEST(measure_surface, a_polygon_without_a_plane_has_the_area_and_the_volume_of_its_triangles) {
  // A box with one corner pulled up by a half: its top is taken for the two triangles of one diagonal or the other.
  PolygonMesh mesh = shapes::box({1, 1, 1});
  for (Vec3& p : mesh.positions)
    if (p == Vec3{1, 1, 1}) p.z = 1.5;
  const MeshStatistics s = statistics_of(mesh);
  const double through_it = 1 + 0.5 / 3, beside_it = 1 + 0.5 / 6;
  EXPECT_NEAR(std::min(std::fabs(*s.volume - through_it), std::fabs(*s.volume - beside_it)), 0, 1e-15);
  const double half = std::sqrt(1.25) / 2, raised = std::sqrt(1.5) / 2;
  const double top = std::fabs(*s.volume - through_it) < 1e-9 ? 2 * half : 0.5 + raised;
  EXPECT_NEAR(s.area, 3 + 2 * 1.25 + top, 1e-14);
}

TEST(measure_surface, concave_polygons_have_their_own_area) {
  const MeshStatistics s = statistics_of(shapes::prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1));
  EXPECT_EQ(s.area, 2 * 3 + 8);
  EXPECT_NEAR(s.volume.value(), 3, 1e-15);
  EXPECT_EQ(s.euler, 2);
}

TEST(measure_surface, an_empty_surface_is_all_zero) {
  const MeshStatistics s = statistics_of(PolygonMesh{});
  EXPECT_EQ(s.vertices, 0u);
  EXPECT_EQ(s.area, 0);
  EXPECT_FALSE(s.closed);
}

}  // namespace
}  // namespace remesh
