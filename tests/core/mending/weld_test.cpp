#include "core/mending/weld/weld.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "tests/support/errors.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"

namespace remesh {
namespace {

struct Welded {
  Surface surface;
  std::vector<Diagnostic> diagnostics;

  const Diagnostic* find(DiagnosticCode code) const {
    for (const Diagnostic& d : diagnostics)
      if (d.code == code) return &d;
    return nullptr;
  }
};

Welded welded(const PolygonMesh& mesh, const Barriers& barriers = {}) {
  Welded result;
  RunControl control;
  result.surface = weld(mesh, barriers, result.diagnostics, control);
  result.surface.detach();
  return result;
}

std::vector<std::uint32_t> corner_numbers(const Surface& surface) {
  std::vector<std::uint32_t> numbers;
  for (const VertexId v : surface.corners) numbers.push_back(v.value);
  return numbers;
}

TEST(weld, vertices_with_equal_coordinates_become_the_first_of_them) {
  const PolygonMesh mesh =
      shapes::from_lists({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{1, 0, 2}, {3, 5, 4}});
  const Welded result = welded(mesh);
  EXPECT_EQ(result.surface.vertex_count(), 4u);
  EXPECT_EQ(corner_numbers(result.surface), (std::vector<std::uint32_t>{1, 0, 2, 0, 3, 2}));
  EXPECT_EQ(result.surface.vertex_source.items(),
            (FilledIdVector<VertexId, VertexId>::Items{VertexId(0), VertexId(1), VertexId(2), VertexId(5)}));
  ASSERT_NE(result.find(DiagnosticCode::kDuplicateVertex), nullptr);
  EXPECT_EQ(result.find(DiagnosticCode::kDuplicateVertex)->elements, (std::vector<std::uint64_t>{3, 4}));
}

TEST(weld, what_stays_as_it_is_is_not_copied) {
  RunControl control;
  std::vector<Diagnostic> diagnostics;
  const PolygonMesh sound = shapes::box({1, 2, 3}, 2);
  const Surface looking = weld(sound, {}, diagnostics, control);
  EXPECT_EQ(looking.positions.items().data(), sound.positions.items().data());
  EXPECT_EQ(looking.corners.items().data(), sound.corners.data());
  EXPECT_EQ(looking.face_begin.items().data(), sound.face_begin.data());
  // One vertex twice, and one that no face uses.
  for (const auto& points : {std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                             std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 5}}}) {
    PolygonMesh odd = shapes::from_lists(points, {{0, 1, 2}});
    if (points[3] == points[1]) odd.corners[1] = VertexId(3);
    const Surface own = weld(odd, {}, diagnostics, control);
    EXPECT_EQ(own.vertex_count(), 3u);
    EXPECT_NE(own.positions.items().data(), odd.positions.items().data());
    EXPECT_EQ(own.positions[own.corners[1]], points[1]);
  }
}

TEST(weld, minus_zero_equals_zero) {
  const Welded result =
      welded(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {1, 1, 0}}, {{0, 1, 2}, {3, 1, 4}}));
  EXPECT_EQ(result.surface.vertex_count(), 4u);
  EXPECT_EQ(result.surface.corners[3], result.surface.corners[0]);
}

