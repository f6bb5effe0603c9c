#include "core/refinement/refiner/lattice_fill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/triangulation/patch_triangulation.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"

namespace remesh {
namespace {

/// A region in triangles. Its boundary is cut into pieces that are no longer than the size there.
struct Region {
  std::vector<std::array<Vec2, 3>> triangles;
  std::vector<Vec2> boundary;
  std::size_t vertex_count = 0;
};

Region region(const polygons::Polygon& polygon, const PlaneSizes& sizes) {
  polygons::Polygon cut;
  Region result;
  const auto cut_loop = [&](const polygons::Loop& loop) {
    polygons::Loop pieces;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
      const double size = std::min(sizes.at(a), sizes.at(b));
      const int n = static_cast<int>(std::ceil(norm(b - a) / size * (1 - 1e-11)));
      for (int k = 0; k < n; ++k) pieces.push_back(a + (static_cast<double>(k) / n) * (b - a));
    }
    return pieces;
  };
  cut.outer = cut_loop(polygon.outer);
  for (const polygons::Loop& hole : polygon.holes) cut.holes.push_back(cut_loop(hole));
  const polygons::PatchInput input = polygons::patch_input(cut);
  RunControl control;
  const PatchTriangulation made = triangulate_patch(input.points, input.edges, control);
  EXPECT_EQ(made.outcome, TriangulationOutcome::kDone);
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); h += 3)
    result.triangles.push_back(
        {input.points[made.mesh.from(h)], input.points[made.mesh.from(h + 1)], input.points[made.mesh.from(h + 2)]});
  result.boundary = input.points;
  result.vertex_count = input.points.size();
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); ++h)
    if (made.mesh.is_constrained(h))
      result.boundary.push_back(0.5 * (input.points[made.mesh.from(h)] + input.points[made.mesh.to(h)]));
  return result;
}

PlaneSizes uniform(double size) {
  return {[size](Vec2) { return size; }, [size](double length, Vec2, double) { return length <= size; }};
}
/// Returns sizes that are `least` up to x = 0 and grow with x from there.
PlaneSizes growing(double least, double slope) {
  const auto at = [=](Vec2 p) { return least + slope * std::max(0.0, p.x); };
  return {at, [=](double length, Vec2 p, double radius) { return length <= at({p.x - radius, p.y}); }, false};
}

std::vector<Vec2> fill(const Region& region, const PlaneSizes& sizes, std::size_t most = 1'000'000,
                       double shortest = 0) {
  RunControl control;
  return lattice_fill(region.triangles, region.boundary, region.vertex_count, sizes, shortest, most, control);
}

bool is_inside(const Region& region, Vec2 p) {
  return std::any_of(region.triangles.begin(), region.triangles.end(), [&](const auto& t) {
    return cross(t[1] - t[0], p - t[0]) >= 0 && cross(t[2] - t[1], p - t[1]) >= 0 && cross(t[0] - t[2], p - t[2]) >= 0;
  });
}

/// Returns the distance from p to the nearest of the other points.
double nearest(const std::vector<Vec2>& points, Vec2 p) {
  double least = HUGE_VAL;
  for (const Vec2 q : points)
    if (q != p) least = std::min(least, norm(q - p));
  return least;
}

const polygons::Polygon& square() {
  static const polygons::Polygon polygon{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}};
  return polygon;
}

/// Expects that the points are inside the region, and neither too near to each other nor too far apart.
/// Input:  `column` is the width of a column of the lattice that fits the region's box, in sizes.
void expect_holds(const Region& region, const PlaneSizes& sizes, double column = 1) {
  const std::vector<Vec2> points = fill(region, sizes);
  ASSERT_GT(points.size(), 20u);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end());
  std::vector<Vec2> all = points;
  all.insert(all.end(), region.boundary.begin(), region.boundary.end());
  for (const Vec2 p : points) {
    ASSERT_TRUE(is_inside(region, p));
    EXPECT_GE(nearest(region.boundary, p), 0.49 * column * sizes.at(p));
    // No further from the others than the size, no nearer than the finest lattice beside it.
    EXPECT_LE(nearest(all, p), sizes.at(p) * (1 + 1e-9));
    EXPECT_GE(nearest(points, p), 0.25 * sizes.at(p));
  }
  // No hole is left: wherever one stands, a point or the boundary is near.
  for (const auto& t : region.triangles) {
    const Vec2 centre = (1.0 / 3) * (t[0] + t[1] + t[2]);
    EXPECT_LE(nearest(all, centre), 1.2 * sizes.at(centre));
  }
}

TEST(lattice_fill, of_one_size_it_is_a_lattice_away_from_the_boundary) {
  const auto column = [](const Region& region, double size) {
    const auto [left, right] = std::minmax_element(region.boundary.begin(), region.boundary.end());
    const double columns = (right->x - left->x) / size;
    return columns / std::ceil(columns * (1 - 1e-11));
  };
  for (const double size : {0.1, 0.095, 0.03}) {
    const Region of_square = region(square(), uniform(size));
    expect_holds(of_square, uniform(size), column(of_square, size));
  }
  const Region star = region(polygons::star_with_holes(2, 30, 2), uniform(0.04));
  expect_holds(star, uniform(0.04), column(star, 0.04));
}

