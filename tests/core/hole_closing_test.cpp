// Tests that flat holes are closed as asked, on drawn solids whose volume, Euler number and number of holes follow from
// geometry, and what is said of the holes that are left.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/mending/edges/holes.h"
#include "core/mending/weld/weld.h"
#include "core/remesh.h"
#include "tests/support/hostile_families.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/time_limit.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const Diagnostic* find_diagnostic(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.diagnostics.begin(), report.diagnostics.end(),
                                  [&](const Diagnostic& d) { return d.code == code; });
  return found == report.diagnostics.end() ? nullptr : &*found;
}
std::uint64_t closed_holes(const Report& report) {
  const Diagnostic* const found = find_diagnostic(report, DiagnosticCode::kClosedHole);
  return found == nullptr ? 0 : found->count;
}
std::string open_boundary_text(const Report& report) {
  const Diagnostic* const found = find_diagnostic(report, DiagnosticCode::kOpenBoundary);
  return found == nullptr ? "" : found->message;
}

Options closing(std::optional<std::uint64_t> max_edges = std::nullopt) {
  Options options = unrefined();
  options.coarsens_fine_facets = false;
  options.repair.holes = true;
  options.max_hole_edges = max_edges;
  return options;
}

using IsGone = std::function<bool(const std::vector<Vec3>& corners)>;

/// Takes away the faces for whose corners `is_gone` holds.
PolygonMesh without_faces(const PolygonMesh& mesh, const IsGone& is_gone) {
  PolygonMesh left;
  left.positions = mesh.positions;
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
    std::vector<Vec3> corners;
    for (const VertexId v : mesh.face(f)) corners.push_back(mesh.positions[v]);
    if (is_gone(corners)) continue;
    left.corners.insert(left.corners.end(), mesh.face(f).begin(), mesh.face(f).end());
    left.face_begin.push_back(static_cast<std::uint32_t>(left.corners.size()));
  }
  return left;
}
bool are_at_height(const std::vector<Vec3>& corners, double z) {
  return std::all_of(corners.begin(), corners.end(), [&](const Vec3& p) { return p.z == z; });
}
IsGone at_height(double z) {
  return [=](const std::vector<Vec3>& corners) { return are_at_height(corners, z); };
}
/// The faces at this height whose middles are within the rectangle.
IsGone at_height_within(double z, Vec2 from, Vec2 to) {
  return [=](const std::vector<Vec3>& corners) {
    Vec3 middle;
    for (const Vec3& p : corners) middle += (1.0 / static_cast<double>(corners.size())) * p;
    return are_at_height(corners, z) && middle.x > from.x && middle.x < to.x && middle.y > from.y && middle.y < to.y;
  };
}

/// The wall of a cylinder between z = 0 and `height`.
PolygonMesh wall(int sides, double radius, double height) {
  return without_faces(shapes::cylinder(sides, radius, height), [](const std::vector<Vec3>& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](const Vec3& p) { return p.z == corners[0].z; });
  });
}
double area_of_regular(int sides, double radius) {
  return sides / 2.0 * std::sin(2 * std::numbers::pi / sides) * radius * radius;
}
PolygonMesh box_without_lid(const Vec3& size) { return without_faces(shapes::quad_box(size), at_height(size.z)); }

/// A solid with holes, and what has to become of it.
struct Solid {
  std::string name;
  PolygonMesh mesh;
  std::optional<std::uint64_t> max_edges;
  std::uint64_t holes;
  double volume;
  std::int64_t euler;
};

