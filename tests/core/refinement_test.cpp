// Tests refinement through the entry of the pipeline: analytic answers, hard inputs, and every option that steers it.
// What is asserted is measured here (tests/support/refined_checks.h), not taken from the report.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "core/io/obj/obj.h"
#include "core/remesh.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/time_limit.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

constexpr double kLengthSlack = 1 + 1e-9;

std::string bytes(const Result& result) {
  RunControl control;
  std::string text = write_obj(result.mesh, {}, control);
  for (const PatchId p : result.face_patch) text += std::to_string(p.value) + ' ';
  return text + listed_in_words(result.report);
}

// A cube with a size.

class refined_cube : public testing::TestWithParam<double> {};

TEST_P(refined_cube, has_even_edges_sizes_and_sides) {
  const double side = GetParam(), size = 0.1 * side;
  const PolygonMesh cube = shapes::box({side, side, side});
  const Options options = with_length(size);
  const Result result = refined(cube, options);
  expect_promises(cube, options, result);
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_NEAR(*result.report.output.volume / (side * side * side), 1, 1e-12);
  EXPECT_LE(longest_edge(result.mesh), size * kLengthSlack);
  EXPECT_GE(smallest_angle_deg(result.mesh), 25);
  EXPECT_LE(result.mesh.faces.size(), 2600u);
  EXPECT_EQ(listed(result.report), 0u);

  // On each edge of the cube, there is a vertex at each tenth, and no other.
  std::map<std::pair<int, std::pair<double, double>>, std::vector<double>> on_edge;
  for (const Vec3& p : result.mesh.positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double u = p[(axis + 1) % 3], v = p[(axis + 2) % 3];
      if ((u == 0 || u == side) && (v == 0 || v == side)) on_edge[{axis, {u, v}}].push_back(p[axis]);
    }
  ASSERT_EQ(on_edge.size(), 12u);
  for (auto& [edge, places] : on_edge) {
    std::sort(places.begin(), places.end());
    ASSERT_EQ(places.size(), 11u);
    for (std::size_t i = 0; i <= 10; ++i) EXPECT_NEAR(places[i], size * static_cast<double>(i), 1e-12 * side);
  }

  const auto [least, most] =
      std::minmax_element(result.report.patches.begin(), result.report.patches.end(),
                          [](const auto& a, const auto& b) { return a.output_faces < b.output_faces; });
  EXPECT_LE(static_cast<double>(most->output_faces), 1.05 * static_cast<double>(least->output_faces));
}

INSTANTIATE_TEST_SUITE_P(, refined_cube, testing::Values(1.0, 3.7, 1e-6, 1e9));

// Hard inputs: they end, and what is left is said.

struct HardCase {
  std::string name;
  std::function<PolygonMesh()> make;
  std::optional<std::uint64_t> max_faces;

  friend std::ostream& operator<<(std::ostream& out, const HardCase& hard) { return out << hard.name; }
};

class hard_input : public testing::TestWithParam<std::tuple<HardCase, double>> {};

TEST_P(hard_input, ends_soon_and_says_what_is_left) {
  const auto& [hard, degrees] = GetParam();
  const PolygonMesh mesh = hard.make();
  Options options = with_angle(degrees);
  options.max_output_faces = hard.max_faces;
  Result result;
  // The promise is 10 s. It takes a few seconds of two threads together.
  test::expect_within(test::Seconds(30), [&] { result = refined(mesh, options); });
  expect_promises(mesh, options, result);
  if (hard.max_faces) {
    EXPECT_LE(result.mesh.faces.size(), *hard.max_faces);
  }
  EXPECT_TRUE(hard.max_faces || listed(result.report, UnrefinedReason::kBudget) == 0);
}

PolygonMesh thin_wedge() { return shapes::polygon({{0, 0}, {1, 0}, {std::cos(0.0174532925), std::sin(0.0174532925)}}); }

