// Compares the proven distance between two surfaces with geometry, with branch and bound by brute force, and with CGAL.

#include "core/verify/near_faces/near_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "core/io/formats.h"
#include "core/io/mesh_files.h"
#include "tests/support/cgal_space.h"
#include "tests/support/errors.h"
#include "tests/support/hausdorff.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/solids.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

using verification::OneWayDistance;
using verification::TwoWayDistance;

/// The distance between two meshes of triangles.
TwoWayDistance distance(const TriangleMesh& a, const TriangleMesh& b, std::optional<double> tolerance = {}) {
  RunControl control;
  return verification::distance_between({a.positions.items(), a.faces.items()}, {b.positions.items(), b.faces.items()},
                                        tolerance, control);
}

TriangleMesh triangles(const PolygonMesh& mesh) { return shapes::as_triangles(shapes::fan_triangulated(mesh)); }

std::vector<Corners3> corners_of(const TriangleMesh& mesh, const Vec3& origin = {}, double scale = 1) {
  std::vector<Corners3> all;
  for (const Triangle& face : mesh.faces) {
    Corners3& corners = all.emplace_back();
    for (int i = 0; i < 3; ++i) corners[i] = scale * (mesh.positions[face[i]] - origin);
  }
  return all;
}

/// Tells that a bound is the true distance, and no more above it than is allowed.
void expect_tight(const OneWayDistance& found, double exact) {
  EXPECT_GE(found.bound, exact);
  EXPECT_LE(found.bound, exact * (1 + verification::kBoundExcess) + 1e-11);
  EXPECT_NEAR(found.distance, exact, exact * verification::kBoundExcess + 1e-11);
  EXPECT_FALSE(found.is_coarse);
}

// These distances follow from geometry.

TEST(near_faces, parallel_sheets_are_as_far_apart_as_their_heights_differ_however_they_are_cut) {
  const TriangleMesh a = triangles(shapes::sheet(4, 4, 3, 3));
  const TriangleMesh b = triangles(shapes::moved(shapes::sheet(4, 4, 7, 5), {0, 0, 0.375}));
  const TwoWayDistance both = distance(a, b);
  expect_tight(both.a_to_b, 0.375);
  expect_tight(both.b_to_a, 0.375);
  EXPECT_DOUBLE_EQ(both.diagonal, std::sqrt(4 * 4 + 4 * 4 + 0.375 * 0.375));
}

TEST(near_faces, two_triangulations_of_one_surface_are_apart_by_rounding_alone) {
  const TwoWayDistance both = distance(triangles(shapes::box({2, 3, 1}, 5)), triangles(shapes::box({2, 3, 1}, 7)));
  EXPECT_LE(both.a_to_b.bound, 1e-11);
  EXPECT_LE(both.b_to_a.bound, 1e-11);
  EXPECT_FALSE(both.a_to_b.is_coarse || both.b_to_a.is_coarse);
}

TEST(near_faces, the_two_directions_differ_where_one_surface_has_a_hole) {
  // The hole is a unit square, and its middle is half a side from the rim.
  const TriangleMesh with_hole = triangles(shapes::flat({"###", "#.#", "###"}));
  const TriangleMesh whole = triangles(shapes::flat({"###", "###", "###"}));
  const TwoWayDistance both = distance(with_hole, whole);
  EXPECT_LE(both.a_to_b.bound, 1e-11);
  expect_tight(both.b_to_a, 0.5);
  EXPECT_NEAR(both.b_to_a.at.x, 1.5, 0.01);
  EXPECT_NEAR(both.b_to_a.at.y, 1.5, 0.01);
}

TEST(near_faces, a_long_slit_that_is_closed_is_as_far_away_as_half_its_width) {
  // The largest distance is reached along a whole line, which runs across the faces.
  const TriangleMesh slit = triangles(shapes::joined(shapes::moved(shapes::sheet(64, 1, 3, 1), {0, 0, 0}),
                                                     shapes::moved(shapes::sheet(64, 1, 3, 1), {0, 1.25, 0})));
  const TwoWayDistance both = distance(triangles(shapes::sheet(64, 2.25, 5, 1)), slit);
  expect_tight(both.a_to_b, 0.125);
}