std::vector<Solid> drawn_solids() {
  std::vector<Solid> solids;
  solids.push_back({"a thin pipe's ends", wall(24, 1, 3), 24, 2, 3 * area_of_regular(24, 1), 2});
  solids.push_back({"a box without a lid", box_without_lid({2, 3, 4}), {}, 1, 24, 2});
  const PolygonMesh thick = shapes::joined(wall(16, 2, 3), shapes::turned_over(wall(16, 1, 3)));
  const double thick_volume = 3 * (area_of_regular(16, 2) - area_of_regular(16, 1));
  solids.push_back({"rings at the ends of a thick pipe", thick, 16, 2, thick_volume, 0});
  const double rod_volume = 3 * area_of_regular(8, 0.5);
  solids.push_back({"islands in rings", shapes::joined(thick, wall(8, 0.5, 3)), 16, 4, thick_volume + rod_volume, 2});
  const PolygonMesh with_sliver =
      shapes::fan_triangulated(shapes::prism({{0, 0}, {2, 0}, {2, 1e-3}, {2, 2}, {0, 2}}, 1));
  solids.push_back({"a sliver that is missing",
                    without_faces(with_sliver,
                                  [](const std::vector<Vec3>& corners) {
                                    return are_at_height(corners, 1) &&
                                           std::all_of(corners.begin(), corners.end(),
                                                       [](const Vec3& p) { return p.y <= 1e-3; });
                                  }),
                    {},
                    1,
                    4,
                    2});
  solids.push_back({"a slot whose rim has collinear vertices",
                    without_faces(shapes::quad_box({4, 4, 1}, 4), at_height_within(1, {1, 1}, {3, 2})),
                    {},
                    1,
                    16,
                    2});
  solids.push_back({"a hexagon in a part that is turned",
                    shapes::rotated(without_faces(shapes::cylinder(6, 2, 1), at_height(1)), {1, 2, 3}, 37),
                    {},
                    1,
                    area_of_regular(6, 2),
                    2});
  const std::vector<Vec2> ell{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}};
  solids.push_back({"an L", without_faces(shapes::prism(ell, 2), at_height(2)), {}, 1, 8, 2});
  solids.push_back({"an end with many edges", without_faces(shapes::cylinder(200, 5, 2), at_height(2)), 200, 1,
                    2 * area_of_regular(200, 5), 2});
  solids.push_back({"two bodies",
                    shapes::joined(box_without_lid({1, 1, 1}), shapes::moved(box_without_lid({2, 1, 1}), {3, 0, 0})),
                    {},
                    2,
                    3,
                    4});
  solids.push_back({"holes that touch in a vertex",
                    without_faces(without_faces(shapes::quad_box({4, 4, 1}, 4), at_height_within(1, {1, 1}, {2, 2})),
                                  at_height_within(1, {2, 2}, {3, 3})),
                    {},
                    2,
                    16,
                    2});
  solids.push_back({"holes in two planes that touch in a corner",
                    without_faces(without_faces(shapes::quad_box({4, 4, 4}, 4), at_height_within(4, {0, 0}, {1, 1})),
                                  [](const std::vector<Vec3>& corners) {
                                    return std::all_of(corners.begin(), corners.end(), [](const Vec3& p) {
                                      return p.x == 0 && p.y >= 1 && p.y <= 2 && p.z >= 3;
                                    });
                                  }),
                    {},
                    2,
                    64,
                    2});
  return solids;
}

TEST(hole_closing, drawn_solids_get_the_volume_and_the_euler_number_that_geometry_gives) {
  for (const Solid& solid : drawn_solids())
    for (unsigned seed = 0; seed < 3; ++seed) {
      const PolygonMesh mesh = seed == 0 ? solid.mesh : shapes::renumbered(solid.mesh, seed);
      for (const bool refine : {false, true}) {
        Options options = closing(solid.max_edges);
        options.refine = refine;
        if (refine && seed != 0) continue;
        const Result result = remeshed(mesh, options);
        const MeshStatistics& output = result.report.output;
        EXPECT_EQ(closed_holes(result.report), solid.holes) << solid.name << open_boundary_text(result.report);
        EXPECT_TRUE(result.report.verified.all_true()) << solid.name;
        EXPECT_TRUE(output.closed) << solid.name;
        ASSERT_TRUE(output.volume) << solid.name;
        EXPECT_NEAR(*output.volume, solid.volume, 1e-9 * solid.volume) << solid.name;
        EXPECT_EQ(output.euler, solid.euler) << solid.name;
        EXPECT_TRUE(result.report.volume_obstacles.empty()) << solid.name;
      }
    }
}

TEST(hole_closing, a_new_face_becomes_one_patch_with_its_coplanar_neighbours) {
  const PolygonMesh slotted = without_faces(shapes::quad_box({4, 4, 1}, 4), at_height_within(1, {1, 1}, {3, 2}));
  const Result result = remeshed(slotted, closing());
  EXPECT_EQ(result.report.patches.size(), 6u) << "the sides of a box";
  EXPECT_EQ(result.mesh.faces.size(), 12u);
}

TEST(hole_closing, nothing_is_closed_without_being_asked_for) {
  const Result result = remeshed(box_without_lid({2, 3, 4}));
  EXPECT_EQ(closed_holes(result.report), 0u);
  EXPECT_FALSE(result.report.output.closed);
  EXPECT_THAT(open_boundary_text(result.report), HasSubstr("4 edges, size 3.606, perimeter 10, around (1, 1.5, 4): "
                                                           "repair=+holes closes it"));
}

