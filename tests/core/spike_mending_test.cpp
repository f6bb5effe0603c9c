// Tests polygons that run out and back over themselves: what is left of them, and what the report says about them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/polygons.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"

namespace remesh {
namespace {

std::uint64_t count_of(const Report& report, DiagnosticCode code) {
  std::uint64_t count = 0;
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == code) count += d.count;
  return count;
}

/// Makes a rectangle of 10 x 3. Its upper side is the given way, which runs from right to left.
std::vector<Vec2> rectangle_with(const std::vector<Vec2>& upper) {
  std::vector<Vec2> loop{{0, 0}, {10, 0}, {10, 3}};
  loop.insert(loop.end(), upper.begin(), upper.end());
  loop.push_back({0, 3});
  return loop;
}

struct Case {
  const char* name;
  std::vector<Vec2> upper;
};

/// Cases with spikes in the upper side. All of them have the area of the rectangle.
const std::vector<Case> kSpikes{
    {"one corner", {{6, 3}, {6, 4}, {6, 3}}},
    {"three corners", {{6, 3}, {6, 4}, {7, 5}, {6, 6}, {7, 5}, {6, 4}, {6, 3}}},
    {"two spikes at one foot", {{6, 3}, {6, 4}, {6, 3}, {5, 4}, {6, 3}}},
    {"two spikes", {{8, 3}, {8, 9}, {8, 3}, {2, 3}, {1, 7}, {2, 3}}},
    {"a spike on a spike", {{6, 3}, {6, 5}, {7, 6}, {6, 5}, {5, 6}, {6, 5}, {6, 3}}},
    {"a part of the way, in two steps", {{6, 3}, {6, 5}, {6, 4}, {6, 3}}},
    {"back further than out, and out again", {{6, 3}, {6, 4}, {6, 5}, {6, 4.5}, {6, 4.75}, {6, 3}}},
    {"along the side", {{4, 3}, {6, 3}}},
    {"along the side twice", {{2, 3}, {8, 3}, {4, 3}, {6, 3}}},
    {"beyond the corner", {{-3, 3}}},
    {"outwards and inwards", {{8, 3}, {8, 4}, {8, 3}, {6, 3}, {6, 1}, {6, 3}}},
    {"through the rectangle", {{6, 3}, {6, -2}, {6, 3}}},
    {"away from its own side", {{6, 3}, {20, 3}, {6, 3}}},
    {"a blunt tip", {{6, 3}, {6, 4}, {6, 4}, {6, 3}}},
};

void expect_rectangle(const PolygonMesh& mesh, const std::string& name) {
  const Result result = remeshed(mesh);
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true()) << name;
  EXPECT_NEAR(report.input.area, 30, 1e-7) << name;
  EXPECT_NEAR(report.output.area, 30, 1e-7) << name;
  EXPECT_EQ(report.output.faces, 2u) << name;
  EXPECT_EQ(report.output.boundary_edges, 4u) << name;
  EXPECT_EQ(report.input.intersecting_pairs, 0u) << name;
  EXPECT_EQ(count_of(report, DiagnosticCode::kZeroAreaFace), 1u) << name;
  EXPECT_EQ(count_of(report, DiagnosticCode::kNonplanarPolygon), 0u) << name;
}

TEST(spikes, a_rectangle_with_a_spike_is_a_rectangle_wherever_its_corners_begin_and_whichever_way_they_run) {
  for (const Case& spike : kSpikes) {
    std::vector<Vec2> loop = rectangle_with(spike.upper);
    for (std::size_t first = 0; first < loop.size(); ++first) {
      std::rotate(loop.begin(), loop.begin() + 1, loop.end());
      expect_rectangle(shapes::polygon(loop), spike.name);
    }
    std::reverse(loop.begin(), loop.end());
    expect_rectangle(shapes::polygon(loop), spike.name);
  }
}