TEST(lattice_fill, of_sizes_that_grow_it_is_as_coarse_as_they_allow) {
  for (const double slope : {0.1, 0.4}) {
    const PlaneSizes sizes = growing(0.02, slope);
    expect_holds(region(square(), sizes), sizes);
  }
}

TEST(lattice_fill, however_steeply_sizes_grow_few_places_are_looked_at) {
  // Already at a hair from the left side, sizes are as large as they may be. Near that side, cells would be cut until
  // they are as small as a hair.
  PlaneSizes sizes = growing(0.1, 1e9);
  std::size_t asked = 0;
  sizes.allows = [&asked, allows = sizes.allows](double length, Vec2 p, double radius) {
    ++asked;
    return allows(length, p, radius);
  };
  fill(region(square(), sizes), sizes);
  EXPECT_GT(asked, 0u);
  EXPECT_LT(asked, 10'000u);
}

STAGE(lattice_fill, test::kScale, test::kStop) {
  Region filled = region(square(), uniform(0.07));
  for (auto& t : filled.triangles)
    for (Vec2& p : t) p = trial.scale * p;
  for (Vec2& p : filled.boundary) p = trial.scale * p;
  for (const Vec2 p : lattice_fill(filled.triangles, filled.boundary, filled.vertex_count, uniform(trial.scale * 0.07),
                                   0, 1'000'000, trial.control))
    trial.in_order(trial.length(p));
}

TEST(lattice_fill, a_side_that_is_a_whole_number_of_sizes_has_that_many_whatever_its_length) {
  const std::size_t expected = fill(region(square(), uniform(0.1)), uniform(0.1)).size();
  for (const double length : {3.0, 3.7, 0.3, 7.1, 1e-3, 123.0})
    for (const double hair : {1.0, 1 - 1e-12, 1 + 1e-12}) {  // what rounding to the patch's grid may do
      const double side = hair * length;
      const PlaneSizes sizes = uniform(0.1 * length);
      const polygons::Polygon other{{{0, 0}, {side, 0}, {side, side}, {0, side}}, {}};
      EXPECT_EQ(fill(region(other, sizes), sizes).size(), expected) << side;
    }
}

TEST(lattice_fill, every_second_row_ends_half_a_column_from_the_sides) {
  // 6.8 sizes are seven columns; of nine rows every second one has seven points, the others six between corners.
  const double size = 1, width = 6.8, height = 7.6;
  const polygons::Polygon plate{{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}};
  const std::vector<Vec2> points = fill(region(plate, uniform(size)), uniform(size));
  EXPECT_EQ(points.size(), 4u * 7 + 4u * 6);
}

TEST(lattice_fill, rows_begin_as_the_vertices_along_the_lowest_side_do) {
  const double height = std::sqrt(3) * (1 - 1e-6);  // two rows
  for (const double first : {1.0, 0.5}) {
    polygons::Polygon plate{{{0, 0}}, {}};
    for (int k = 0; first + k < 10; ++k) plate.outer.push_back({first + k, 0});
    for (const Vec2 p : {Vec2{10, 0}, Vec2{10, height}, Vec2{0, height}}) plate.outer.push_back(p);
    const std::vector<Vec2> points = fill(region(plate, uniform(1)), uniform(1));
    // Between the two sides there is one row, half a column from either.
    EXPECT_EQ(points.size(), first == 1 ? 10u : 9u);
    for (const Vec2 p : points) EXPECT_NEAR(p.x + first, std::round(p.x + first + 0.5) - 0.5, 1e-9);
  }
}

/// Makes a plate of width ten. Its lower and upper sides are cut into `pieces` pieces each.
polygons::Polygon plate_of_pieces(double height, int pieces) {
  polygons::Polygon plate;
  for (int k = 0; k <= pieces; ++k) plate.outer.push_back({10.0 * k / pieces, 0});
  for (int k = pieces; k >= 0; --k) plate.outer.push_back({10.0 * k / pieces, height});
  return plate;
}

TEST(lattice_fill, there_are_as_many_columns_as_the_sides_have_pieces_if_these_are_few_more) {
  const auto columns = [](int pieces) {
    std::vector<Vec2> points = fill(region(plate_of_pieces(10.2, pieces), uniform(1)), uniform(1));
    std::sort(points.begin(), points.end(), [](Vec2 a, Vec2 b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
    return 10 / (points[1].x - points[0].x);
  };
  EXPECT_NEAR(columns(10), 10, 1e-9);
  EXPECT_NEAR(columns(11), 11, 1e-9);
  EXPECT_NEAR(columns(15), 10, 1e-9);
}

TEST(lattice_fill, an_odd_number_of_rows_leans_so_that_the_last_one_is_in_step_as_the_first) {
  for (const double rows : {11.0, 12.0, 21.0}) {
    const double height = rows * 0.83;  // an edge of 1 is a row 0.866 high, so there is room
    const std::vector<Vec2> points = fill(region(plate_of_pieces(height, 10), uniform(1)), uniform(1));
    for (const Vec2 p : points) {
      const double row = std::round(p.y / 0.83), lean = std::fmod(rows, 2) == 1 ? 0.5 + 0.5 / rows : 0.5;
      EXPECT_NEAR(p.y, row * 0.83, 1e-9);
      EXPECT_NEAR(p.x - row * lean, std::round(p.x - row * lean), 1e-9);
    }
    EXPECT_GE(static_cast<double>(points.size()), (rows - 1) * 9);
  }
}

TEST(lattice_fill, no_point_is_nearer_to_the_boundary_than_the_shortest_edge) {
  // Three columns of 0.77, whose every second row would end 0.38 from the sides.
  const Region narrow = region(polygons::Polygon{{{0, 0}, {2.31, 0}, {2.31, 5}, {0, 5}}, {}}, uniform(1));
  for (const double shortest : {0.38, 0.45, 0.5, 0.6}) {
    const std::vector<Vec2> points = fill(narrow, uniform(1), 1'000'000, shortest);
    ASSERT_GT(points.size(), 4u);
    for (const Vec2 p : points) EXPECT_GE(nearest(narrow.boundary, p), shortest);
  }
}

TEST(lattice_fill, rows_are_as_high_as_the_columns_that_fit_allow) {
  // 3.02 sizes are four columns, 0.755 sizes wide. Rows of equilateral triangles would have to be ten.
  const double size = 1, width = 3.02, height = 8.2;
  const polygons::Polygon plate{{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}};
  std::vector<double> rows;
  for (const Vec2 p : fill(region(plate, uniform(size)), uniform(size))) rows.push_back(p.y);
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end(), [](double a, double b) { return b - a < 1e-6; }), rows.end());
  const double column = width / 4, slanting = std::hypot(column / 2, height / 9);
  EXPECT_LE(slanting, size);
  EXPECT_GT(height / (size * std::sqrt(3) / 2), 9);
  EXPECT_EQ(rows.size(), 8u);  // between nine
}

TEST(lattice_fill, sizes_that_are_nearly_one_are_filled_as_one) {
  const polygons::Polygon plate{{{0, 0}, {1, 0}, {1, 0.37}, {0, 0.37}}, {}};
  const double size = 0.03;
  const auto even = [&](double of) { return fill(region(plate, uniform(of)), uniform(of)).size(); };
  const PlaneSizes nearly{
      [=](Vec2 p) { return size * (1.01 + 0.03 * p.x); },
      [=](double length, Vec2 p, double radius) { return length <= size * (1.01 + 0.03 * (p.x - radius)); }, false};
  const std::size_t found = fill(region(plate, nearly), nearly).size();
  EXPECT_LE(found, even(size));
  EXPECT_GE(found, even(1.04 * size));
}

TEST(lattice_fill, more_points_than_allowed_are_none) {
  const Region square_region = region(square(), uniform(0.05));
  const std::size_t all = fill(square_region, uniform(0.05)).size();
  for (const std::size_t most : {std::size_t{0}, all / 2, all - 1})
    EXPECT_TRUE(fill(square_region, uniform(0.05), most).empty());
  for (const std::size_t most : {all, 2 * all}) EXPECT_EQ(fill(square_region, uniform(0.05), most).size(), all);
}

TEST(lattice_fill, a_region_narrower_than_the_size_stays_empty) {
  const polygons::Polygon strip{{{0, 0}, {10, 0}, {10, 0.5}, {0, 0.5}}, {}};
  EXPECT_TRUE(fill(region(strip, uniform(0.5)), uniform(1)).empty());
}

TEST(lattice_fill, a_needle_stays_empty_and_takes_no_time) {
  for (const double height : {1e-3, 1e-9, 1e-15})
    for (const bool is_upright : {false, true}) {
      const auto at = [&](double along, double up) { return is_upright ? Vec2{-up, along} : Vec2{along, up}; };
      Region needle{{{at(0, 0), at(10, 0), at(5, height)}}, {}};
      for (int i = 0; i <= 20; ++i) needle.boundary.push_back(at(0.5 * i, 0));
      EXPECT_TRUE(fill(needle, uniform(0.5)).empty()) << height;
    }
}

TEST(lattice_fill, what_needs_far_more_cells_than_points_is_given_up_at_once) {
  // The boundary is not cut, as where no length is asked for: a point of each column is far from its corners.
  for (const double height : {1e-3, 1e-9, 1e-30, 1e-150}) {
    Region strip;
    const Vec2 a{0, 0}, b{1, 0}, c{1, height}, d{0, height};
    strip.triangles = {{a, b, c}, {a, c, d}};
    strip.boundary = {a, b, c, d};
    strip.vertex_count = 4;
    EXPECT_TRUE(fill(strip, uniform(height), 100).empty()) << height;
    EXPECT_TRUE(fill(strip, uniform(height / 1e9), 100).empty()) << height;
  }
}

}  // namespace
}  // namespace remesh
