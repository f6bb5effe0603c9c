// Tests sizes that depend on gaps in the third dimension, and how they grow from place to place. No edge is longer than
// the gap, and there are hardly more faces than that takes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/remesh.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

constexpr double kSizeSlack = 1 + 1e-9;

double distance_to_outer_walls(const Vec3& p, double width) { return std::min({p.x, p.y, width - p.x, width - p.y}); }

TEST(refinement_proximity, between_two_plates_no_edge_is_longer_than_the_gap) {
  for (const double gap : {0.25, 0.1}) {
    const PolygonMesh plate = shapes::sheet(2, 2, 1, 1);
    const PolygonMesh mesh = shapes::joined(plate, shapes::moved(plate, {0, 0, gap}));
    Options options;
    options.proximity = 1;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_LE(longest_edge(result.mesh), gap * kSizeSlack);
    ASSERT_TRUE(result.report.smallest_gap.has_value());
    EXPECT_NEAR(*result.report.smallest_gap, gap, 1e-9);
    // This number of equilateral triangles would cover both plates. Near the rims there are more.
    const double triangles = 2 * 4 / (gap * gap * std::sqrt(3) / 4);
    EXPECT_LT(static_cast<double>(result.mesh.faces.size()), 3 * triangles);
    // A proximity of 2 makes edges half as long.
    options.proximity = 2;
    EXPECT_LE(longest_edge(refined(mesh, options).mesh), gap / 2 * kSizeSlack);
  }
}

TEST(refinement_proximity, across_the_walls_of_a_tube_no_edge_is_longer_than_they_are_thick) {
  const double width = 2, thick = 0.1;
  const PolygonMesh mesh = solids::tube(width, 0.5, thick);
  Options options;
  options.proximity = 1;
  options.min_angle_deg = 20;
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  std::size_t on_walls = 0;
  for (const Triangle& t : result.mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = result.mesh.positions[t[k]], &b = result.mesh.positions[t[(k + 1) % 3]];
      const bool is_outside = distance_to_outer_walls(a, width) == 0 && distance_to_outer_walls(b, width) == 0;
      if (!is_outside) continue;
      ++on_walls;
      // Every place of an outer wall has the inner one a wall's thickness away, but near the upright edges, where the
      // inner wall ends: the distance is the diagonal's there.
      EXPECT_LE(norm(b - a), thick * std::sqrt(2) * kSizeSlack);
    }
  EXPECT_GT(on_walls, 1000u);
}

TEST(refinement_proximity, edges_across_the_rim_of_a_wall_may_be_longer_by_the_gradation) {
  const double thick = 0.1;
  for (const double degrees : {0.0, 35.0}) {
    const auto turned = [&](const PolygonMesh& mesh, double by) { return shapes::rotated(mesh, {1, 2, 3}, by); };
    const PolygonMesh mesh = turned(shapes::box({1.03, 0.77, thick}), degrees);
    Options options;
    options.proximity = 1;
    options.min_angle_deg = 20;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    PolygonMesh back;
    for (const Vec3& p : result.mesh.positions) back.positions.push_back(p);
    back = turned(back, -degrees);
    double longest_across = 0;
    for (const Triangle& t : result.mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = back.positions[t[k]], &b = back.positions[t[(k + 1) % 3]];
        const double height = 0.5 * (a.z + b.z), way = std::min(height, thick - height);
        EXPECT_LE(norm(b - a), (thick + 0.5 * way) * kSizeSlack);
        longest_across = std::max(longest_across, norm(b - a));
      }
    EXPECT_GT(longest_across, 1.05 * thick) << degrees;
  }
}

TEST(refinement_proximity, rows_across_a_wall_end_between_the_pieces_of_its_sides) {
  // Two, three and four rows of triangles, ten columns, on a wall of thickness 1: not a point too many.
  for (const double width : {1.7, 2.55, 3.4}) {
    const double rows = std::round(width / 0.85);
    const PolygonMesh mesh = shapes::box({9.9, width, 1});
    Options options;
    options.proximity = 1;
    options.min_angle_deg = 20;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    const auto is_on_wall = [&](const Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](VertexId v) { return result.mesh.positions[v].z == 1; });
    };
    EXPECT_EQ(std::count_if(result.mesh.faces.begin(), result.mesh.faces.end(), is_on_wall), rows * (10 + 11)) << width;
  }
}