TEST(hole_closing, the_number_of_edges_and_the_size_select) {
  const PolygonMesh pipe = wall(24, 1, 3);
  EXPECT_EQ(closed_holes(remeshed(pipe, closing(23)).report), 0u);
  EXPECT_EQ(closed_holes(remeshed(pipe, closing(24)).report), 2u);
  const Report by_itself = remeshed(pipe, closing()).report;
  EXPECT_EQ(closed_holes(by_itself), 0u) << "24 edges are more than 12, and a third of the length is over 5 %";
  EXPECT_THAT(open_boundary_text(by_itself), HasSubstr("2 larger loops are flat, and repair=+holes with "
                                                       "max_hole_edges=24 closes what no other face meets"));
  Options by_size = closing();
  by_size.defeature_size = 1.99;
  EXPECT_EQ(closed_holes(remeshed(pipe, by_size).report), 0u) << "the diameter is 2";
  by_size.defeature_size = 2.01;
  EXPECT_EQ(closed_holes(remeshed(pipe, by_size).report), 2u);
  by_size.defeature_size = 0;
  EXPECT_EQ(closed_holes(remeshed(box_without_lid({1, 1, 1}), by_size).report), 1u) << "0 is no size of holes";
}

TEST(hole_closing, a_ring_is_closed_only_if_both_rims_are_selected) {
  const PolygonMesh thick = shapes::joined(wall(24, 2, 3), shapes::turned_over(wall(12, 1, 3)));
  EXPECT_EQ(closed_holes(remeshed(thick, closing(12)).report), 0u) << "a bore has no lid of its own";
  EXPECT_EQ(closed_holes(remeshed(thick, closing(24)).report), 2u);
}

TEST(hole_closing, a_face_that_would_cross_or_touch_the_surface_is_refused) {
  const PolygonMesh box = box_without_lid({4, 4, 4});
  for (const double top : {4.0, 5.0}) {
    const PolygonMesh rod = shapes::moved(shapes::cylinder(6, 0.5, top - 1), {2, 2, 1});
    const Report report = remeshed(shapes::joined(box, rod), closing(100)).report;
    EXPECT_EQ(closed_holes(report), 0u) << top;
    EXPECT_THAT(open_boundary_text(report),
                HasSubstr("no option closes it, because a flat face over it would meet face"))
        << top;
  }
  const PolygonMesh below = shapes::moved(shapes::cylinder(6, 0.5, 2), {2, 2, 1});
  EXPECT_EQ(closed_holes(remeshed(shapes::joined(box, below), closing(100)).report), 1u);
}

TEST(hole_closing, of_two_boxes_in_each_other_only_the_inner_one_gets_a_lid_or_a_ring_joins_them) {
  const PolygonMesh outer = box_without_lid({4, 4, 4});
  const PolygonMesh inner = shapes::moved(box_without_lid({1, 1, 2}), {1, 1, 2});
  const Report both_outwards = remeshed(shapes::joined(outer, inner), closing()).report;
  EXPECT_EQ(closed_holes(both_outwards), 1u);
  EXPECT_THAT(open_boundary_text(both_outwards),
              HasSubstr("4 edges, size 5.657, perimeter 16, around (2, 2, 4): no option closes it, because the faces "
                        "around that part of the plane do not look the same way"));
  // Turned over, the inner box is a pit in the outer one.
  const Report pit = remeshed(shapes::joined(outer, shapes::turned_over(inner)), closing()).report;
  EXPECT_EQ(closed_holes(pit), 1u);
  ASSERT_TRUE(pit.output.volume);
  EXPECT_NEAR(*pit.output.volume, 64 - 2, 1e-12);
  EXPECT_EQ(pit.output.euler, 2);
}

TEST(hole_closing, a_rim_is_flat_within_the_plane_tolerance) {
  PolygonMesh box = box_without_lid({2, 2, 2});
  for (Vec3& p : box.positions)
    if (p == Vec3{2, 2, 2}) p.z += 2e-4;
  EXPECT_EQ(closed_holes(remeshed(box, closing()).report), 0u);
  Options coarse = closing();
  coarse.plane_tolerance = 1e-3;
  const Result result = remeshed(box, coarse);
  EXPECT_EQ(closed_holes(result.report), 1u);
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_TRUE(result.report.verified.all_true());
}