INSTANTIATE_TEST_SUITE_P(
    , hard_input,
    testing::Combine(
        testing::Values(HardCase{"a_wedge_of_one_degree", thin_wedge, {}},
                        HardCase{"a_solid_wedge_of_one_degree",
                                 [] {
                                   return shapes::prism({{0, 0}, {1, 0}, {1, 0.0174550649}}, 0.3);
                                 },
                                 {}},
                        HardCase{"a_wedge_beside_a_square",
                                 [] {
                                   return shapes::polygon({{0, 0}, {4, 0}, {4, -1}, {5, -1}, {5, 0.0872}});
                                 },
                                 {}},
                        HardCase{"needles_around_a_vertex", [] { return solids::needle_fan(50, 1); }, {}},
                        HardCase{"a_plate_a_million_times_as_wide_as_high",
                                 [] {
                                   return shapes::box({1e6, 1e6, 1});
                                 },
                                 20'000},
                        HardCase{"the_same_plate_with_room_for_ten_times_as_many_faces",
                                 [] {
                                   return shapes::box({1e6, 1e6, 1});
                                 },
                                 200'000},
                        HardCase{"a_bar_a_million_times_as_long_as_wide",
                                 [] {
                                   return shapes::box({1e6, 1, 1});
                                 },
                                 20'000},
                        HardCase{"squares_a_billionth_apart", [] { return solids::nested_squares(3, 1e-9); }, 20'000},
                        HardCase{"squares_a_millionth_apart", [] { return solids::nested_squares(3, 1e-6); }, 20'000},
                        HardCase{"a_thousand_holes", [] { return solids::region(polygons::sieve(32)); }, {}},
                        HardCase{"a_comb", [] { return solids::region(polygons::comb(20, 100)); }, {}}),
        testing::Values(25.0, 30.0, 33.0)),
    [](const auto& info) {
      return std::get<0>(info.param).name + "_at_" + std::to_string(static_cast<int>(std::get<1>(info.param)));
    });

TEST(refinement, a_triangle_that_is_a_wedge_stays_as_it_is) {
  const Result result = refined(thin_wedge());
  EXPECT_EQ(result.mesh.faces.size(), 1u);
  EXPECT_EQ(listed(result.report, UnrefinedReason::kInputAngle), 1u);
}

// The same result.

std::vector<std::pair<PolygonMesh, Options>> various() {
  Options fine = with_angle(30);
  fine.max_edge_length = 0.15;
  Options close;
  close.proximity = 1;
  Options few = with_length(0.1);
  few.max_output_faces = 7000;
  return {{solids::extrusion(polygons::star_with_holes(7, 30, 3), 0.3), {}},
          {solids::cut_cube(3, 20), with_angle(28)},
          {shapes::blocks({"##.", ".##", "##."}), fine},
          {solids::tube(2, 1, 0.1), close},
          {shapes::box({2, 2, 2}), few},
          {solids::needle_fan(20, 3), with_angle(30)}};
}

STAGE(refined, test::kWorkers, test::kScale) {
  for (auto [mesh, options] : various()) {
    if (options.max_edge_length) *options.max_edge_length *= trial.scale;
    const Result result = refined(trial.of(mesh), options, trial.workers);
    trial.mesh(result.mesh);
    trial.in_order(result.face_patch, listed_in_words(result.report));
  }
}

TEST(refinement, turned_moved_scaled_and_renumbered_inputs_have_nearly_as_many_faces) {
  for (const auto& [mesh, options] : various()) {
    if (options.max_output_faces) continue;
    const Result expected = refined(mesh, options);
    const auto faces = static_cast<double>(expected.mesh.faces.size());
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const PolygonMesh other = shapes::moved(
          shapes::rotated(shapes::renumbered(mesh, seed), {1, 2.0 * seed, -3}, 40 * seed), {1, -2, 0.5 * seed});
      const Result result = refined(other, options);
      SCOPED_TRACE(result.report.input.faces);
      expect_promises(other, options, result);
      EXPECT_NEAR(static_cast<double>(result.mesh.faces.size()) / faces, 1, 0.06);
      EXPECT_EQ(result.report.patches.size(), expected.report.patches.size());
    }
    Options options3 = options;
    if (options3.max_edge_length) *options3.max_edge_length *= 3;
    const Result scaled = refined(shapes::scaled(mesh, 3), options3);
    EXPECT_NEAR(static_cast<double>(scaled.mesh.faces.size()) / faces, 1, 0.06);
  }
}

/// A strip of width w and length L is filled by triangles with two equal sides. It needs L / (2 w / tan angle) of them
/// on either side, and half of one at each end.
TEST(refinement, facets_of_a_cylinder_get_hardly_more_faces_than_they_need) {
  for (const double bound : {20.0, 25.0, 33.0})
    for (const auto& [sides, height] : {std::pair(12, 40.0), std::pair(64, 10.0), std::pair(360, 2.0)}) {
      const double width = 2 * std::sin(std::numbers::pi / sides);
      const double angle = std::max(bound, 30.0) * std::numbers::pi / 180;
      const double of_strip = 2 * std::ceil(height / (2 * width / std::tan(angle))) + 1;
      const PolygonMesh cylinder = shapes::cylinder(sides, 1, height);
      const Result cap = refined(shapes::polygon([&, sides = sides] {
                                   std::vector<Vec2> corners;
                                   for (int i = 0; i < sides; ++i) {
                                     const double turn = 2 * std::numbers::pi * i / sides;
                                     corners.push_back({std::cos(turn), std::sin(turn)});
                                   }
                                   return corners;
                                 }()),
                                 with_angle(bound));
      Options options = with_angle(bound);
      options.min_edge_length = 0;
      const Result result = refined(cylinder, options);
      EXPECT_EQ(listed(result.report), 0u);
      EXPECT_GE(smallest_angle_deg(result.mesh), bound);
      EXPECT_LE(static_cast<double>(result.mesh.faces.size()),
                1.1 * (sides * of_strip + 2 * static_cast<double>(cap.mesh.faces.size())))
          << sides << " facets at " << bound;
      if (sides < 100) expect_promises(cylinder, with_angle(bound), result);
    }
}

/// Makes a bar with four chamfers along it that are narrower than a row of equilateral triangles of its size is high.
PolygonMesh chamfered_bar(double length, double thickness, double cut) {
  return shapes::prism({{cut, 0},
                        {1 - cut, 0},
                        {1, cut},
                        {1, thickness - cut},
                        {1 - cut, thickness},
                        {cut, thickness},
                        {0, thickness - cut},
                        {0, cut}},
                       length);
}

TEST(refinement, strips_narrower_than_a_row_for_the_size_have_no_points_inside) {
  const double length = 6, size = 0.25;
  Options everywhere, by_gap;
  everywhere.max_edge_length = size;
  by_gap.proximity = 1;
  struct Case {
    Options options;
    double thickness, cut;
  };
  for (const Case& c : {Case{everywhere, 0.5, 0.073}, Case{everywhere, 0.5, 0.113}, Case{by_gap, size, 0.073}}) {
    const PolygonMesh bar = chamfered_bar(length, c.thickness, c.cut);
    const Result result = refined(bar, c.options);
    expect_promises(bar, c.options, result);
    std::size_t on_chamfers = 0;
    for (const Triangle& t : result.mesh.faces) {
      const auto& at = result.mesh.positions;
      const Vec3 normal = normalized(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]));
      on_chamfers += std::fabs(std::fabs(normal.x) - std::fabs(normal.y)) < 1e-6 && std::fabs(normal.z) < 0.5;
    }
    // On either side of each chamfer there are as many pieces as its size asks for, and one more where the two sides
    // take turns.
    const double least = std::min(size, result.report.smallest_gap.value_or(size));
    EXPECT_LE(static_cast<double>(on_chamfers), 4 * (2 * std::ceil(length / least) + 2)) << c.cut;
    EXPECT_GE(static_cast<double>(on_chamfers), 4 * 2 * std::floor(length / size)) << c.cut;
  }
}

TEST(refinement, strips_keep_the_shortest_edge_where_sizes_vary) {
  // A small cube hovers over the chamfer of a long bar: the size there is much less than along the rest of it.
  const double c = 10 - std::sqrt(0.125), off = 0.05 * std::sqrt(0.5), side = 0.3 * std::sqrt(0.5);
  const PolygonMesh bar = shapes::prism({{0, 0}, {10, 0}, {10, c}, {c, 10}, {0, 10}}, 100);
  const double middle = (10 + c) / 2 + off;
  const PolygonMesh cube = shapes::moved(shapes::prism({{middle + side / 2, middle - side / 2},
                                                        {middle + 3 * side / 2, middle + side / 2},
                                                        {middle + side / 2, middle + 3 * side / 2},
                                                        {middle - side / 2, middle + side / 2}},
                                                       0.3),
                                         {0, 0, 52.95});
  const PolygonMesh mesh = shapes::joined(bar, cube);
  for (const double least : {0.1, 0.2}) {
    Options options;
    options.proximity = 1;
    options.min_edge_length = least;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    // The gap is smaller than the shortest edge: that is listed, and nothing else is missed for it.
    EXPECT_GT(listed(result.report, UnrefinedReason::kMinEdgeLength), 0u) << least;
    EXPECT_EQ(listed(result.report, UnrefinedReason::kSizeFloor), 0u) << least;
    EXPECT_GE(smallest_angle_deg(result.mesh), 25);
  }
}

TEST(refinement, faces_along_strips_are_foreseen) {
  const auto chamfered = [](double width) {
    return shapes::prism({{0, 0}, {1, 0}, {1, 1 - width}, {1 - width, 1}, {0, 1}}, 1);
  };
  for (const PolygonMesh& mesh :
       {chamfered(1e-2), chamfered(1e-3), chamfered(1e-4), shapes::cylinder(32, 1, 40), shapes::cylinder(360, 1, 5),
        shapes::rotated(shapes::box({1, 0.01, 3}), {1, 2, 3}, 40)}) {
    Options options;
    options.min_edge_length = 0;
    const auto made = static_cast<double>(refined(mesh, options).mesh.faces.size());
    EXPECT_GT(predicted_faces(mesh, options), made / 2);
    EXPECT_LT(predicted_faces(mesh, options), made * 2);
  }
}

// Options.

TEST(refinement, without_it_nothing_is_inserted_and_there_is_no_verdict_on_quality) {
  Options options;
  options.refine = false;
  options.max_edge_length = 0.1;
  const Result result = refined(shapes::box({1, 1, 1}, 3), options);
  EXPECT_EQ(result.mesh.faces.size(), 12u);
  EXPECT_FALSE(result.report.verified.quality.has_value());
  EXPECT_TRUE(result.report.unrefined.empty());
}

TEST(refinement, the_default_bound_is_25_degrees_and_a_ratio_says_the_same) {
  const PolygonMesh mesh = shapes::box({1, 2, 7});
  const Result result = refined(mesh);
  expect_promises(mesh, {}, result);
  EXPECT_GE(smallest_angle_deg(result.mesh), 25);
  Options ratio;
  ratio.max_radius_edge_ratio = 0.5 / std::sin(25 * 3.14159265358979324 / 180);
  EXPECT_EQ(bytes(refined(mesh, ratio)), bytes(result));
}

TEST(refinement, sizes_alone_are_met_without_a_bound_on_angles) {
  Options options = with_angle(0);
  options.max_edge_length = 0.21;
  const PolygonMesh mesh = shapes::l_bracket();
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_LE(longest_edge(result.mesh), 0.21 * kLengthSlack);
  EXPECT_EQ(listed(result.report), 0u);
}

/// No set of triangles with edges up to h has fewer than the area over that of the equilateral one.
TEST(refinement, sizes_take_few_more_faces_than_equilateral_triangles_would) {
  const std::tuple<double, double, double> cases[] = {{13.3, 17.1, 0.5}, {13.3, 17.1, 1}, {13.3, 17.1, 2},
                                                      {41.597, 48, 1},   {10, 10, 0.5},   {30, 7, 0.5}};
  for (const auto& [width, height, size] : cases) {
    Options options = with_length(size);
    options.min_angle_deg = 20;
    const double fewest = width * height / (std::numbers::sqrt3 / 4 * size * size);
    // Next to the sides nothing fits, along one layer or so.
    const double beside = 2 * (width + height) / size;
    for (const double turned : {0.0, 20.0}) {
      const PolygonMesh sheet =
          shapes::rotated(shapes::polygon({{0, 0}, {width, 0}, {width, height}, {0, height}}), {1, 2, 3}, turned);
      const Result result = refined(sheet, options);
      expect_promises(sheet, options, result);
      EXPECT_EQ(listed(result.report), 0u);
      EXPECT_LE(static_cast<double>(result.mesh.faces.size()), 1.1 * fewest + beside)
          << width << " x " << height << " by " << size << " turned by " << turned;
    }
  }
}

TEST(refinement, a_fraction_is_of_the_boxs_diagonal) {
  const PolygonMesh mesh = shapes::box({1, 2, 2});
  Options fraction;
  fraction.max_edge_fraction = 0.125;
  EXPECT_EQ(bytes(refined(mesh, fraction)), bytes(refined(mesh, with_length(0.375))));
}

TEST(refinement, no_triangle_is_larger_than_the_largest_area) {
  for (const double area : {0.1, 0.01, 0.001}) {
    Options options;
    options.max_area = area;
    const PolygonMesh mesh = shapes::box({1, 2, 1});
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_EQ(listed(result.report), 0u);
    // It is no more than about twice as fine as asked.
    EXPECT_LT(static_cast<double>(result.mesh.faces.size()), 10 / area * 2.2);
  }
}

TEST(refinement, it_makes_nothing_shorter_than_the_shortest_edge) {
  const PolygonMesh mesh = solids::extrusion(polygons::star_with_holes(3, 40, 3), 0.1);
  const double own = shortest_edge(refined(mesh, with_angle(0)).mesh);
  for (const double length : {0.3 * own, own, 3 * own}) {
    Options options = with_angle(30);
    options.min_edge_length = length;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_GE(shortest_edge(result.mesh), std::min(own, length) / kLengthSlack);
  }
}

TEST(refinement, the_shortest_edge_goes_before_the_longest) {
  // Edges of the cube: six parts are too long, seven too short.
  Options options = with_length(0.16);
  options.min_edge_length = 0.15;
  const PolygonMesh mesh = shapes::box({1, 1, 1});
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_GE(shortest_edge(result.mesh), 0.15 / kLengthSlack);
  EXPECT_GT(listed(result.report, UnrefinedReason::kMinEdgeLength), 0u);
}

TEST(refinement, what_only_the_shortest_edge_forbids_is_listed_as_that) {
  // Corners under 60 degrees, where pieces have to be longer so that edges across are not too short; a strip that is
  // narrower than it; and triangles inside that need points near both.
  const PolygonMesh meshes[] = {shapes::triangle(40, 1, 1), shapes::triangle(12, 1, 0.8), solids::tube(1, 1, 0.04),
                                solids::extrusion(polygons::star_with_holes(3, 40, 3), 0.1)};
  for (const PolygonMesh& mesh : meshes) {
    Options options = with_angle(30);
    options.max_edge_length = 0.15;
    const Result free = refined(mesh, options);
    const std::uint64_t at_corners =
        listed(free.report, UnrefinedReason::kInputAngle) + listed(free.report, UnrefinedReason::kAcrossInputAngle);
    ASSERT_EQ(listed(free.report), at_corners) << listed_in_words(free.report);
    options.min_edge_length = 0.07;
    const Result limited = refined(mesh, options);
    expect_promises(mesh, options, limited);
    EXPECT_GT(listed(limited.report, UnrefinedReason::kMinEdgeLength), 0u) << listed_in_words(limited.report);
    EXPECT_EQ(listed(limited.report, UnrefinedReason::kSizeFloor), 0u) << listed_in_words(limited.report);
    EXPECT_EQ(listed(limited.report, UnrefinedReason::kBoundaryLocked), 0u) << listed_in_words(limited.report);
  }
}

TEST(refinement, what_the_shortest_edge_does_not_forbid_is_not_listed_as_that) {
  // Sides of 0.05 cannot be cut across for the shortest edge; but where no boundary is split, not for it alone.
  Options options = with_length(0.2);
  options.min_edge_length = 0.1;
  const PolygonMesh mesh = shapes::box({1, 1, 0.05});
  const Result limited = refined(mesh, options);
  EXPECT_GT(listed(limited.report, UnrefinedReason::kMinEdgeLength), 0u);
  EXPECT_EQ(listed(limited.report, UnrefinedReason::kBoundaryLocked), 0u) << listed_in_words(limited.report);
  options.split_boundaries = false;
  const Result locked = refined(mesh, options);
  EXPECT_GT(listed(locked.report, UnrefinedReason::kBoundaryLocked), 0u);
  EXPECT_EQ(listed(locked.report, UnrefinedReason::kMinEdgeLength), 0u) << listed_in_words(locked.report);
}

/// Returns the number of vertices of the output on an edge of the box [0, size]^3.
std::size_t vertices_on_box_edges(const TriangleMesh& mesh, double size) {
  std::size_t count = 0;
  for (const Vec3& p : mesh.positions) {
    int faces = 0;
    for (int axis = 0; axis < 3; ++axis) faces += p[axis] == 0 || p[axis] == size;
    count += faces >= 2;
  }
  return count;
}

TEST(refinement, a_shortest_edge_of_nearly_half_the_longest_leaves_nothing_unrefined) {
  const std::tuple<Vec3, double, double> cases[] = {{{0.23, 0.23, 0.23}, 0.1, 0.039},
                                                    {{0.155, 0.155, 1}, 0.1, 0.039},
                                                    {{0.31, 0.52, 1.04}, 0.1, 0.045},
                                                    {{1.05, 1.365, 0.945}, 0.1, 0.05}};
  for (const auto& [size, longest, shortest] : cases) {
    Options options = with_length(longest);
    options.min_edge_length = shortest;
    const PolygonMesh box = shapes::box(size);
    const Result result = refined(box, options);
    expect_promises(box, options, result);
    EXPECT_EQ(listed(result.report), 0u) << size.x << " x " << size.y << " x " << size.z;
    EXPECT_LE(longest_edge(result.mesh), longest * (1 + 1e-9));
  }
}

TEST(refinement, a_fin_that_stands_inside_a_facet_is_cut_alike_by_all_its_patches) {
  // The foot of the fin is a slit of the square: one patch has it on both sides, and the fin's patch has it as well.
  // No two edges of the input meet under less than 60 degrees, so every angle can be as large as was asked for.
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Vec3 foot{random.uniform(0.5, 3), random.uniform(2, 8), 0}, end{random.uniform(7, 9.5), foot.y, 0};
    const Vec3 up{0, 0, random.uniform(0.2, 1.5)};
    const PolygonMesh mesh =
        shapes::from_lists({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, foot, end, end + up, foot + up},
                           {{0, 1, 5}, {0, 5, 4}, {1, 2, 5}, {2, 3, 4}, {2, 4, 5}, {3, 0, 4}, {4, 5, 6}, {4, 6, 7}});
    const Options options = with_angle(30);
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_EQ(listed(result.report), 0u) << "seed " << seed;
  }
}

TEST(refinement, boundaries_that_must_not_be_split_get_no_vertex) {
  for (const double length : {0.5, 0.1}) {
    Options options = with_length(length);
    options.split_boundaries = false;
    const PolygonMesh mesh = shapes::box({1, 1, 1});
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_EQ(vertices_on_box_edges(result.mesh, 1), 8u);
    EXPECT_GT(listed(result.report, UnrefinedReason::kBoundaryLocked), 0u);
    EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kBoundaryLocked));
    // Bounds that cannot be met cost no faces: there are no more than if the boundaries could be split.
    EXPECT_LE(result.mesh.faces.size(), refined(mesh, with_length(length)).mesh.faces.size());
  }
}