TEST(near_faces, a_cube_in_a_larger_one_is_as_far_away_as_faces_and_corners_say) {
  const TriangleMesh inner = triangles(shapes::box({2, 2, 2}, 2));
  const TriangleMesh outer = triangles(shapes::moved(shapes::box({4, 4, 4}, 3), {-1, -1, -1}));
  const TwoWayDistance both = distance(inner, outer);
  expect_tight(both.a_to_b, 1);
  expect_tight(both.b_to_a, std::sqrt(3.0));
}

TEST(near_faces, the_height_of_an_arc_over_its_chord_is_the_distance_of_an_inscribed_prism) {
  // A regular prism of 3 k sides lies in that of 3 sides' circle: the farthest points are the middles of the arcs.
  const TriangleMesh coarse = triangles(shapes::cylinder(6, 1, 4)), fine = triangles(shapes::cylinder(96, 1, 4));
  const TwoWayDistance both = distance(fine, coarse);
  EXPECT_GE(both.a_to_b.bound, 1 - std::cos(M_PI / 6));
  expect_tight(both.a_to_b, 1 - std::cos(M_PI / 6));
}

TEST(near_faces, faces_without_area_are_segments_and_points) {
  // A spike of no area sticks out of a sheet, and a point stands over it.
  PolygonMesh sheet = shapes::sheet(2, 2, 4, 4);
  const TriangleMesh whole = triangles(sheet);
  const TriangleMesh spiked =
      triangles(shapes::joined(sheet, shapes::from_lists({{1, 1, 0}, {1, 1, 0.5}, {1, 1, 0.25}}, {{0, 1, 2}})));
  const TriangleMesh dotted =
      triangles(shapes::joined(sheet, shapes::from_lists({{1, 1, 0.75}, {1, 1, 0.75}, {1, 1, 0.75}}, {{0, 1, 2}})));
  expect_tight(distance(spiked, whole).a_to_b, 0.5);
  EXPECT_LE(distance(spiked, whole).b_to_a.bound, 1e-11);
  expect_tight(distance(dotted, whole).a_to_b, 0.75);
  expect_tight(distance(whole, dotted).b_to_a, 0.75);
}

TEST(near_faces, thin_needles_lose_no_digits) {
  const TriangleMesh needles = triangles(solids::needle_fan(200, 1e-5));
  const TwoWayDistance same = distance(needles, needles);
  EXPECT_LE(same.a_to_b.bound, 1e-11);
  TriangleMesh raised = needles;
  for (Vec3& p : raised.positions) p.z += 1e-3;
  EXPECT_LE(distance(needles, raised).a_to_b.bound, 1.004e-3 + 1e-11);
}

TEST(near_faces, one_face_over_very_many_is_cut_as_often_as_they_are) {
  const TriangleMesh one = triangles(shapes::moved(shapes::sheet(8, 8, 1, 1), {0, 0, 0.25}));
  const TriangleMesh many = triangles(shapes::sheet(8, 8, 100, 100));
  const TwoWayDistance both = distance(one, many);
  expect_tight(both.a_to_b, 0.25);
  EXPECT_LE(both.a_to_b.pieces, 32 * many.faces.size());
}

TEST(near_faces, a_small_place_with_most_of_the_work_gets_most_of_the_pieces) {
  // Under one of 3,200 faces are 20,000, which have a bound of their own only after they have been cut apart.
  const TriangleMesh coarse = triangles(shapes::sheet(40, 40, 40, 40));
  const PolygonMesh fine = shapes::moved(shapes::sheet(1, 1, 100, 100), {20, 20, 0});
  PolygonMesh rest = shapes::sheet(40, 40, 40, 40);
  const auto in_hole = [&](FaceId f) {
    return std::all_of(rest.face(f).begin(), rest.face(f).end(), [&](VertexId v) {
      const Vec3& p = rest.positions[v];
      return p.x >= 20 && p.x <= 21 && p.y >= 20 && p.y <= 21;
    });
  };
  TriangleMesh uneven = triangles(fine);
  for (std::uint32_t f = 0; f < rest.face_count(); ++f) {
    if (in_hole(FaceId(f))) continue;
    Triangle face;
    for (int i = 0; i < 3; ++i) face[i] = uneven.positions.push_back(rest.positions[rest.face(FaceId(f))[i]]);
    uneven.faces.push_back(face);
  }
  const TwoWayDistance both = distance(coarse, uneven);
  EXPECT_FALSE(both.a_to_b.is_coarse);
  EXPECT_LE(both.a_to_b.bound, 1e-10);
}