TEST(spikes, in_any_place_and_position_with_the_noise_of_doubles_a_spike_is_one) {
  for (const Case& spike : kSpikes)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const polygons::Placement place = polygons::random_placement(seed, 1);
      // Every corner is a vertex of its own, rounded by itself.
      std::vector<Vec3> points;
      std::vector<std::uint32_t> loop;
      for (const Vec2 p : rectangle_with(spike.upper)) {
        Vec3 q = place(p);
        for (int axis = 0; axis < 3; ++axis)
          if ((points.size() + static_cast<std::size_t>(axis) + seed) % 3 == 0) q[axis] = std::nextafter(q[axis], 1e9);
        loop.push_back(static_cast<std::uint32_t>(points.size()));
        points.push_back(q);
      }
      expect_rectangle(shapes::from_lists(points, {loop}), spike.name);
    }
}

/// Makes a rectangle of 10 x 3 with a way in its upper side that leaves its plane.
std::vector<Vec3> rectangle_in_space(const std::vector<Vec3>& upper) {
  std::vector<Vec3> loop{{0, 0, 0}, {10, 0, 0}, {10, 3, 0}};
  loop.insert(loop.end(), upper.begin(), upper.end());
  loop.push_back({0, 3, 0});
  return loop;
}

/// Makes a mesh of one polygon. Equal corners are one vertex, as in files that have spikes.
PolygonMesh one_polygon(const std::vector<Vec3>& corners) {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> loop;
  for (const Vec3& p : corners) {
    const auto at = std::find(points.begin(), points.end(), p);
    loop.push_back(static_cast<std::uint32_t>(at - points.begin()));
    if (at == points.end()) points.push_back(p);
  }
  return shapes::from_lists(points, {loop});
}

TEST(spikes, one_that_leaves_the_plane_of_its_polygon_is_one_in_any_place) {
  const std::vector<std::pair<const char*, std::vector<Vec3>>> spikes{
      {"above the rectangle", {{6, 3, 0}, {5, 2, 1}, {6, 3, 0}}},
      {"hardly above it", {{6, 3, 0}, {5, 2, 1e-3}, {6, 3, 0}}},
      {"perpendicular", {{6, 3, 0}, {6, 3, 1}, {6, 3, 0}}},
      {"outside", {{6, 3, 0}, {7, 5, 1}, {6, 3, 0}}},
      {"out, and back into the plane", {{6, 3, 0}, {5, 2, 1}, {4, 1, 0}, {5, 2, 1}, {6, 3, 0}}},
      {"two of them", {{8, 3, 0}, {7, 2, 1}, {8, 3, 0}, {3, 3, 0}, {3, 1, -2}, {3, 3, 0}}},
      {"a part of the way", {{6, 3, 0}, {5, 2, 1}, {5.5, 2.5, 0.5}, {6, 3, 0}}}};
  for (const auto& [name, upper] : spikes)
    for (std::uint64_t seed = 0; seed <= 5; ++seed) {
      const polygons::Placement place = seed == 0 ? polygons::Placement() : polygons::random_placement(seed, 1);
      const Vec3 normal = cross(place.x_axis, place.y_axis);
      std::vector<Vec3> points;
      for (const Vec3& p : rectangle_in_space(upper)) points.push_back(place({p.x, p.y}) + p.z * normal);
      expect_rectangle(one_polygon(points), name);
      // Every corner is a vertex of its own, rounded by itself.
      std::vector<std::uint32_t> loop;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const int axis = static_cast<int>((i + seed) % 3);
        if (i % 2 == 0) points[i][axis] = std::nextafter(points[i][axis], 1e9);
        loop.push_back(static_cast<std::uint32_t>(i));
      }
      expect_rectangle(shapes::from_lists(points, {loop}), name);
    }
}