TEST(refinement, away_from_boundaries_that_must_not_be_split_bounds_are_met) {
  // The sides are 10 to 50 times as long as the size. It does not matter how the part lies in space.
  for (const double length : {0.1, 0.04, 0.02}) {
    std::vector<double> faces;
    for (const double degrees : {0.0, 33.0}) {
      const PolygonMesh box = shapes::rotated(shapes::box({1, 1, 1}), {1, 2, 3}, degrees);
      Options options = with_length(length);
      options.split_boundaries = false;
      const Result result = refined(box, options);
      expect_promises(box, options, result);
      EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kBoundaryLocked));
      // The part of a square that is farther from its sides than a third of their length is a ninth of its area.
      // It must be filled.
      const double ideal = std::sqrt(3) / 4 * length * length;
      EXPECT_GT(static_cast<double>(result.mesh.faces.size() - listed(result.report)), 6.0 / 9 / ideal);
      faces.push_back(static_cast<double>(result.mesh.faces.size()));
      EXPECT_LT(faces.back() / 2, predicted_faces(box, options));
      EXPECT_GT(faces.back() * 2, predicted_faces(box, options));
    }
    EXPECT_NEAR(faces[1] / faces[0], 1, 0.1);
  }
}

TEST(refinement, over_boundaries_that_must_not_be_split_triangles_do_not_get_flatter) {
  // A frame as wide as the size, its sides eight times as long.
  Options options = with_length(1);
  options.split_boundaries = false;
  const PolygonMesh frame = shapes::flat({"########", "#......#", "#......#", "#......#", "#......#", "########"});
  const PolygonMesh strip = shapes::polygon({{0, 0}, {8, 0}, {7, 1}, {1, 1}});
  for (const PolygonMesh& mesh : {frame, strip}) {
    const Result result = refined(mesh, options), before = refined(mesh, [] {
                                                    Options none;
                                                    none.refine = false;
                                                    return none;
                                                  }());
    expect_promises(mesh, options, result);
    EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kBoundaryLocked));
    EXPECT_GE(smallest_angle_deg(result.mesh), 0.9 * smallest_angle_deg(before.mesh));
    EXPECT_LE(result.mesh.faces.size(), 100u);
  }
}

