// Tests what a run says of faces that met: by figures of the table of solids that do not depend on diagonals.

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/geometry/intersections/self_intersections.h"
#include "core/io/obj/obj.h"
#include "tests/solids/solid_measures.h"
#include "tests/solids/solid_rows.h"
#include "tests/support/cgal_space.h"
#include "tests/support/hostile_solids.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

Options repairing(bool is_union) {
  Options options = unrefined();
  options.repair.self_intersections = true;
  options.repair.make_union = is_union;
  return options;
}

std::optional<SolidCounts> counts_of(int number, bool is_union) {
  for (const SolidRow& row : solid_rows())
    if (row.number == number) return remeshed(as_one(row.parts), repairing(is_union)).report.solids;
  return {};
}

TEST(solid_stage, the_report_counts_what_met_and_what_became_of_it) {
  // By row: patches that are cut, groups of coplanar patches, cells, and triangles that a union drops.
  struct Known {
    int row;
    std::size_t cut_patches, coplanar_classes, cells, dropped;
  };
  // Row 1: the corners of both boxes inside each other, each of three squares of two triangles. Rows 3 and 4: a square
  // wall, whose sides have different diagonals, so that both are cut into four triangles.
  for (const Known& known : {Known{1, 6, 0, 3, 12}, Known{3, 2, 1, 2, 4}, Known{4, 2, 1, 2, 4}}) {
    SCOPED_TRACE(known.row);
    const std::optional<SolidCounts> whole = counts_of(known.row, false), united = counts_of(known.row, true);
    ASSERT_TRUE(whole && united);
    for (const SolidCounts& counts : {*whole, *united}) {
      EXPECT_EQ(counts.cut_patches, known.cut_patches);
      EXPECT_EQ(counts.coplanar_classes, known.coplanar_classes);
      EXPECT_EQ(counts.cells, known.cells);
      EXPECT_EQ(counts.rounds, 0u);
      EXPECT_EQ(counts.left, 0u);
      EXPECT_EQ(counts.moved, 0);
      EXPECT_EQ(counts.turned, 0u);
    }
    EXPECT_EQ(whole->dropped, 0u);
    EXPECT_EQ(united->dropped, known.dropped);
  }
  EXPECT_EQ(counts_of(13, false)->coplanar_classes, 6u);
  EXPECT_EQ(counts_of(13, false)->cells, 7u);
  // Nothing meets here but a common corner.
  EXPECT_FALSE(counts_of(8, false));
}

/// Solids that touch, overlap and cross, turned so that coordinates are rounded.
PolygonMesh turned(int number) {
  std::vector<PolygonMesh> parts;
  for (const SolidRow& row : solid_rows())
    if (row.number == number)
      for (const PolygonMesh& part : row.parts) parts.push_back(shapes::rotated(part, {1, 2, 5}, 40));
  return as_one(parts);
}

TEST(solid_stage, faces_of_hostile_families_are_cut_or_it_is_told_that_they_are_not) {
  std::size_t cut = 0;
  for (const hostile::Family& family : hostile::meeting_families()) {
    if (family.answer == hostile::Answer::kQuadratic) continue;
    SCOPED_TRACE(family.name);
    const Result result = remeshed(family.make(40), repairing(false));
    const auto& told = result.report.diagnostics;
    const bool is_given_up = std::any_of(told.begin(), told.end(), [](const Diagnostic& d) {
      return d.code == DiagnosticCode::kCutIntersections && d.count == 0;
    });
    if (is_given_up || !result.report.solids || result.report.solids->left > 0) continue;
    ++cut;
    EXPECT_EQ(pairs_by_cgal(result.mesh, 1), 0u);
  }
  EXPECT_GE(cut, 6u);
}

TEST(solid_stage, faces_stay_where_cuts_would_make_more_of_them_intersect) {
  // The part is 10 wide and 1e10 high, so that the plane tolerance is larger than its width.
  const std::string name = "reports/slow/32f70258bb.obj";
  if (!test::has_shared_mesh(name)) return;
  std::ifstream file(test::shared_meshes_folder() / name);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const Result result = remeshed(read_obj(text, {}, control).mesh, repairing(false));
  EXPECT_FALSE(result.report.solids);
  EXPECT_TRUE(std::any_of(result.report.diagnostics.begin(), result.report.diagnostics.end(), [](const Diagnostic& d) {
    return d.code == DiagnosticCode::kCutIntersections && d.count == 0;
  }));
}

/// Eight cubes in a block, turned, each of them moved by about the plane tolerance, so that some of their faces are
/// joined and others are not.
PolygonMesh block_of_moved_cubes(std::uint64_t seed) {
  Random random(seed);
  const auto direction = [&] {
    const Vec3 v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    return (1 / norm(v)) * v;
  };
  const Vec3 axis = direction();
  const double angle = random.uniform(0, 360);
  std::vector<PolygonMesh> parts;
  for (int i = 0; i < 8; ++i) {
    const PolygonMesh cube =
        shapes::moved(shapes::box({1, 1, 1}), {static_cast<double>(i % 2), i / 2 % 2 + 0., i / 4 + 0.});
    const double tolerance = 1e-9 * 2 * std::numbers::sqrt3;
    parts.push_back(shapes::moved(shapes::rotated(cube, axis, angle), tolerance * direction()));
  }
  return as_one(parts);
}