TEST(spikes, a_closed_solid_with_spikes_out_of_the_planes_of_its_faces_keeps_its_measures) {
  // The box's upper face and the side at y = 3 both run out to one tip, which leaves the plane of one of them or both.
  for (const Vec3& tip : {Vec3{5, 2, 6}, {6, 4, 5}, {6, 3, 9}, {5, 2, 4}})
    for (std::uint64_t seed = 0; seed <= 5; ++seed) {
      const polygons::Placement place = seed == 0 ? polygons::Placement() : polygons::random_placement(seed, 1);
      const Vec3 normal = cross(place.x_axis, place.y_axis);
      std::vector<Vec3> points{{0, 0, 0},  {10, 0, 0}, {10, 3, 0}, {0, 3, 0}, {0, 0, 5},
                               {10, 0, 5}, {10, 3, 5}, {0, 3, 5},  {6, 3, 5}, tip};
      for (Vec3& p : points) p = place({p.x, p.y}) + p.z * normal;
      const Report report = remeshed(shapes::from_lists(points, {{3, 2, 1, 0},
                                                                 {4, 5, 6, 8, 9, 8, 7},
                                                                 {0, 1, 5, 4},
                                                                 {1, 2, 6, 5},
                                                                 {2, 3, 7, 8, 9, 8, 6},
                                                                 {3, 0, 4, 7}}))
                                .report;
      EXPECT_TRUE(report.verified.all_true()) << tip.x << ' ' << tip.z << ' ' << seed;
      EXPECT_NEAR(report.input.area, 190, 1e-9) << tip.x << ' ' << tip.z << ' ' << seed;
      EXPECT_NEAR(report.output.area, 190, 1e-9) << tip.x << ' ' << tip.z << ' ' << seed;
      EXPECT_NEAR(report.output.volume.value_or(0), 150, 1e-9) << tip.x << ' ' << tip.z << ' ' << seed;
      EXPECT_TRUE(report.output.closed) << tip.x << ' ' << tip.z << ' ' << seed;
      EXPECT_EQ(report.output.faces, 12u) << tip.x << ' ' << tip.z << ' ' << seed;
    }
}

TEST(spikes, few_numbers_that_are_rounded_far_from_the_origin_do_not_make_a_fan_of_a_spike) {
  // Few numbers prove no rounding step. Turned and printed with four decimals, the outline crosses itself by chance.
  for (const Case& spike : kSpikes)
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const polygons::Placement place = polygons::random_placement(seed, 1);
      std::vector<Vec3> points;
      double length = 0;
      for (const Vec2 p : rectangle_with(spike.upper)) {
        Vec3 q = place(p) + Vec3{500000, 5000000, 100};
        for (int axis = 0; axis < 3; ++axis) q[axis] = std::round(q[axis] * 1e4) / 1e4;
        if (!points.empty()) length += norm(q - points.back());
        points.push_back(q);
      }
      const Report report = remeshed(one_polygon(points)).report;
      EXPECT_TRUE(report.verified.all_true()) << spike.name << ' ' << seed;
      // Each corner may be off by half a step in each coordinate, and a spike is dropped within 2.6 steps.
      EXPECT_NEAR(report.output.area, 30, 3e-4 * (length + 3)) << spike.name << ' ' << seed;
    }
}

TEST(spikes, a_slit_into_a_polygon_is_right_as_it_was) {
  const Result result = remeshed(shapes::polygon(rectangle_with({{6, 3}, {6, 1}, {6, 3}})));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_DOUBLE_EQ(result.report.input.area, 30);
  EXPECT_DOUBLE_EQ(result.report.output.area, 30);
}

/// Makes a rectangle of 10 x 5 of three parts: two upper ones, and a lower one whose outline runs up between them.
PolygonMesh three_parts(const std::vector<std::uint32_t>& lower, const std::vector<std::uint32_t>& right,
                        const std::vector<std::uint32_t>& left) {
  return shapes::from_lists({{0, 0, 0},
                             {10, 0, 0},
                             {10, 3, 0},
                             {6, 3, 0},
                             {6, 4, 0},
                             {6, 3.5, 0},
                             {0, 3, 0},
                             {10, 5, 0},
                             {6, 5, 0},
                             {0, 5, 0}},
                            {lower, right, left});
}

void expect_whole(const PolygonMesh& mesh) {
  const Result result = remeshed(mesh);
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_DOUBLE_EQ(report.input.area, 50);
  EXPECT_DOUBLE_EQ(report.output.area, 50);
  EXPECT_EQ(report.output.non_manifold_edges, 0u);
  EXPECT_EQ(report.output.boundary_edges, 4u);
  EXPECT_EQ(report.output.faces, 2u);
}