TEST(refinement_proximity, a_plate_of_so_many_thicknesses_is_cut_into_so_many_pieces_whatever_the_last_digits_say) {
  // As doubles, as a binary STL's floats, in print.
  const auto single = [](PolygonMesh mesh) {
    for (Vec3& p : mesh.positions) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    return mesh;
  };
  const auto in_print = [](const PolygonMesh& mesh) { return shapes::rounded(mesh, 1e-4); };
  struct Written {
    std::function<PolygonMesh(const PolygonMesh&)> as;
    double rounding;
  };
  for (const double thick : {1.0, 0.1, 0.7, 3.3})
    for (const Written& written :
         {Written{std::identity(), 0x1p-50}, Written{single, 0x1p-20}, Written{in_print, 1e-4}}) {
      const Vec3 corner{5.1, -3.3, 0.7};
      const PolygonMesh mesh = written.as(shapes::moved(shapes::box({12 * thick, 7 * thick, thick}), corner));
      Options options;
      options.plane_tolerance = 2 * written.rounding;
      options.proximity = 1;
      options.min_angle_deg = 20;
      const Result result = refined(mesh, options);
      expect_promises(mesh, options, result);
      const auto count = [&](int axis, int other) {
        return std::count_if(result.mesh.positions.begin(), result.mesh.positions.end(), [&](const Vec3& p) {
          return std::fabs(p[axis] - corner[axis]) < 0.1 * thick && std::fabs(p[other] - corner[other]) < 0.1 * thick;
        });
      };
      EXPECT_EQ(count(1, 2), 13) << thick;
      EXPECT_EQ(count(0, 2), 8) << thick;
      // This number of equilateral triangles would cover the box. There are more, because each square across the rims
      // has a point inside.
      const double triangles = 2 * (12 * 7 + 12 + 7) / (std::sqrt(3) / 4);
      EXPECT_LT(static_cast<double>(result.mesh.faces.size()), 1.35 * triangles) << thick;
    }
}

TEST(refinement_proximity, where_gaps_close_the_shortest_edge_goes_before_them) {
  // Two blocks lie beside each other, with a gap below the shortest edge, which opens to a notch of 30 degrees.
  const double half = 0.5, gap = 0.002, wide = gap + std::tan(15 * std::numbers::pi / 180);
  const PolygonMesh mesh =
      shapes::joined(shapes::prism({{-1, -1}, {-gap, -1}, {-gap, -half}, {-wide, half}, {-1, half}}, 0.3),
                     shapes::prism({{1, -1}, {1, half}, {wide, half}, {gap, -half}, {gap, -1}}, 0.3));
  for (const double shortest : {0.01, 0.02, 0.05, 0.1}) {
    Options options = with_length(0.3);
    options.proximity = 1;
    options.min_edge_length = shortest;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_EQ(listed(result.report), listed(result.report, UnrefinedReason::kMinEdgeLength));
    EXPECT_GE(shortest_edge(result.mesh), shortest / kSizeSlack);
    EXPECT_LE(longest_edge(result.mesh), 0.3 * kSizeSlack);
    // The notch is not ignored: edges become as short as they may.
    EXPECT_LE(shortest_edge(result.mesh), 1.2 * shortest);
  }
}

TEST(refinement_proximity, no_edge_is_longer_than_itself) {
  // With gradation alone each edge of the input is as long as sizes are there: it is not cut. Whether a side has a
  // point in its middle does not follow from that, so the four triangles of a side are pinned.
  constexpr std::size_t kPinnedFacesOfSide = 4;
  for (const double size : {1.0, 1.1, 1.3, 1.7, 0.3}) {
    Options options;
    options.gradation = 1.5;
    EXPECT_EQ(refined(shapes::box({size, size, size}), options).mesh.faces.size(), 6 * kPinnedFacesOfSide) << size;
  }
}