TEST(hole_closing, a_vertex_on_an_open_edge_is_no_hole) {
  // The wall at the front has a vertex on an upright edge that its neighbour lacks.
  const PolygonMesh box = shapes::from_lists(
      {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {2, 0, 1}},
      {{3, 2, 1, 0}, {0, 1, 8, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
  const Report mended = remeshed(box, closing()).report;
  EXPECT_EQ(closed_holes(mended), 1u);
  EXPECT_TRUE(mended.output.closed);
  Options left = closing();
  left.repair.t_junctions = false;
  const Report open = remeshed(box, left).report;
  EXPECT_EQ(closed_holes(open), 1u) << "the lid";
  EXPECT_THAT(open_boundary_text(open), HasSubstr("3 edges"));
  EXPECT_THAT(open_boundary_text(open), HasSubstr("no option closes it, because it has no width"));
}

TEST(hole_closing, the_outline_of_a_sheet_is_no_hole_but_the_hole_in_it_is) {
  const PolygonMesh plate = shapes::flat({"####", "#..#", "####"});
  const Report report = remeshed(plate, closing(100)).report;
  EXPECT_EQ(closed_holes(report), 1u);
  EXPECT_EQ(report.output.area, 12);
  EXPECT_EQ(report.output.euler, 1);
  EXPECT_EQ(report.output.boundary_edges, 4u);
}

TEST(hole_closing, rims_that_lie_in_no_plane_are_told_and_stay) {
  // The roof of a box, and a side of it, are missing.
  const PolygonMesh open = without_faces(box_without_lid({1, 2, 1}), [](const std::vector<Vec3>& corners) {
    return std::all_of(corners.begin(), corners.end(), [](const Vec3& p) { return p.x == 0; });
  });
  const Report report = remeshed(open, closing(100)).report;
  EXPECT_EQ(closed_holes(report), 0u);
  EXPECT_THAT(open_boundary_text(report), HasSubstr("6 edges"));
  EXPECT_THAT(open_boundary_text(report), HasSubstr("no option closes it, because it lies in no plane"));
}

TEST(hole_closing, faces_around_that_look_opposite_ways_are_turned_first) {
  PolygonMesh mixed = box_without_lid({2, 3, 4});
  std::reverse(mixed.corners.begin(), mixed.corners.begin() + 4);
  const Result result = remeshed(mixed, closing());
  EXPECT_EQ(closed_holes(result.report), 1u);
  ASSERT_TRUE(result.report.output.volume);
  EXPECT_NEAR(*result.report.output.volume, 24, 1e-12);
}

TEST(hole_closing, the_labels_are_those_of_most_of_the_rim_and_the_source_has_them) {
  PolygonMesh box = box_without_lid({1, 5, 1});
  box.labels.group.names = {"short", "long"};
  for (FaceId f(0); f.value < box.face_count(); ++f.value) {
    const auto corners = box.face(f);
    const bool is_long = std::all_of(corners.begin(), corners.end(),
                                     [&](VertexId v) { return box.positions[v].x == box.positions[corners[0]].x; });
    box.labels.group.of_face.push_back(is_long ? 1 : 0);
  }
  RunSettings settings;
  settings.want_face_source = true;
  const Result result = remeshed(box, closing(), settings);
  std::size_t on_top = 0;
  for (FaceId f(0); f.value < result.mesh.faces.size(); ++f.value) {
    const Triangle& t = result.mesh.faces[f];
    if (!std::all_of(t.begin(), t.end(), [&](VertexId v) { return result.mesh.positions[v].z == 1; })) continue;
    ++on_top;
    EXPECT_EQ(result.mesh.labels.group.of_face[f], 1u);
    EXPECT_EQ(box.labels.group.of_face[result.face_source[f]], 1u);
  }
  EXPECT_EQ(on_top, 2u);
}

TEST(hole_closing, a_number_of_edges_needs_the_word_holes) {
  Options options = unrefined();
  options.max_hole_edges = 10;
  try {
    remeshed(shapes::quad_box({1, 1, 1}), options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kInvalidOption);
    EXPECT_EQ(error.option, "max_hole_edges");
  }
}

TEST(hole_closing, a_closed_part_is_the_same_with_and_without) {
  const PolygonMesh part = shapes::l_bracket(2);
  const Result with = remeshed(part, closing(1000)), without = remeshed(part);
  EXPECT_EQ(with.mesh.faces.size(), without.mesh.faces.size());
  EXPECT_EQ(closed_holes(with.report), 0u);
  EXPECT_THAT(open_boundary_text(with.report), Not(HasSubstr("loops")));
}

TEST(hole_closing, sheets_in_boxes_of_each_other_do_not_take_quadratic_time) {
  const auto time_of = [](std::size_t sheets) {
    RunControl control;
    const PolygonMesh mesh = hostile::family("askew_stack").make(sheets);
    std::vector<Diagnostic> diagnostics;
    Surface surface = weld(mesh, {}, diagnostics, control);
    const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
    Advice left;
    const test::Seconds start = test::processor_time();
    HoleRules rules;
    rules.mend = MendMode::kYes;
    rules.diagonal = 10;
    EXPECT_FALSE(close_holes(surface, edges, {}, rules, diagnostics, left, control));
    EXPECT_THAT(left.text, HasSubstr("4 edges"));
    return test::processor_time() - start;
  };
  // In proportion to n log n, it is 22 times; in proportion to the square, 256 times.
  const test::Seconds of_few = time_of(4'000);
  test::expect_best_within(70 * of_few / test::kSlowdown, [&] { return time_of(64'000); });
}

}  // namespace
}  // namespace remesh