// These tests ask for yes or no.

TEST(near_faces, the_answer_to_a_tolerance_is_yes_exactly_from_the_distance_on) {
  const TriangleMesh a = triangles(shapes::sphere(4)), b = triangles(shapes::sphere(2));
  const double exact = distance(a, b).a_to_b.distance;
  const TwoWayDistance yes = distance(a, b, exact * (1 + 1e-9)), no = distance(a, b, exact * (1 - 1e-9));
  EXPECT_LE(yes.a_to_b.bound, exact * (1 + 1e-9));
  EXPECT_EQ(yes.a_to_b.far_count, 0);
  EXPECT_TRUE(yes.a_to_b.far_faces.empty());
  EXPECT_GT(no.a_to_b.bound, exact * (1 - 1e-9));
  EXPECT_GT(no.a_to_b.far_count, 0);
}

TEST(near_faces, an_answer_costs_less_than_the_value) {
  const TriangleMesh a = triangles(shapes::sphere(5)), b = triangles(shapes::sphere(3));
  const TwoWayDistance value = distance(a, b), answer = distance(a, b, 2 * distance(a, b).b_to_a.bound);
  EXPECT_LT(answer.b_to_a.pieces, value.b_to_a.pieces);
  EXPECT_LT(answer.a_to_b.pieces, value.a_to_b.pieces);
}

TEST(near_faces, the_faces_that_are_too_far_away_are_listed_and_no_others) {
  // A step is as far away as it is high, on the 8 faces that it has.
  PolygonMesh sheet = shapes::sheet(8, 8, 8, 8);
  const TriangleMesh flat = triangles(sheet);
  const TriangleMesh stepped = triangles(shapes::joined(sheet, shapes::moved(shapes::sheet(2, 2, 2, 2), {3, 3, 0.5})));
  const OneWayDistance far = distance(stepped, flat, 0.25).a_to_b;
  EXPECT_EQ(far.far_count, 8);
  ASSERT_EQ(far.far_faces.size(), 8);
  for (const verification::FarFace& face : far.far_faces) {
    EXPECT_GE(face.face.value, flat.faces.size());
    EXPECT_GE(face.bound, 0.5);
  }
}

TEST(near_faces, the_list_of_far_faces_is_bounded_and_has_the_farthest_ones) {
  const TriangleMesh flat = triangles(shapes::sheet(8, 8, 4, 4));
  TriangleMesh slope = triangles(shapes::sheet(8, 8, 225, 225));
  for (Vec3& p : slope.positions) p.z = 1 + p.x;
  const OneWayDistance far = distance(slope, flat, 0.5).a_to_b;
  EXPECT_EQ(far.far_count, slope.faces.size());
  ASSERT_EQ(far.far_faces.size(), verification::kMaxFarFaces);
  EXPECT_GE(far.far_faces.front().bound, far.far_faces.back().bound);
  // 100,000 of 101,250 faces are the last 222.2 of 225 columns.
  for (const verification::FarFace& face : far.far_faces)
    EXPECT_GE(slope.positions[slope.faces[face.face][0]].x + 8.0 / 225, 8 * (1 - 223.5 / 225));
}

// These tests are about errors, stops, and what stays the same.

TEST(near_faces, surfaces_without_faces_or_too_far_from_each_other_are_refused) {
  const TriangleMesh box = triangles(shapes::box({1, 1, 1}));
  EXPECT_EQ(test::error_of([&] { distance(box, {}); }).code, Code::kEmptyMesh);
  const TriangleMesh far = triangles(shapes::moved(shapes::scaled(shapes::box({1, 1, 1}), 0x1p1000), {0x1p1023, 0, 0}));
  const TriangleMesh other =
      triangles(shapes::moved(shapes::scaled(shapes::box({1, 1, 1}), 0x1p1000), {-0x1p1023, 0, 0}));
  EXPECT_EQ(test::error_of([&] { distance(far, other); }).code, Code::kCoordinateRange);
}