TEST(spikes, neighbours_along_a_spike_meet_when_it_is_gone) {
  expect_whole(three_parts({0, 1, 2, 3, 4, 3, 6}, {3, 2, 7, 8, 4}, {6, 3, 4, 8, 9}));
}

TEST(spikes, neighbours_along_one_that_comes_back_a_part_of_the_way_get_its_vertices) {
  expect_whole(three_parts({0, 1, 2, 3, 4, 5, 6}, {3, 2, 7, 8, 4}, {6, 5, 4, 8, 9}));
}

TEST(spikes, what_neighbours_use_stays_where_the_way_back_is_beside_the_way_out) {
  // The corner that lies back on the way out is off by less than the tolerance, to either side.
  for (const double off : {1e-11, -1e-11}) {
    PolygonMesh mesh = three_parts({0, 1, 2, 3, 4, 5, 6}, {3, 2, 7, 8, 4}, {6, 5, 4, 8, 9});
    mesh.positions[VertexId(5)].x += off;
    const Report report = remeshed(mesh).report;
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_NEAR(report.output.area, 50, 1e-8);
    EXPECT_EQ(report.output.boundary_edges, 4u);
    EXPECT_EQ(report.output.non_manifold_edges, 0u);
  }
}

TEST(spikes, faces_of_three_and_four_corners_that_are_spikes_go) {
  const PolygonMesh sheet = shapes::sheet(2, 1, 2, 1);
  const PolygonMesh spikes = shapes::from_lists({{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}, {{0, 1, 0}, {0, 1, 2, 1}});
  const Report report = remeshed(shapes::joined(sheet, spikes)).report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_DOUBLE_EQ(report.output.area, 2);
  EXPECT_EQ(report.output.faces, 2u);
  EXPECT_EQ(count_of(report, DiagnosticCode::kZeroAreaFace), 2u);
}

TEST(spikes, a_closed_solid_with_a_spike_on_a_cap_keeps_its_volume) {
  // A prism; the outline of its upper cap runs out over the sides' upper edge and back.
  PolygonMesh mesh = shapes::prism({{0, 0}, {10, 0}, {10, 3}, {6, 3}, {0, 3}}, 2);
  const auto tip = mesh.positions.push_back({6, 4, 2});
  PolygonMesh spiked;
  spiked.positions = mesh.positions;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (const VertexId v : mesh.face(FaceId(f))) {
      spiked.corners.push_back(v);
      const bool is_of_cap = mesh.face(FaceId(f)).size() == 5;
      if (is_of_cap && mesh.positions[v] == Vec3{6, 3, 2}) spiked.corners.insert(spiked.corners.end(), {tip, v});
    }
    spiked.face_begin.push_back(static_cast<std::uint32_t>(spiked.corners.size()));
  }
  const Report report = remeshed(spiked).report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_TRUE(report.output.closed);
  EXPECT_DOUBLE_EQ(report.output.volume.value_or(0), 60);
  EXPECT_DOUBLE_EQ(report.input.area, 60 + 52);
  EXPECT_EQ(report.output.faces, 12u);
}

TEST(spikes, the_area_of_a_polygon_that_crosses_itself_is_what_it_winds_around) {
  const std::vector<Vec2> tie{{0, 0}, {3, 1}, {3, 0}, {0, 2}};
  double twice_tie = 0;
  for (std::size_t i = 0; i < tie.size(); ++i) twice_tie += cross(tie[i], tie[(i + 1) % tie.size()]);
  const Report report = remeshed(shapes::polygon(tie)).report;
  EXPECT_NEAR(report.input.area, std::fabs(twice_tie) / 2, 1e-12);
  EXPECT_EQ(count_of(report, DiagnosticCode::kNonplanarPolygon), 1u);
}

TEST(spikes, spike_out_of_the_shared_collection_has_area_30_and_two_faces) {
  const std::string name = "reports/spike-out.obj";
  if (!test::has_shared_mesh(name)) return;
  std::ifstream file(test::shared_meshes_folder() / name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  expect_rectangle(read_mesh(Format::kObj, text, {}, control).mesh, "spike-out.obj");
}

}  // namespace
}  // namespace remesh
