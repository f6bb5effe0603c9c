// Tests what is mended, and what the report says about it.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "core/base/tolerance.h"
#include "core/remesh.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

const Diagnostic* find(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.diagnostics.begin(), report.diagnostics.end(),
                                  [&](const Diagnostic& d) { return d.code == code; });
  return found == report.diagnostics.end() ? nullptr : &*found;
}
std::uint64_t count_of(const Report& report, DiagnosticCode code) {
  std::uint64_t count = 0;
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == code) count += d.count;
  return count;
}
const VolumeObstacle* obstacle(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.volume_obstacles.begin(), report.volume_obstacles.end(),
                                  [&](const VolumeObstacle& o) { return o.code == code; });
  return found == report.volume_obstacles.end() ? nullptr : &*found;
}

Options without_repair() {
  Options options = unrefined();
  options.repair = {false, false, false, false, false};
  return options;
}

/// Makes a unit cube of quads. The upper quad is in two halves, whose ends in the middle are on edges of the sides.
PolygonMesh cube_with_t_junctions() {
  return shapes::from_lists(
      {{0, 0, 0},
       {1, 0, 0},
       {1, 1, 0},
       {0, 1, 0},
       {0, 0, 1},
       {1, 0, 1},
       {1, 1, 1},
       {0, 1, 1},
       {0.5, 0, 1},
       {0.5, 1, 1}},
      {{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 8, 9, 7}, {8, 5, 6, 9}});
}

TEST(remesh_surface, t_junctions_are_closed_by_splitting) {
  const Result mended = remeshed(cube_with_t_junctions());
  EXPECT_TRUE(mended.report.verified.all_true());
  EXPECT_TRUE(mended.report.output.closed);
  EXPECT_EQ(mended.mesh.faces.size(), 12u);
  EXPECT_TRUE(mended.report.volume_obstacles.empty());
  ASSERT_NE(find(mended.report, DiagnosticCode::kTJunction), nullptr);
  EXPECT_EQ(find(mended.report, DiagnosticCode::kTJunction)->elements, (std::vector<std::uint64_t>{8, 9}));

  const Result left = remeshed(cube_with_t_junctions(), without_repair());
  EXPECT_TRUE(left.report.verified.all_true());
  EXPECT_FALSE(left.report.output.closed);
  EXPECT_EQ(count_of(left.report, DiagnosticCode::kTJunction), 2u);
  ASSERT_NE(obstacle(left.report, DiagnosticCode::kOpenBoundary), nullptr);
}

TEST(remesh_surface, every_mending_together_gives_the_box_again) {
  // Repeated, turned over at random, with a zero-area face between two triangles.
  for (int seed = 0; seed < 10; ++seed) {
    Random random(seed);
    PolygonMesh mesh = shapes::box({1, 2, 3}, 4);
    const std::size_t faces = mesh.face_count();
    for (std::size_t f = 0; f < faces; ++f) {
      const bool is_turned = random.chance(0.2);
      if (is_turned)
        std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
      if (!random.chance(0.1)) continue;
      const std::vector<VertexId> loop(mesh.face(FaceId(f)).begin(), mesh.face(FaceId(f)).end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    const Result result = remeshed(mesh);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(result.mesh.faces.size(), 12u);
    EXPECT_DOUBLE_EQ(result.report.output.volume.value_or(0), 6);
    EXPECT_TRUE(result.report.volume_obstacles.empty());
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kDuplicateFace), mesh.face_count() - faces);
    EXPECT_GT(count_of(result.report, DiagnosticCode::kInconsistentWinding), 0u);
  }
}

TEST(remesh_surface, a_box_of_few_digits_is_flat_after_its_mending) {
  // Eight corners would be too few numbers to prove that four decimals are all that was kept of them.
  const double step = 1e-4;
  const PolygonMesh box = shapes::rounded(shapes::rotated(shapes::box({2, 2.5, 3}, 2), {1, 2, 3}, 40), step);
  const double tolerance = remeshed(box).report.plane_tolerance;
  EXPECT_NEAR(tolerance, kToleranceSteps * step, 1e-6 * step);
  PolygonMesh flipped = box;
  for (std::size_t f = 0; f < box.face_count(); f += 2) std::swap(flipped.corners[3 * f], flipped.corners[3 * f + 1]);
  for (const PolygonMesh& mesh :
       {box, flipped, shapes::joined(box, box), shapes::joined(box, shapes::turned_over(box))}) {
    const Result result = remeshed(mesh);
    EXPECT_EQ(result.report.plane_tolerance, tolerance);
    EXPECT_EQ(result.report.patches.size(), 6u);
    EXPECT_EQ(result.mesh.faces.size(), 12u);
  }
}