TEST(refinement_proximity, sizes_that_grow_at_once_take_no_longer_than_others) {
  // Some seconds would be noticed here: with lattices cut for steepness it took minutes, or did not end.
  for (const double gradation : {1e3, 1e6, 1e12, 1e300})
    for (const double proximity : {0.0, 1.0}) {
      const PolygonMesh mesh = shapes::box({4, 4, 0.5});
      Options options;
      options.proximity = proximity;
      options.gradation = 100;
      const std::size_t faces = refined(mesh, options).mesh.faces.size();
      options.gradation = gradation;
      const Result result = refined(mesh, options);
      expect_promises(mesh, options, result);
      EXPECT_EQ(result.mesh.faces.size(), faces) << gradation;
    }
}

TEST(refinement_proximity, what_is_much_smaller_than_a_facet_under_it_is_seen_from_there) {
  // A cube over a plate, and a roof's ridge, upside down.
  struct Case {
    const char* name;
    PolygonMesh over;
    Vec2 low, high;  ///< of what is lowest
    double gap;
  };
  const auto cube = [](double side, double gap) {
    return Case{"cube",
                shapes::moved(shapes::box({side, side, side}), {4.9, 5.03, gap}),
                {4.9, 5.03},
                {4.9 + side, 5.03 + side},
                gap};
  };
  const PolygonMesh roof = shapes::rotated(shapes::prism({{0, 0}, {1.5, 3}, {-1.5, 3}}, 6), {1, 0, 0}, 90);
  const Case cases[] = {cube(1, 0.05),
                        cube(0.3, 0.02),
                        cube(0.05, 0.01),
                        cube(0.2, 0.2),
                        {"ridge", shapes::moved(roof, {5.1, 8, 0.1}), {5.1, 2}, {5.1, 8}, 0.1}};
  for (const Case& c : cases) {
    const PolygonMesh mesh = shapes::joined(shapes::moved(shapes::box({10, 10, 1}), {0, 0, -1}), c.over);
    Options options;
    options.proximity = 1;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_NEAR(result.report.smallest_gap.value(), c.gap, 1e-9);
    std::size_t below = 0;
    for (const Triangle& t : result.mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = result.mesh.positions[t[k]], &b = result.mesh.positions[t[(k + 1) % 3]];
        const Vec3 middle = 0.5 * (a + b);
        if (a.z != 0 || b.z != 0 || middle.y < c.low.y || middle.y > c.high.y) continue;
        const double beside = std::max({0.0, c.low.x - middle.x, middle.x - c.high.x});
        if (beside > c.gap / 2) continue;
        ++below;
        // Sizes are known where a cell's middle is; from there they grow.
        EXPECT_LE(norm(b - a), 1.1 * std::hypot(c.gap, beside)) << c.name << ' ' << c.gap;
      }
    EXPECT_GT(below, 0u);
  }
}

TEST(refinement_proximity, gradation_is_heeded_without_any_other_bound) {
  const PolygonMesh mesh = shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0.05, 8}, {0, 7.95}});
  Options options;
  options.min_angle_deg = 0;
  EXPECT_LT(refined(mesh, options).mesh.faces.size(), 5u);
  options.gradation = 1.5;
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_GT(result.mesh.faces.size(), 50u);
}

TEST(refinement_proximity, sizes_grow_no_faster_than_asked) {
  // A plate with one short edge: from there on, edges may be twice as long from one to the next.
  const PolygonMesh mesh = shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0.05, 8}, {0, 7.95}});
  std::size_t before = 0;
  for (const double gradation : {3.0, 1.5, 1.2}) {
    Options options;
    options.gradation = gradation;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_GT(result.mesh.faces.size(), before) << gradation;
    before = result.mesh.faces.size();
    // Each edge is at most the short one plus (gradation - 1) times the way there, by the report's own definition.
    const Vec3 near{0.025, 7.975, 0};
    for (const Triangle& t : result.mesh.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = result.mesh.positions[t[k]], &b = result.mesh.positions[t[(k + 1) % 3]];
        const double way = std::max(norm(a - near), norm(b - near));
        EXPECT_LE(norm(b - a), 0.075 + (gradation - 1) * way);
      }
  }
}

}  // namespace
}  // namespace remesh