STAGE(near_faces, test::kWorkers, test::kScale, test::kExtremeScale, test::kStop) {
  const TriangleMesh a = triangles(trial.of(shapes::sphere(4)));
  const TriangleMesh b = triangles(trial.of(shapes::rotated(shapes::sphere(3), {1, 2, 3}, 20)));
  for (const double tolerance : {0.0, 0.01}) {
    const TwoWayDistance both = verification::distance_between(
        {a.positions.items(), a.faces.items()}, {b.positions.items(), b.faces.items()},
        tolerance > 0 ? std::optional(tolerance * trial.scale) : std::nullopt, trial.control);
    for (const OneWayDistance& way : {both.a_to_b, both.b_to_a}) {
      trial.same(trial.length(way.bound), trial.length(way.distance), trial.length(way.at), way.face, way.other_face);
      trial.same(way.pieces, way.far_count);
      for (const verification::FarFace& far : way.far_faces) trial.same(far.face, trial.length(far.bound));
    }
  }
}

TEST(near_faces, it_stops_soon_after_it_was_asked_to) {
  const TriangleMesh a = triangles(shapes::sphere(unless_sanitized(7, 5)));
  TriangleMesh b = a;
  Random random(5);
  for (Vec3& p : b.positions) p = (1 + random.uniform(-0.01, 0.01)) * p;
  for (const double after : {0.02, 0.1, 0.25}) {
    const auto stopped = test::time_to_stop(test::Seconds(after), [&](RunControl& control) {
      verification::distance_between({a.positions.items(), a.faces.items()}, {b.positions.items(), b.faces.items()}, {},
                                     control);
    });
    if (stopped) {
      EXPECT_LT(stopped->count(), 0.1);
    }
  }
}

// These tests compare with the oracle.

/// The largest distance by brute force, in a local frame, as an interval.
struct Interval {
  double low = 0, high = 0;
};

/// How the ratios of the bound to the upper end of the oracle are spread.
struct Ratios {
  std::vector<double> all;

  void print(const std::string& name) {
    if (all.empty()) return;
    std::sort(all.begin(), all.end());
    std::cout << name << ": " << all.size() << " ratios to the oracle's upper end, median " << all[all.size() / 2]
              << ", worst " << all.back() << '\n';
  }
};

/// Checks one direction against branch and bound.
/// Input:  coordinates of the oracle are (p - origin) * scale.
void check_against_oracle(const OneWayDistance& found, const TriangleMesh& from, const TriangleMesh& to,
                          const Vec3& origin, double scale, double diagonal, Ratios& ratios) {
  const double bound = scale * found.bound, size = scale * diagonal;
  // Where the surfaces nearly coincide, the oracle would halve faces without end.
  const double accuracy = std::max(0.005 * bound, 5e-4 * size);
  const double low = test::hausdorff_one_way(corners_of(from, origin, scale), corners_of(to, origin, scale), accuracy);
  EXPECT_GE(bound, low - 1e-13 * size);
  EXPECT_LE(bound, 1.25 * (low + accuracy));
  EXPECT_FALSE(found.is_coarse);
  if (accuracy < 0.01 * bound) ratios.all.push_back(bound / (low + accuracy));
  // The place has the distance: CGAL computes it exactly from the place as it was rounded.
  const Vec3 at = scale * (found.at - origin);
  double squared = HUGE_VAL;
  for (const Corners3& corners : corners_of(to, origin, scale))
    if (norm_squared(cross(corners[1] - corners[0], corners[2] - corners[0])) > 0)
      squared = std::min(squared, cgal_squared_distance(at, corners));
    else
      squared = std::min(squared, norm_squared(nearest_on_triangle(at, corners) - at));
  EXPECT_NEAR(std::sqrt(squared), scale * found.distance, 1e-12 * size + 1e-15 * scale * norm(found.at));
}