TEST(refinement, boundary_vertices_that_are_to_stay_do) {
  Options options = with_length(0.3);
  options.keep_boundary_vertices = true;
  const PolygonMesh mesh = shapes::box({1, 1, 1}, 3);
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  const std::set<Vec3> output(result.mesh.positions.begin(), result.mesh.positions.end());
  std::size_t count = 0;
  for (const Vec3& p : mesh.positions) {
    int faces = 0;
    for (int axis = 0; axis < 3; ++axis) faces += p[axis] == 0 || p[axis] == 1;
    if (faces < 2) continue;
    ++count;
    EXPECT_TRUE(output.count(p));
  }
  EXPECT_EQ(count, 8u + 12 * 2) << "its corners, and two vertices inside each edge";
}

TEST(refinement, labels_are_boundaries_that_are_cut_alike_on_both_sides) {
  PolygonMesh mesh = shapes::sheet(2, 1, 2, 1);
  mesh.labels.group.names = {"left", "right"};
  mesh.labels.group.of_face.items() = {0, 0, 1, 1};
  const Result result = refined(mesh, with_length(0.17));
  ASSERT_TRUE(result.report.verified.all_true());
  for (std::uint32_t f = 0; f < result.mesh.faces.size(); ++f) {
    const Triangle& t = result.mesh.faces[FaceId(f)];
    for (const VertexId v : t) {
      const double x = result.mesh.positions[v].x;
      EXPECT_TRUE(result.mesh.labels.group.of_face[FaceId(f)] == 0 ? x <= 1 : x >= 1);
    }
  }
}

