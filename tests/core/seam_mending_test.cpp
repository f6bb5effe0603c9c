// Tests that seams within the rounding of coordinates are closed, from the mesh as it is read to the result.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/torn.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Report report_of(const PolygonMesh& mesh, const Options& options = unrefined()) {
  RunControl control;
  return remesh_surface(mesh, options, {}, control).report;
}

std::uint64_t seams_of(const Report& report) {
  std::uint64_t count = 0;
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kSeam) count += d.count;
  return count;
}

/// Makes a closed cylinder whose last angle is a full turn as computed, so that its sine is not 0. On its outside it
/// has `before` rows of quads along the seam up to the last column, and `after` rows in the first one.
PolygonMesh cylinder_with_a_seam(std::uint32_t sides, std::uint32_t before, std::uint32_t after) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto at = [&](std::uint32_t i, double z) {
    const double angle = 2 * std::numbers::pi * i / sides;
    points.push_back({25 * std::cos(angle), 25 * std::sin(angle), z});
    return static_cast<std::uint32_t>(points.size() - 1);
  };
  for (std::uint32_t i = 0; i < sides; ++i) {
    const bool is_first = i == 0, is_last = i + 1 == sides;
    const std::uint32_t left = is_first ? after : 1, right = is_last ? before : 1;
    std::vector<std::uint32_t> wall;
    for (std::uint32_t k = 0; k <= right; ++k) wall.push_back(at(i + 1, 120.0 * k / right));
    for (std::uint32_t k = left + 1; k-- > 0;) wall.push_back(at(i, 120.0 * k / left));
    faces.push_back(wall);
    points.insert(points.end(), {{0, 0, 0}, {0, 0, 120}});
    const auto middle = static_cast<std::uint32_t>(points.size() - 2);
    const std::uint32_t low = at(i, 0), next_low = at(i + 1, 0), high = at(i, 120), next_high = at(i + 1, 120);
    faces.push_back({middle, next_low, low});
    faces.push_back({middle + 1, high, next_high});
  }
  return shapes::from_lists(points, faces);
}

TEST(seams, a_cylinder_whose_full_turn_misses_its_beginning_by_rounding_is_closed) {
  const Report report = report_of(cylinder_with_a_seam(12, 1, 1));
  EXPECT_FALSE(report.input.closed);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
  // The wall's seam, and on both caps the spoke to it.
  EXPECT_EQ(seams_of(report), 3u);
  const double area = 12 * 25 * 25 * std::sin(2 * std::numbers::pi / 12) / 2;
  EXPECT_NEAR(report.output.volume.value_or(0), 120 * area, 1e-6);
}

TEST(seams, sides_that_are_subdivided_differently_close) {
  for (const auto& [before, after] : {std::pair{1u, 4u}, {3u, 1u}, {3u, 4u}, {4u, 4u}}) {
    const Report report = report_of(cylinder_with_a_seam(12, before, after));
    EXPECT_TRUE(report.output.closed) << before << " " << after;
    EXPECT_TRUE(report.verified.all_true()) << before << " " << after;
  }
}

TEST(seams, they_are_left_open_if_they_are_not_to_be_mended) {
  Options options = unrefined();
  options.repair.seams = false;
  const Report report = report_of(cylinder_with_a_seam(12, 1, 1), options);
  EXPECT_FALSE(report.output.closed);
  EXPECT_EQ(seams_of(report), 3u);
}

TEST(seams, groups_do_not_keep_a_seam_open) {
  PolygonMesh mesh = cylinder_with_a_seam(12, 1, 1);
  mesh.labels.group.names = {"first", "last"};
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) mesh.labels.group.of_face.push_back(f < 18 ? 0 : 1);
  const Report report = report_of(mesh);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
}

TEST(seams, a_tolerance_below_what_rounding_explains_holds_for_seams_as_well) {
  Options options = unrefined();
  options.plane_tolerance = 1e-15;
  EXPECT_FALSE(report_of(cylinder_with_a_seam(12, 1, 1), options).output.closed);
}

TEST(seams, refined_results_are_closed_and_verified) {
  Options options;
  options.max_edge_length = 20;
  const Report report = report_of(cylinder_with_a_seam(12, 3, 4), options);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
}

TEST(seams, a_solid_of_facets_that_were_all_moved_by_rounding_is_closed) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh mesh = torn::into_facets(shapes::box({1, 2, 3}, 3), torn::noise(seed, 1e-15));
    const Report report = report_of(mesh);
    EXPECT_TRUE(report.output.closed);
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_EQ(report.output.faces, 12u);
    EXPECT_NEAR(report.output.volume.value_or(0), 6, 1e-12);
  }
}

/// Properties of a result that are computed from its triangles alone.
struct Body {
  bool is_closed = true;  ///< each edge has as many triangles one way as the other
  double volume = 0;
};