TEST(remesh_surface, whatever_is_left_unmended_comes_back_verified) {
  for (int seed = 0; seed < 32; ++seed) {
    PolygonMesh mesh = shapes::joined(cube_with_t_junctions(),
                                      shapes::moved(shapes::turned_over(shapes::box({1, 1, 1}, 2)), {3, 0, 0}));
    std::reverse(mesh.corners.begin(), mesh.corners.begin() + 4);
    for (const std::uint32_t f : {10u, 11u}) {  // once more, and once from behind
      std::vector<VertexId> loop(mesh.face(FaceId(f)).begin(), mesh.face(FaceId(f)).end());
      if (f == 11) std::reverse(loop.begin(), loop.end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    const auto first = mesh.face(FaceId(12));
    const VertexId middle = mesh.positions.push_back(0.5 * (mesh.positions[first[0]] + mesh.positions[first[1]]));
    for (const VertexId v : {first[0], middle, first[1]}) mesh.corners.push_back(v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    Options options = unrefined();
    options.repair = {(seed & 1) != 0, (seed & 2) != 0, (seed & 4) != 0, (seed & 8) != 0, (seed & 16) != 0};
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true()) << seed;
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kTJunction) > 0, true) << seed;
    EXPECT_GE(count_of(result.report, DiagnosticCode::kDuplicateFace), 2u) << seed;
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kZeroAreaFace), 1u) << seed;
    EXPECT_GT(count_of(result.report, DiagnosticCode::kInconsistentWinding), 0u) << seed;
  }
}

TEST(remesh_surface, a_solid_inside_out_is_reported_and_turned_only_on_request) {
  const PolygonMesh mesh = shapes::turned_over(shapes::box({1, 2, 3}, 2));
  Options options = unrefined();
  const Result reported = remeshed(mesh, options);
  EXPECT_DOUBLE_EQ(*reported.report.output.volume, -6);
  EXPECT_EQ(count_of(reported.report, DiagnosticCode::kInsideOut), 1u);
  EXPECT_NE(obstacle(reported.report, DiagnosticCode::kInsideOut), nullptr);
  options.repair.inside_out = true;
  const Result turned = remeshed(mesh, options);
  EXPECT_DOUBLE_EQ(*turned.report.output.volume, 6);
  EXPECT_EQ(count_of(turned.report, DiagnosticCode::kInsideOut), 1u);
  EXPECT_TRUE(turned.report.volume_obstacles.empty());
}

TEST(remesh_surface, a_small_solid_inside_out_at_a_corner_of_a_large_one_is_found) {
  // The volume of both is positive, and they are one component.
  const PolygonMesh small = shapes::turned_over(shapes::moved(shapes::box({1, 1, 1}), {-1, -1, -1}));
  const PolygonMesh mesh = shapes::welded(shapes::joined(shapes::box({2, 2, 2}), small));
  Options options = unrefined();
  options.repair.inside_out = true;
  const Result turned = remeshed(mesh, options);
  EXPECT_EQ(turned.report.input.components, 1u);
  EXPECT_DOUBLE_EQ(*turned.report.input.volume, 7);
  EXPECT_EQ(count_of(turned.report, DiagnosticCode::kInsideOut), 1u);
  EXPECT_DOUBLE_EQ(*turned.report.output.volume, 9);
}