TEST(solid_stage, parts_that_are_off_by_about_the_tolerance_become_one_closed_surface) {
  double least_area = HUGE_VAL;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Result result = remeshed(block_of_moved_cubes(seed), repairing(true));
    ASSERT_TRUE(result.report.solids);
    EXPECT_EQ(result.report.solids->left, 0u);
    EXPECT_LE(result.report.solids->moved, result.report.first_plane_tolerance * (1 + 1e-9));
    RunControl control;
    const SelfIntersections found =
        self_intersections(result.mesh.positions.items(), result.mesh.faces.items(), {}, SearchLimits(1000), control);
    EXPECT_TRUE(found.is_complete);
    EXPECT_TRUE(found.pairs.empty());
    const Measures measures = measures_of(result.mesh);
    EXPECT_EQ(measures.other_edges, 0u);
    // Both the cubes' faces, of an area of 48, and the points may be off by the tolerance.
    EXPECT_NEAR(measures.volume, 8, 2 * 48 * result.report.first_plane_tolerance);
    // The area is 48 if all cubes stay apart, and 24 if all are joined.
    least_area = std::min(least_area, measures.area);
  }
  EXPECT_LT(least_area, 30) << "in one of these blocks most cubes are joined";
}

/// Needles with both of their sides, side by side and through each other, so that joins leave thin faces with an edge
/// of their own, one behind the other.
PolygonMesh needles_with_both_sides(std::uint64_t seed, double width) {
  Random random(seed);
  const auto place = [&](double x) {
    return Vec3{x + random.uniform(-.01, .01), random.uniform(-width, width), random.uniform(-width, width)};
  };
  std::vector<PolygonMesh> needles;
  for (int i = 0; i < 4; ++i) {
    const std::vector<Vec3> corners{place(0), place(1), place(random.integer(0, 2) / 2.)};
    needles.push_back(shapes::from_lists(corners, {{0, 1, 2}, {2, 1, 0}}));
  }
  return as_one(needles);
}

TEST(solid_stage, no_part_of_a_needle_is_lost_beyond_the_told_distance) {
  int cut = 0;
  for (const double width : {1e-6, 1e-7, 1e-8})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(std::to_string(width) + ", " + std::to_string(seed));
      const PolygonMesh mesh = needles_with_both_sides(seed, width);
      const Result result = remeshed(mesh, repairing(false));
      cut += result.report.solids ? 1 : 0;
      const double told = result.report.distance_bound->input_to_output;
      for (const Vec3& p : mesh.positions.items()) {
        double nearest = HUGE_VAL;
        for (const Triangle& t : result.mesh.faces)
          nearest = std::min(
              nearest, cgal_squared_distance(
                           p, {result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]}));
        EXPECT_LE(std::sqrt(nearest), told * (1 + 1e-9) + 1e-15);
      }
    }
  EXPECT_GT(cut, 10);
}

/// Stands for the block of moved cubes among the numbers of rows.
constexpr int kMovedCubes = 0;

TEST(solid_stage, results_are_the_same_for_any_number_of_workers) {
  // There may be more workers than processors.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
  for (const int number : {2, 13, 18, 19, kMovedCubes}) {
    SCOPED_TRACE(number);
    const PolygonMesh mesh = number == kMovedCubes ? block_of_moved_cubes(2) : turned(number);
    for (const bool is_union : {false, true}) {
      const auto with = [&](int workers) {
        tbb::task_arena arena(workers);
        return arena.execute([&] { return remeshed(mesh, repairing(is_union)); });
      };
      const Result one = with(1);
      for (const int workers : {2, 8}) {
        const Result more = with(workers);
        EXPECT_EQ(more.mesh.positions, one.mesh.positions);
        EXPECT_EQ(more.mesh.faces, one.mesh.faces);
      }
    }
  }
}

TEST(solid_stage, results_have_the_same_triangles_for_any_order_of_the_input) {
  const auto places_of = [](const TriangleMesh& mesh) {
    std::set<std::array<Vec3, 3>> all;
    for (const Triangle& t : mesh.faces) {
      std::array<Vec3, 3> places;
      for (std::size_t k = 0; k < 3; ++k) places[k] = mesh.positions[t[k]];
      std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
      all.insert(places);
    }
    return all;
  };
  for (const int number : {2, 13, 18}) {
    SCOPED_TRACE(number);
    const PolygonMesh mesh = turned(number);
    for (const bool is_union : {false, true})
      for (const unsigned seed : {1U, 2U, 3U})
        EXPECT_EQ(places_of(remeshed(shapes::renumbered(mesh, seed), repairing(is_union)).mesh),
                  places_of(remeshed(mesh, repairing(is_union)).mesh));
  }
}

TEST(solid_stage, where_nothing_meets_the_result_is_that_without_the_options) {
  const PolygonMesh apart = shapes::joined(
      shapes::sphere(3), shapes::moved(shapes::rotated(shapes::box({1, 2, 3}, 2), {1, 2, 3}, 50), {4, 0, 0}));
  const Result plain = remeshed(apart);
  for (const bool is_union : {false, true}) {
    const Result result = remeshed(apart, repairing(is_union));
    EXPECT_FALSE(result.report.solids);
    EXPECT_EQ(result.mesh.positions, plain.mesh.positions);
    EXPECT_EQ(result.mesh.faces, plain.mesh.faces);
  }
}

TEST(solid_stage, it_stops_soon_at_any_moment) {
  std::vector<PolygonMesh> parts;
  for (const SolidRow& row : solid_rows())
    if (row.number == 20) parts.assign(row.parts.begin(), row.parts.begin() + 1000);
  const PolygonMesh mesh = as_one(parts);
  for (const double after : {0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2}) {
    const auto took = test::time_to_stop(
        test::Seconds(after), [&](RunControl& control) { (void)remesh_surface(mesh, repairing(true), {}, control); });
    EXPECT_LT(took.value_or(test::Seconds(0)).count(), 0.2) << after;
  }
}

TEST(solid_stage, without_the_options_nothing_is_counted) {
  const SolidRow row = solid_rows().front();
  EXPECT_FALSE(remeshed(as_one(row.parts)).report.solids);
}

}  // namespace
}  // namespace remesh