Body body_of(const TriangleMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, int> balance;
  Body body;
  for (const Triangle& t : mesh.faces) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    body.volume += dot(a, cross(b, c)) / 6;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexId from = t[i], to = t[(i + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  body.is_closed = std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
  return body;
}

Body remeshed_body(const PolygonMesh& mesh, const Options& options = unrefined()) {
  RunControl control;
  return body_of(remesh_surface(mesh, options, {}, control).mesh);
}

PolygonMesh narrowed(PolygonMesh mesh, double factor) {
  for (Vec3& p : mesh.positions) p = {factor * p.x, factor * p.y, p.z};
  return mesh;
}

/// Turns faces over at random, one in `every` on average.
PolygonMesh with_turned_faces(PolygonMesh mesh, unsigned seed, unsigned every) {
  std::mt19937 random(seed);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (random() % every == 0)
      std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
  return mesh;
}

/// Returns the mesh itself, and the same mesh in other numberings, each both in place and turned about some axis.
std::vector<PolygonMesh> in_many_ways(const PolygonMesh& mesh) {
  std::vector<PolygonMesh> all{mesh};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    all.push_back(shapes::renumbered(mesh, seed));
    all.push_back(shapes::rotated(all.back(), {1, 0.3 * seed, 0.5}, 37.0 * seed));
  }
  return all;
}

TEST(seams, bodies_that_touch_where_their_seams_end_all_close) {
  const PolygonMesh one = cylinder_with_a_seam(16, 1, 1), above = shapes::moved(one, {0, 0, 120});
  PolygonMesh labelled = shapes::joined(one, above);
  labelled.labels.group.names = {"lower", "upper"};
  for (std::uint32_t f = 0; f < labelled.face_count(); ++f)
    labelled.labels.group.of_face.push_back(f < one.face_count() ? 0 : 1);
  const double volume = 120 * 16 * 25 * 25 * std::sin(2 * std::numbers::pi / 16) / 2;
  for (const PolygonMesh& both : {shapes::joined(one, above), labelled})
    for (const PolygonMesh& mesh : in_many_ways(both)) {
      const Body body = remeshed_body(mesh);
      EXPECT_TRUE(body.is_closed);
      EXPECT_NEAR(body.volume, 2 * volume, 1e-9 * volume);
    }
}

TEST(seams, a_body_on_a_larger_one_whose_seam_it_crosses_leaves_that_closed) {
  const double area = 16 * 25 * 25 * std::sin(2 * std::numbers::pi / 16) / 2;
  for (const std::uint32_t sides : {16u, 20u}) {
    const PolygonMesh below = cylinder_with_a_seam(16, 1, 1);
    const PolygonMesh above = narrowed(shapes::moved(cylinder_with_a_seam(sides, 1, 1), {0, 0, 120}), 0.5);
    const double area_above = sides * 12.5 * 12.5 * std::sin(2 * std::numbers::pi / sides) / 2;
    for (const PolygonMesh& mesh : in_many_ways(shapes::joined(below, above))) {
      const Report report = report_of(mesh);
      EXPECT_TRUE(report.output.closed);
      EXPECT_EQ(report.output.non_manifold_edges, 0u);
      EXPECT_NEAR(report.output.volume.value_or(0), 120 * (area + area_above), 1e-9 * 120 * area);
    }
  }
}

TEST(seams, bricks_whose_facets_were_all_moved_by_rounding_stay_bricks) {
  const PolygonMesh brick = shapes::moved(shapes::box({4, 4, 4}), {0.1, 0.2, 0.3});
  const PolygonMesh two = shapes::joined(brick, shapes::moved(brick, {4, 0, 0}));
  const PolygonMesh four = shapes::joined(two, shapes::moved(two, {0, 4, 0}));
  const PolygonMesh eight = shapes::joined(four, shapes::moved(four, {0, 0, 4}));
  for (const PolygonMesh& bricks : {two, four, eight})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const PolygonMesh turned = shapes::rotated(bricks, {1, 0.2 * seed, 0.4}, 21.0 * seed);
      const Report report = report_of(shapes::renumbered(torn::into_facets(turned, torn::noise(seed, 1e-12)), seed));
      EXPECT_TRUE(report.output.closed);
      EXPECT_EQ(report.output.components, bricks.face_count() / 12);
      EXPECT_NEAR(report.output.volume.value_or(0), 64.0 * static_cast<double>(bricks.face_count()) / 12, 1e-7);
    }
}