TEST(remesh_surface, a_soup_whose_corners_nearly_meet_is_closed_by_its_weld_tolerance) {
  Random random(7);
  const PolygonMesh box = shapes::box({1, 1, 1}, 3);
  PolygonMesh soup;
  for (const VertexId v : box.corners) {
    Vec3 noise{random.unit(), random.unit(), random.unit()};
    soup.corners.push_back(soup.positions.push_back(box.positions[v] + 1e-6 * noise));
  }
  soup.face_begin = box.face_begin;
  Options options = unrefined();
  options.plane_tolerance = 1e-5;
  EXPECT_FALSE(remeshed(soup, options).report.output.closed);
  options.weld_tolerance = 4e-6;
  const Result result = remeshed(soup, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_EQ(result.mesh.faces.size(), 12u);
  EXPECT_EQ(count_of(result.report, DiagnosticCode::kDuplicateVertex), soup.vertex_count() - box.vertex_count());
}

TEST(remesh_surface, labels_and_sources_are_right_after_mending) {
  PolygonMesh mesh = cube_with_t_junctions();
  const std::vector<VertexId> repeat{VertexId(5), VertexId(6), VertexId(9), VertexId(8)};
  mesh.corners.insert(mesh.corners.end(), repeat.begin(), repeat.end());
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  std::reverse(mesh.corners.begin() + mesh.face_begin[2], mesh.corners.begin() + mesh.face_begin[3]);
  mesh = with_groups(mesh, {0, 1, 2, 3, 4, 5, 6, 7});
  RunSettings settings;
  settings.want_face_source = true;
  const Result result = remeshed(mesh, unrefined(), settings);
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_EQ(result.report.patches.size(), 7u);
  EXPECT_DOUBLE_EQ(*result.report.output.volume, 1);
  std::set<std::uint32_t> groups;
  for (std::uint32_t i = 0; i < result.mesh.faces.size(); ++i) {
    const FaceId f(i), source = result.face_source[f];
    EXPECT_EQ(result.mesh.labels.group.of_face[f], mesh.labels.group.of_face[source]);
    groups.insert(result.mesh.labels.group.of_face[f]);
    const auto& [a, b, c] = result.mesh.faces[f];
    const Vec3 centroid = (1.0 / 3) * (result.mesh.positions[a] + result.mesh.positions[b] + result.mesh.positions[c]);
    Box3 box;
    for (const VertexId v : mesh.face(source)) box.add(mesh.positions[v]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(centroid[axis], box.min[axis] - 1e-12);
      EXPECT_LE(centroid[axis], box.max[axis] + 1e-12);
    }
  }
  EXPECT_EQ(groups, (std::set<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(remesh_surface, faces_that_cross_are_found_and_located) {
  const PolygonMesh mesh =
      shapes::joined(shapes::box({4, 4, 4}, 9), shapes::moved(shapes::box({1, 1, 4}, 5), {1.1, 1.2, 2.03}));
  const Result result = remeshed(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  const Diagnostic* found = find(result.report, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->count, *result.report.input.intersecting_pairs);
  EXPECT_EQ(found->elements.size(), Diagnostic::kMaxElements);
  for (std::size_t i = 0; i < found->elements.size(); i += 2) {
    EXPECT_LT(found->elements[i], shapes::box({4, 4, 4}, 9).face_count());
    EXPECT_GE(found->elements[i + 1], shapes::box({4, 4, 4}, 9).face_count());
  }
  const VolumeObstacle* crossing = obstacle(result.report, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(crossing, nullptr);
  EXPECT_EQ(crossing->count, *result.report.output.intersecting_pairs);
  for (const Vec3& p : crossing->places) EXPECT_DOUBLE_EQ(p.z, 4);
  for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
}

TEST(remesh_surface, where_faces_that_cross_are_too_many_to_be_compared_the_report_says_so) {
  // Sheets through one line, each through all others.
  const auto sheets = [](int count) {
    PolygonMesh mesh;
    for (int i = 0; i < count; ++i) {
      const PolygonMesh sheet =
          shapes::rotated(shapes::moved(shapes::sheet(2, 2, 1, 1), {-1, -1, 0}), {1, 0, 0}, 0.5 * i);
      mesh = i == 0 ? sheet : shapes::joined(mesh, sheet);
    }
    return mesh;
  };
  for (const int count : {20, 330}) {
    const Result result = remeshed(sheets(count));
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_NE(find(result.report, DiagnosticCode::kSelfIntersection), nullptr);
    const Diagnostic* found = find(result.report, DiagnosticCode::kIncompleteCheck);
    ASSERT_EQ(found != nullptr, count == 330);
    if (found != nullptr) {
      EXPECT_NE(found->message.find("was not tested for all faces"), std::string::npos) << found->message;
    }
  }
}

TEST(remesh_surface, a_face_that_hangs_on_a_polygons_diagonal_touches_it) {
  const PolygonMesh mesh =
      shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}, {0, 0, -1}}, {{0, 1, 2, 3}, {0, 2, 4}});
  const Result result = remeshed(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.input.intersecting_pairs, 1u);
  for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
}

TEST(remesh_surface, where_not_all_touching_diagonals_are_counted_the_report_says_so) {
  // Quadrilaterals around one diagonal, and triangles on it: more pairs than are kept.
  constexpr int kQuads = 450, kTriangles = 450;
  std::vector<Vec3> points{{0, 0, -1}, {0, 0, 1}};
  std::vector<std::vector<std::uint32_t>> faces;
  const auto add = [&](int i, double radius) {
    const double angle = std::numbers::pi * i / (kQuads + kTriangles);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    return static_cast<std::uint32_t>(points.size() - 1);
  };
  for (int i = 0; i < kQuads; ++i) {
    const std::uint32_t right = add(i, 2), left = add(i, -2);
    faces.push_back({0, right, 1, left});
  }
  for (int i = 0; i < kTriangles; ++i) faces.push_back({0, add(kQuads + i, 2), 1});
  const Result result = remeshed(shapes::from_lists(points, faces));
  const Diagnostic* found = find(result.report, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(found, nullptr);
  EXPECT_LT(found->count, kQuads * kTriangles);
  EXPECT_NE(found->message.find("there are more"), std::string::npos);
}

TEST(remesh_surface, two_sheets_on_each_other_overlap) {
  const PolygonMesh flat = shapes::sheet(2, 2, 3, 3);
  const Result result = remeshed(shapes::joined(flat, shapes::moved(flat, {0.3, 0.2, 0})));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_GT(count_of(result.report, DiagnosticCode::kOverlappingFaces), 0u);
  EXPECT_NE(obstacle(result.report, DiagnosticCode::kOverlappingFaces), nullptr);
}

/// Makes a sheet with a dip in its middle, and a triangle that stands in the dip without touching it.
PolygonMesh tip_in_a_dip() {
  PolygonMesh sheet = shapes::sheet(8, 8, 8, 8);
  for (Vec3& p : sheet.positions)
    if (p == Vec3{4, 4, 0}) p.z = -0.008;
  return shapes::joined(sheet, shapes::from_lists({{4, 4, -0.004}, {4.5, 4, 1}, {4, 4.5, 1}}, {{0, 1, 2}}));
}

TEST(remesh_surface, flattening_makes_no_faces_cross_that_did_not) {
  Options options = unrefined();
  options.plane_tolerance = 0.02;
  for (const bool refine : {false, true}) {
    options.refine = refine;
    const Result result = remeshed(tip_in_a_dip(), options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(*result.report.input.intersecting_pairs, 0u);
    EXPECT_EQ(*result.report.output.intersecting_pairs, 0u);
    EXPECT_TRUE(std::any_of(result.report.patches.begin(), result.report.patches.end(), [](const PatchSummary& p) {
      return p.status == PatchStatus::kReduced && p.reason == PatchReason::kVerificationFailed;
    }));
  }
  // The sheet alone, without the tip, is one patch.
  PolygonMesh alone = tip_in_a_dip();
  alone.face_begin.pop_back();
  alone.corners.resize(alone.face_begin.back());
  EXPECT_EQ(remeshed(alone, options).report.patches.size(), 1u);
}

TEST(remesh_surface, a_bent_dart_is_not_cut_outside_of_itself) {
  // Its one diagonal inside is an edge of another face; by the other one it would fold over.
  for (std::uint32_t first = 0; first < 4; ++first) {
    std::vector<std::uint32_t> dart;
    for (std::uint32_t i = 0; i < 4; ++i) dart.push_back((first + i) % 4);
    const std::vector<Vec3> points{{0, 0, 0}, {4, 0, 0}, {1, 1, 0.3}, {0, 4, 0}, {0.5, 0.5, 5}};
    const PolygonMesh mesh = shapes::from_lists(points, {dart, {0, 2, 4}});
    const PolygonMesh alone = shapes::from_lists(points, {dart});
    const double fin = norm(cross(points[2], points[4])) / 2;
    const Result result = remeshed(mesh), expected = remeshed(alone);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_NEAR(result.report.output.area, expected.report.output.area + fin, 1e-12);
    EXPECT_EQ(result.report.output.intersecting_pairs, result.report.input.intersecting_pairs);
  }
}

TEST(remesh_surface, two_nearly_coplanar_patches_over_one_bent_border_do_not_share_a_diagonal) {
  // Both sheets of a pillow: over the same four vertices, whose shorter diagonal both would take.
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const double bend = 1e-4 * random.unit();
    const std::vector<Vec3> points{{-1, 0, 0},     {0, -1.3, bend}, {1, 0, 0},
                                   {0, 1.3, bend}, {0, 0, 0.002},   {0, 0, -0.002}};
    const PolygonMesh mesh = shapes::from_lists(
        points, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
    Options options = unrefined();
    options.plane_tolerance = 0.01;
    const Result result = remeshed(shapes::rotated(mesh, {1, 2, 3}, 17.0 * seed), options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_FALSE(result.mesh.faces.empty());
    EXPECT_TRUE(result.report.output.closed);
    EXPECT_EQ(result.report.output.non_manifold_edges, 0u);
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kNonManifoldEdge), 0u);
  }
}

TEST(remesh_surface, a_cylinder_of_a_thousand_facets_in_full_doubles_keeps_them_all) {
  const PolygonMesh cylinder = shapes::rotated(shapes::cylinder(1000, 1, 2), {1, 2, 3}, 40);
  for (const PolygonMesh& mesh : {cylinder, shapes::scaled(cylinder, 1e-3), shapes::moved(cylinder, {3, 4, 5})}) {
    const Result result = remeshed(mesh);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(result.report.patches.size(), 1002u);
    EXPECT_EQ(result.mesh.faces.size(), 2u * 998 + 2 * 1000);
  }
}

TEST(remesh_surface, a_bent_polygon_whose_every_cut_is_an_edge_already_joins_no_edges) {
  // Three triangles of a tetrahedron, and a quad over all four of its corners: either diagonal has faces. The quad
  // looks the other way, or it would be a copy of two of the triangles.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 2, 1}}, {{0, 1, 3}, {3, 2, 1, 0}, {1, 2, 3}, {2, 0, 3}});
  for (const Options& options : {unrefined(), Options{}}) {
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_GE(result.mesh.faces.size(), 4u);
    // Refinement may cut them: the two together stay as long.
    std::map<std::pair<VertexId, VertexId>, int> faces_at;
    for (const Triangle& t : result.mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) ++faces_at[std::minmax(t[k], t[(k + 1) % 3])];
    double length = 0;
    for (const auto& [edge, count] : faces_at)
      if (count > 2) length += norm(result.mesh.positions[edge.first] - result.mesh.positions[edge.second]);
    EXPECT_NEAR(length, 2 * std::sqrt(5.0), 1e-12);
  }
}

TEST(remesh_surface, a_bent_quadrilateral_that_closes_a_tetrahedron_is_answered_beside_zero_area_faces) {
  // Found by fuzzing: the shape's own cut of the quadrilateral is the two triangles' common edge.
  const PolygonMesh mesh = shapes::from_lists({{4, 4, 0}, {0, 4, 4}, {0, 0, 4}, {4, 0, 1}},
                                              {{2, 2, 3, 1}, {0, 0, 3}, {1, 2, 2, 0}, {3, 2, 0, 1}, {0, 0, 0}});
  for (const Options& options : {unrefined(), Options{}}) {
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_TRUE(result.report.output.closed);
    EXPECT_EQ(result.report.output.non_manifold_edges, 0u);
    // |(b - a) x (c - a) . (d - a)| / 6 of the four corners.
    EXPECT_NEAR(std::fabs(result.report.output.volume.value_or(0)), 16.0 / 6, 1e-12);
  }
}

}  // namespace
}  // namespace remesh