/// A mesh of the collection, which is not compressed.
TriangleMesh shared_mesh(const std::string& name) {
  std::ifstream file(test::shared_meshes_folder() / name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  return triangles(read_mesh(sniff_format(text), text, {}, control).mesh);
}

PolygonMesh random_shape(Random& random) {
  switch (random.below(10)) {
    case 0: return shapes::sphere(random.integer(0, 2));
    case 1: return shapes::box({1, random.uniform(0.01, 2), 1}, random.integer(1, 3));
    case 2: return solids::cut_cube(random.bits(), random.integer(1, 8));
    case 3: return shapes::cylinder(random.integer(3, 20), 1, random.uniform(0.1, 4));
    case 4: return shapes::random_soup(random, 3);
    case 5: return solids::needle_fan(random.integer(3, 20), random.uniform(0.01, 5));
    case 6: return shapes::noisy_sheet(random.integer(1, 4), static_cast<unsigned>(random.below(1000)));
    case 7: return shapes::random_blocks(random, 3, 1);
    case 8: return solids::tube(1, 2, random.uniform(0.001, 0.2));
    default: return shapes::flat({"###", "#.#", "##."}, random.integer(1, 2));
  }
}

/// Changes a mesh so that its distance from what it was is not obvious.
TriangleMesh changed(TriangleMesh mesh, Random& random) {
  const double amount = std::pow(10.0, random.uniform(-4, 0));
  switch (random.below(7)) {
    case 0:  // noise
      for (Vec3& p : mesh.positions)
        p += amount * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      break;
    case 1:  // a step
      for (Vec3& p : mesh.positions)
        if (p.x > 0.3) p.z += amount;
      break;
    case 2:  // a fold
      for (Vec3& p : mesh.positions)
        if (p.y > 0.4) p.y = 0.8 - p.y + amount;
      break;
    case 3:  // holes
      for (int i = 0; i < 3 && mesh.faces.size() > 1; ++i) {
        mesh.faces.items()[random.below(static_cast<int>(mesh.faces.size()))] = mesh.faces.items().back();
        mesh.faces.items().pop_back();
      }
      break;
    case 4: {  // faces without area
      const auto n = static_cast<int>(mesh.positions.size());
      for (int i = 0; i < 4; ++i) {
        const VertexId v(random.below(n)), w(random.below(n));
        mesh.faces.push_back(Triangle{v, w, random.chance(0.5) ? v : w});
      }
      break;
    }
    case 5:  // turned a little
      return shapes::triangles(shapes::rotated(shapes::polygons(mesh), {1, 1, 0.3}, 90 * amount));
    default: return triangles(random_shape(random));
  }
  return mesh;
}

void put(TriangleMesh& mesh, double scale, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = scale * (p + by);
}

TEST(near_faces, the_bound_of_random_pairs_is_never_below_the_oracle_and_hardly_above_it) {
  // REMESH_TRIALS=1000 takes some seconds.
  const char* trials = std::getenv("REMESH_TRIALS");
  const int pairs = trials != nullptr ? std::atoi(trials) : unless_sanitized(200, 10);
  const std::uint64_t seed = base_seed(1);
  Ratios ratios;
  for (int i = 0; i < pairs; ++i) {
    SCOPED_TRACE("pair " + std::to_string(i));
    Random random(seed + static_cast<std::uint64_t>(i));
    TriangleMesh a = triangles(random_shape(random)), b = changed(a, random);
    const double scale = random.chance(0.5) ? 1 : std::ldexp(1.0, random.integer(-300, 300));
    const Vec3 by = random.chance(0.5) ? Vec3{} : std::pow(10.0, random.uniform(0, 7)) * Vec3{1, -0.7, 0.3};
    put(a, scale, by);
    put(b, scale, by);
    const TwoWayDistance both = distance(a, b);
    const Vec3 origin = a.positions.items()[a.faces.items()[0][0].value];
    check_against_oracle(both.a_to_b, a, b, origin, 1 / scale, both.diagonal, ratios);
    check_against_oracle(both.b_to_a, b, a, origin, 1 / scale, both.diagonal, ratios);
    // The answers agree with the values.
    for (const double share : {0.5, 1.5}) {
      const TwoWayDistance answer = distance(a, b, share * both.a_to_b.bound);
      if (both.a_to_b.bound > 1e-10 * both.diagonal) {
        EXPECT_EQ(answer.a_to_b.bound <= share * both.a_to_b.bound, share > 1);
      }
      EXPECT_EQ(answer.a_to_b.far_count == 0, answer.a_to_b.bound <= share * both.a_to_b.bound);
    }
    if (HasFailure()) return;
  }
  ratios.print("random pairs");
  EXPECT_LE(ratios.all[ratios.all.size() / 2], 1.02);
}

// These changes must be refused.

/// The normal of a face, of any length.
Vec3 normal_of(const TriangleMesh& mesh, std::size_t f) {
  const Triangle& face = mesh.faces.items()[f];
  const Vec3 p = mesh.positions[face[0]];
  return normalized(cross(mesh.positions[face[1]] - p, mesh.positions[face[2]] - p));
}

/// Checks that a mesh is near itself, and that no mutation of it is.
/// Input: the tolerance, which is smaller than the height of the largest face; a seed.
void expect_mutations_refused(const TriangleMesh& mesh, double tolerance, std::uint64_t seed) {
  const auto is_within = [&](const TriangleMesh& mutated) {
    const TwoWayDistance both = distance(mesh, mutated, tolerance);
    return both.a_to_b.far_count == 0 && both.b_to_a.far_count == 0;
  };
  EXPECT_TRUE(is_within(mesh));
  // The largest face: what happens to it or at its corner is not hidden by its neighbours.
  std::size_t largest = 0;
  double area = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Triangle& face = mesh.faces.items()[f];
    const double here = norm(
        cross(mesh.positions[face[1]] - mesh.positions[face[0]], mesh.positions[face[2]] - mesh.positions[face[0]]));
    if (here > area) {
      area = here;
      largest = f;
    }
  }
  Random random(seed);
  const VertexId corner = mesh.faces.items()[largest][random.below(3)];
  // The corner is moved along the mean of its normals.
  Vec3 normal;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (const VertexId v : mesh.faces.items()[f])
      if (v == corner) normal += normal_of(mesh, f);
  normal = normalized(normal);
  for (const double by : {2.0, -2.0}) {
    TriangleMesh mutated = mesh;
    mutated.positions[corner] += (by * tolerance) * normal;
    EXPECT_FALSE(is_within(mutated)) << "a vertex moved by " << by << " tolerances";
  }
  TriangleMesh opened = mesh;
  opened.faces.items().erase(opened.faces.items().begin() + static_cast<std::ptrdiff_t>(largest));
  EXPECT_FALSE(is_within(opened)) << "a face taken away";
  const TwoWayDistance closed = distance(opened, mesh, tolerance);
  EXPECT_GT(closed.b_to_a.far_count, 0) << "a hole closed";
  TriangleMesh spiked = mesh;
  const VertexId tip = spiked.positions.push_back(mesh.positions[corner] + (2 * tolerance) * normal);
  spiked.faces.push_back(Triangle{corner, tip, corner});
  EXPECT_FALSE(is_within(spiked)) << "a spike of zero area";
}