TEST(seams, a_second_copy_of_a_solid_moved_by_rounding_is_dropped) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh box = shapes::box({4, 5, 6}, 2);
    const PolygonMesh twice = shapes::joined(torn::into_facets(box, torn::noise(seed, 1e-12)),
                                             torn::into_facets(box, torn::noise(seed + 100, 1e-12)));
    const Report report = report_of(shapes::renumbered(twice, seed));
    EXPECT_TRUE(report.output.closed);
    EXPECT_EQ(report.output.components, 1u);
    EXPECT_NEAR(report.output.volume.value_or(0), 120, 1e-7);
    std::uint64_t repeated = 0;
    for (const Diagnostic& d : report.diagnostics)
      if (d.code == DiagnosticCode::kDuplicateFace) repeated += d.count;
    EXPECT_EQ(repeated, box.face_count());
  }
}

TEST(seams, faces_that_look_the_other_way_are_joined_and_turned) {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const PolygonMesh& whole : {shapes::box({4, 5, 6}, 2), shapes::quad_box({4, 5, 6}, 2), shapes::sphere(2)}) {
      const double volume = std::fabs(report_of(whole).output.volume.value());
      const PolygonMesh mesh = with_turned_faces(torn::into_facets(whole, torn::noise(seed, 1e-12)), seed, 5);
      const Body body = remeshed_body(shapes::renumbered(mesh, seed));
      EXPECT_TRUE(body.is_closed);
      EXPECT_NEAR(body.volume, volume, 1e-8);
      Options options = unrefined();
      options.repair.winding = false;
      EXPECT_FALSE(remeshed_body(mesh, options).is_closed);
    }
}

TEST(seams, a_part_that_looks_the_other_way_is_joined_over_its_seams) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh whole = shapes::l_bracket(3);
    const double volume = report_of(whole).output.volume.value();
    const torn::IsSecond is_second = torn::above_a_plane(seed);
    PolygonMesh mesh = torn::in_two(whole, is_second, torn::noise(seed, 1e-12));
    for (std::uint32_t f = 0; f < whole.face_count(); ++f) {
      Vec3 centre;
      for (const VertexId v : whole.face(FaceId(f))) centre += 1.0 / 3 * whole.positions[v];
      if (is_second(centre))
        std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
    }
    const Body body = remeshed_body(mesh);
    EXPECT_TRUE(body.is_closed);
    EXPECT_NEAR(std::fabs(body.volume), volume, 1e-8);
  }
}

TEST(seams, a_strip_that_its_seam_would_make_one_sided_stays_open_and_is_told) {
  // A band with half a twist, of which the last end is on the first one but for rounding, and upside down.
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  constexpr std::uint32_t kSteps = 24;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSteps;
    for (const double s : {-0.5, 0.5}) {
      const double r = 2 + s * std::cos(angle / 2);
      points.push_back({r * std::cos(angle), r * std::sin(angle), s * std::sin(angle / 2)});
    }
    if (i > 0) {
      faces.push_back({2 * i - 2, 2 * i, 2 * i + 1});
      faces.push_back({2 * i - 2, 2 * i + 1, 2 * i - 1});
    }
  }
  const Report report = report_of(shapes::from_lists(points, faces));
  EXPECT_EQ(report.output.boundary_edges, 2 * kSteps + 2);
  EXPECT_EQ(seams_of(report), 2u);
}

TEST(seams, three_sheets_that_meet_alike_stay_open_and_are_told) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3, off = i * 1e-12, x = std::cos(angle), y = std::sin(angle);
    points.insert(points.end(), {{off, 0, 0}, {off, 0, 1}, {x, y, 1}, {x, y, 0}});
    faces.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
  }
  const Report report = report_of(shapes::from_lists(points, faces));
  EXPECT_EQ(report.output.boundary_edges, report.output.faces + 2 * 3);
  EXPECT_EQ(seams_of(report), 3u);
}

TEST(seams, two_sheets_that_go_straight_on_are_joined_past_a_third_one) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double angle = std::numbers::pi / 2 * i, off = i * 1e-12, x = std::cos(angle), y = std::sin(angle);
    points.insert(points.end(), {{off, 0, 0}, {off, 0, 1}, {x, y, 1}, {x, y, 0}});
    faces.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
  }
  const PolygonMesh mesh = shapes::from_lists(points, faces);
  for (const PolygonMesh& sheets : in_many_ways(mesh)) {
    const Report report = report_of(sheets);
    // The straight one is a rectangle with six vertices at most, the other one has four.
    EXPECT_EQ(report.output.components, 2u);
    EXPECT_EQ(seams_of(report), 2u);
  }
}

TEST(seams, the_cylinder_of_the_shared_collection_is_closed) {
  const std::string name = "reports/cylinder-seam.stl";
  if (!test::has_shared_mesh(name)) return;
  std::ifstream file(test::shared_meshes_folder() / name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const Report report = report_of(read_mesh(Format::kStl, text, {}, control).mesh);
  EXPECT_FALSE(report.input.closed);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_GT(seams_of(report), 0u);
}

}  // namespace
}  // namespace remesh