/// Somebody who knows the hash of vertices can choose vertices that are all looked for in one place.
TEST(weld, vertices_chosen_to_collide_are_welded_all_the_same_and_soon) {
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  std::uint64_t inverse = kFactor;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFactor * inverse;
  ASSERT_EQ(kFactor * inverse, 1u);
  // Of (0, 0, z) the hash's lower half is that of `bits * kFactor` with its upper half upon it: here always 0.
  PolygonMesh mesh;
  for (std::uint64_t i = 1; mesh.vertex_count() < 60'000; ++i) {
    const auto z = std::bit_cast<double>((i << 32 | i) * inverse);
    if (!(std::fabs(z) < 1e100 && std::fabs(z) > 1e-100)) continue;
    mesh.positions.push_back({0, 0, z});
    mesh.positions.push_back({-0.0, 0, z});
  }
  for (std::uint32_t v = 0; v + 2 < mesh.vertex_count(); ++v) {
    for (std::uint32_t i = 0; i < 3; ++i) mesh.corners.emplace_back(v + i);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  const Welded result = welded(mesh);
  EXPECT_EQ(result.surface.vertex_count(), 30'000u);
  EXPECT_EQ(result.find(DiagnosticCode::kDuplicateVertex)->count, 30'000u);
  for (std::uint32_t v = 0; v < result.surface.vertex_count(); ++v)
    ASSERT_EQ(result.surface.vertex_source[VertexId(v)], VertexId(2 * v));
}

TEST(weld, neighbouring_doubles_stay_apart) {
  const double next = std::nextafter(1.0, 2.0);
  const Welded result =
      welded(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {next, 0, 0}}, {{0, 1, 2}, {0, 3, 2}}));
  EXPECT_EQ(result.surface.vertex_count(), 4u);
  EXPECT_TRUE(result.diagnostics.empty());
}

TEST(weld, vertices_that_no_face_uses_are_dropped_and_counted) {
  // The unused one at the origin must not become the source of the used one.
  const Welded result =
      welded(shapes::from_lists({{0, 0, 0}, {9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{2, 3, 4}}));
  EXPECT_EQ(result.surface.vertex_count(), 3u);
  EXPECT_EQ(result.surface.vertex_source[VertexId(0)], VertexId(2));
  ASSERT_NE(result.find(DiagnosticCode::kUnusedVertex), nullptr);
  EXPECT_EQ(result.find(DiagnosticCode::kUnusedVertex)->elements, (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(result.find(DiagnosticCode::kDuplicateVertex), nullptr);
}

TEST(weld, a_mesh_without_faces_is_an_error) {
  try {
    welded(shapes::from_lists({{0, 0, 0}}, {}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, Code::kEmptyMesh);
  }
}

TEST(weld, positions_keep_their_bits) {
  const PolygonMesh mesh = shapes::rotated(shapes::box({1, 2, 3}), {1, 2, 3}, 17);
  const Welded result = welded(mesh);
  for (std::uint32_t v = 0; v < result.surface.vertex_count(); ++v)
    EXPECT_EQ(result.surface.positions[VertexId(v)], mesh.positions[result.surface.vertex_source[VertexId(v)]]);
}

TEST(weld, local_coordinates_lie_within_the_unit_box_and_the_unit_is_a_power_of_two) {
  for (const double size : {1e-300, 1e-6, 1.0, 3.0, 1e30, 3.4e38, 1e150}) {
    const Surface surface = welded(shapes::scaled(shapes::box({1, 2, 3}), size)).surface;
    int exponent = 0;
    EXPECT_EQ(std::frexp(surface.unit, &exponent), 0.5) << size;
    double reach = 0;
    for (const Vec3& p : surface.local) reach = std::max({reach, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    EXPECT_LE(reach, 1) << size;
    EXPECT_GE(reach, 0.25) << size;
  }
}

STAGE(weld, test::kScale) {
  const PolygonMesh mesh = trial.of(shapes::rotated(shapes::box({1, 2, 3}, 2), {1, 2, 3}, 17));
  for (const Vec3& p : welded(mesh).surface.local) trial.in_order(p);
}

TEST(weld, labels_are_numbered_in_order_of_first_use) {
  PolygonMesh mesh = with_groups(shapes::sheet(2, 1, 2, 1), {2, 0, 0, 2});
  mesh.labels.material.names = {"steel", "lead"};
  mesh.labels.material.of_face.items() = {0, 0, 1, 0};
  EXPECT_EQ(welded(mesh).surface.face_label.items(), (std::vector<std::uint32_t>{0, 1, 2, 0}));
  Barriers groups_only;
  groups_only.material = false;
  EXPECT_EQ(welded(mesh, groups_only).surface.face_label.items(), (std::vector<std::uint32_t>{0, 1, 1, 0}));
  EXPECT_TRUE(welded(mesh, {false, false, false}).surface.face_label.empty());
}

Welded welded_within(const PolygonMesh& mesh, double tolerance) {
  Welded result;
  RunControl control;
  result.surface = weld(mesh, {}, result.diagnostics, control, tolerance);
  result.surface.detach();
  return result;
}

/// Makes a mesh with a vertex at each place. All of them are in one face.
PolygonMesh at(const std::vector<Vec3>& places) {
  std::vector<std::uint32_t> loop(places.size());
  for (std::uint32_t i = 0; i < loop.size(); ++i) loop[i] = i;
  return shapes::from_lists(places, {loop});
}

TEST(weld, within_a_tolerance_the_smallest_stands_for_its_neighbours) {
  const Welded result =
      welded_within(at({{1.01, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0.02}, {1, 0, 0}}), 0.03);
  EXPECT_EQ(corner_numbers(result.surface), (std::vector<std::uint32_t>{0, 1, 0, 2, 0, 0}));
  EXPECT_EQ(result.surface.positions[VertexId(0)], (Vec3{1, 0, 0}));
  EXPECT_EQ(result.surface.vertex_source[VertexId(0)], VertexId(2));
  ASSERT_NE(result.find(DiagnosticCode::kDuplicateVertex), nullptr);
  EXPECT_EQ(result.find(DiagnosticCode::kDuplicateVertex)->elements, (std::vector<std::uint64_t>{0, 4, 5}));
  EXPECT_EQ(result.diagnostics.size(), 1u);
}

TEST(weld, a_chain_of_near_vertices_does_not_collapse_and_is_reported) {
  std::vector<Vec3> places;
  for (int i = 0; i < 10; ++i) places.push_back({0.9 * i, 0, 0});
  const Welded result = welded_within(at(places), 1);
  EXPECT_EQ(result.surface.vertex_count(), 5u);
  ASSERT_EQ(result.diagnostics.size(), 2u);
  EXPECT_EQ(result.diagnostics[0].count, 5u);
  EXPECT_EQ(result.diagnostics[1].code, DiagnosticCode::kDuplicateVertex);
  EXPECT_EQ(result.diagnostics[1].count, 4u);
}

TEST(weld, no_vertex_moves_further_than_the_tolerance_and_those_that_stay_are_further_apart) {
  for (const double scale : {1.0, 1e-200, 1e200}) {
    Random random(5);
    std::vector<Vec3> places;
    for (int i = 0; i < 2000; ++i)
      places.push_back({scale * random.unit(), scale * random.unit(), scale * 0.1 * random.unit()});
    const double tolerance = 0.03 * scale;
    const Welded result = welded_within(at(places), tolerance);
    EXPECT_GT(result.surface.vertex_count(), 100u);
    for (std::size_t i = 0; i < places.size(); ++i)
      EXPECT_LE(norm(result.surface.positions[result.surface.corners[i]] - places[i]), tolerance);
    for (std::uint32_t v = 0; v < result.surface.vertex_count(); ++v)
      for (std::uint32_t w = 0; w < v; ++w)
        EXPECT_GT(norm(result.surface.positions[VertexId(v)] - result.surface.positions[VertexId(w)]), tolerance);
  }
}

TEST(weld, places_in_the_middle_of_a_cell_find_their_neighbours) {
  // 0.3 less 0.1 is less than 0.2 to a computer, and 0.3 and 0.1 are 0.4.
  for (const double tolerance : {0.1, 0.3, 0.7, 1e-5, 1e-160})
    for (int k = -40; k <= 40; ++k)
      for (const double large : {0.0, 0x1p52, 0x1p53, 0x1p54, 0x1p60, 1e150}) {
        const double x = (large + k + 0.5) * 2 * tolerance;
        const PolygonMesh mesh =
            at({{x, 0, 0}, {x, 0.5 * tolerance, 0}, {x, 9 * tolerance, 0}, {x, 9 * tolerance, 0.5 * tolerance}});
        EXPECT_EQ(welded_within(mesh, tolerance).find(DiagnosticCode::kDuplicateVertex)->count, 2u)
            << tolerance << " " << k << " " << large;
      }
}

/// Vertices far apart whose cells have one hash: their lower bits are as a rule of the hash wants them.
TEST(weld, cells_chosen_to_collide_are_welded_all_the_same_and_soon) {
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  std::uint64_t inverse = kFactor;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFactor * inverse;
  constexpr std::uint64_t kFraction = (std::uint64_t{1} << 47) - 1, kExponent = std::bit_cast<std::uint64_t>(0x1p52);
  const auto step = [&](std::uint64_t hash, double c) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(c)) * kFactor;
    return hash ^ hash >> 29;
  };
  Random random(7);
  constexpr std::size_t kVertices = 60'000;
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 18) - 1;
  std::vector<Vec3> places;
  while (places.size() < kVertices) {
    const double x = std::floor((1 + random.unit()) * 0x1p52), y = std::floor((1 + random.unit()) * 0x1p52);
    const std::uint64_t before = step(step(0, x), y);
    const auto above = static_cast<std::uint64_t>(random.unit() * 0x1p29) << 18;
    const std::uint64_t product = above | (above >> 29 & kMask);
    const auto z = std::bit_cast<double>(((before ^ (product * inverse)) & kFraction) | kExponent);
    if ((step(before, z) & kMask) == 0) places.push_back({x, y, z});
  }
  // These are numbers of cells, which are 2 wide. Others have something to be welded.
  for (Vec3& p : places) p = 2.0 * p;
  constexpr int kPairs = 1000;
  for (int i = 0; i < kPairs; ++i) places.insert(places.end(), {{3.0 * i, 0, 0}, {3.0 * i, 0.5, 0}});
  Welded result;
  test::expect_within(test::Seconds(3), [&] { result = welded_within(at(places), 1); });
  EXPECT_EQ(result.surface.vertex_count(), kVertices + kPairs);
}

TEST(weld, a_mesh_too_large_for_doubles_is_refused_with_a_vertex_that_makes_it_so) {
  for (const double side : {0x1p1023, 0x1.fp1023}) {
    const PolygonMesh box = shapes::scaled(shapes::box({1, 1, 1}), side);
    const Error error = test::error_of([&] { welded(box); });
    EXPECT_EQ(error.code, Code::kCoordinateRange);
    ASSERT_TRUE(error.element.has_value());
    const Vec3& p = box.positions[VertexId(static_cast<std::size_t>(*error.element))];
    EXPECT_EQ(std::max({p.x, p.y, p.z}), side);
  }
  for (const double side : {0x1p1022, 0x1.fp1022})
    EXPECT_EQ(welded(shapes::scaled(shapes::box({1, 1, 1}), side)).surface.vertex_count(), 8u);
}

TEST(weld, a_mesh_too_small_for_doubles_is_refused) {
  for (const double side : {5e-324, 1e-310, 0x1.fp-1022}) {
    const Error error = test::error_of([&] { welded(shapes::scaled(shapes::box({1, 1, 1}), side)); });
    EXPECT_EQ(error.code, Code::kCoordinateRange);
    EXPECT_EQ(error.stage, Stage::kWeld);
  }
  for (const double side : {0x1p-1021, 0x1.fp-1021})
    EXPECT_EQ(welded(shapes::scaled(shapes::box({1, 1, 1}), side)).surface.vertex_count(), 8u);
  // All in one place is another matter.
  EXPECT_EQ(
      welded(shapes::from_lists({{5e-324, 0, 0}, {5e-324, 0, 0}, {5e-324, 0, 0}}, {{0, 1, 2}})).surface.vertex_count(),
      1u);
}

TEST(weld, a_tolerance_below_all_distances_changes_nothing) {
  const PolygonMesh mesh = shapes::box({1, 2, 3}, 4);
  for (const double tolerance : {1e-300, 1e-15, 0.1})
    EXPECT_EQ(welded_within(mesh, tolerance).surface.positions, welded(mesh).surface.positions);
}

}  // namespace
}  // namespace remesh