TEST(near_faces, mutations_are_refused) {
  expect_mutations_refused(triangles(shapes::sphere(3)), 0.01, 1);
  expect_mutations_refused(triangles(shapes::box({1, 2, 3}, 4)), 0.01, 2);
  expect_mutations_refused(triangles(shapes::noisy_sheet(6, 3)), 0.01, 3);
  expect_mutations_refused(triangles(shapes::plate_with_round_hole(16)), 0.01, 4);
}

TEST(near_faces, a_region_that_is_shifted_along_itself_and_an_outline_that_is_cut_short_are_refused) {
  constexpr double kTolerance = 0.01;
  const TriangleMesh plate = triangles(shapes::flat({"####", "####", "####"}, 2));
  const TriangleMesh shifted = triangles(shapes::moved(shapes::flat({"####", "####", "####"}, 2), {0.02, 0, 0}));
  const TwoWayDistance both = distance(plate, shifted, kTolerance);
  EXPECT_GT(both.a_to_b.far_count, 0);
  EXPECT_GT(both.b_to_a.far_count, 0);
  // A corner is cut off: its tip is 0.02 from the cut.
  const double side = 0.02 * std::sqrt(2.0);
  const TriangleMesh whole = triangles(shapes::polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  const TriangleMesh cut = triangles(shapes::polygon({{0, 0}, {1, 0}, {1, 1 - side}, {1 - side, 1}, {0, 1}}));
  EXPECT_EQ(distance(whole, cut, kTolerance).b_to_a.far_count, 0);
  EXPECT_GT(distance(whole, cut, kTolerance).a_to_b.far_count, 0);
}

TEST(near_faces, mutations_of_real_meshes_are_refused) {
  for (const char* const name : {"curved/spot.ply", "curved/casting.off"}) {
    if (!test::has_shared_mesh(name)) return;
    SCOPED_TRACE(name);
    const TriangleMesh mesh = shared_mesh(name);
    Box3 box;
    for (const Vec3& p : mesh.positions) box.add(p);
    expect_mutations_refused(mesh, 1e-4 * box.diagonal(), 7);
  }
}

}  // namespace
}  // namespace remesh