// Stopping.

TEST(refinement, a_stop_while_refining_is_obeyed_soon) {
  Options large = with_angle(25);
  large.max_output_faces = 200'000;
  large.min_edge_length = 0;
  const std::vector<std::pair<PolygonMesh, Options>> cases = {
      {shapes::box({1e6, 1e6, 1}), large},
      {shapes::box({1, 1, 1}), with_length(0.002)},
      {solids::region(polygons::star_with_holes(1, 20'000, 60)), with_angle(33)}};
  for (const auto& one : cases)
    for (const int wait_ms : {50, 300, 1000}) {
      const auto took = test::time_to_stop(std::chrono::milliseconds(wait_ms), [&](RunControl& control) {
        remesh_surface(one.first, one.second, {2, false}, control);
      });
      // The promise is 100 ms, which are 200 ms of two threads.
      if (took) test::expect_within(test::Seconds(1), *took, "asked after " + std::to_string(wait_ms) + " ms");
    }
}

// Surfaces that share more than edges.

TEST(refinement, two_sheets_in_one_place_stay_two_and_meet_the_goals) {
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}});
  for (const double length : {1.0, 0.3, 0.07}) {
    const Options options = with_length(length);
    const Result result = refined(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_TRUE(result.report.output.closed);
    EXPECT_NEAR(result.report.output.area, 2, 1e-12);
    EXPECT_EQ(faces_beyond(result.mesh, bounds_of(options), 1e-8).size(), 0u);
    EXPECT_EQ(listed(result.report), 0u);
  }
}

TEST(refinement, bodies_that_share_walls_meet_the_angle_bound) {
  for (const int boxes : {2, 5})
    for (const double length : {1.0, 3.7, 10.0, 40.0}) {
      Options options;
      options.min_angle_deg = 28;
      const Result result = refined(solids::stacked_boxes(boxes, length), options);
      EXPECT_TRUE(result.report.verified.all_true()) << length;
      EXPECT_GE(result.report.output.quality.min_angle_deg, *options.min_angle_deg) << boxes << " of " << length;
      EXPECT_EQ(listed(result.report), 0u) << length;
      EXPECT_NEAR(result.report.output.area, boxes * (2 * length + 2 + 2 * length), 1e-9 * length);
    }
}

TEST(refinement, pages_on_one_spine_cut_it_alike) {
  const PolygonMesh mesh = shapes::three_pages();
  const Options options = with_length(0.2);
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_EQ(result.report.output.non_manifold_edges, 5u);
}

TEST(refinement, with_boundaries_locked_no_face_crosses_a_nearly_flat_neighbours) {
  for (int seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const PolygonMesh prism = shapes::rounded(shapes::rotated(shapes::cylinder(5 + seed, 1, 0.3 + random.unit()),
                                                              {random.unit(), 1, random.unit()}, 360 * random.unit()),
                                              1e-6);
    Options options;
    options.split_boundaries = false;
    RunControl control;
    const Result result = remesh_surface(prism, options, RunSettings{}, control);
    EXPECT_TRUE(result.report.verified.all_true()) << seed;
    EXPECT_EQ(result.report.input.intersecting_pairs, 0u) << seed;
    EXPECT_EQ(result.report.output.intersecting_pairs, 0u) << seed;
  }
}

}  // namespace
}  // namespace remesh
