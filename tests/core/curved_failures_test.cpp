// Tests what becomes of curved patches where they or their neighbours fail.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// Makes a cylinder whose lid overlaps itself: a corner of one of the lid's triangles lies beside the vertex at which
/// it belongs.
PolygonMesh cylinder_with_torn_lid(std::uint32_t n) {
  std::vector<Vec3> positions;
  for (const auto& [radius, height] : {std::pair(5.0, 0.0), {5.0, 10.0}, {3.0, 10.0}})
    for (std::uint32_t i = 0; i < n; ++i)
      positions.push_back(
          {radius * std::cos(2 * std::numbers::pi * i / n), radius * std::sin(2 * std::numbers::pi * i / n), height});
  const std::uint32_t torn = 3 * n, replaced = 2 * n + 3;
  positions.push_back(positions[replaced] + Vec3{0.005, -0.002, 0});
  std::vector<std::vector<std::uint32_t>> faces(2);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n, inner = 2 * n + i;
    faces[0].push_back(n - 1 - i);
    faces[1].push_back(inner);
    faces.push_back({i, j, n + j, n + i});
    faces.push_back({inner, n + i, n + j});
    faces.push_back({inner == replaced ? torn : inner, n + j, 2 * n + j});
  }
  return shapes::from_lists(positions, faces);
}

bool is_any(const Report& report, PatchStatus status) {
  return std::any_of(report.patches.begin(), report.patches.end(),
                     [&](const PatchSummary& patch) { return patch.status == status; });
}

TEST(curved_failures, planes_that_cannot_be_triangulated_beside_joined_facets_take_a_few_steps) {
  // The curved patches beside such a plane may be at fault, so they become facets again. Then the plane is cut up.
  for (const double elements : {8.0, 16.0, 36.0}) {
    Options options;
    options.elements_per_circle = elements;
    RunControl control;
    const Result result = remesh_surface(cylinder_with_torn_lid(24), options, {}, control);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_TRUE(is_any(result.report, PatchStatus::kReduced));
  }
}

TEST(curved_failures, beside_sides_that_turn_too_far_and_are_not_cut_nothing_is_put_in) {
  // Each triangle at such a side has edges that turn too far as well, however near to the side its third corner is.
  for (const double elements : {48.0, 100.0, 300.0}) {
    Options options;
    options.refine = false;
    options.keep_boundary_vertices = true;
    options.elements_per_circle = elements;
    RunControl control;
    const PolygonMesh plate = shapes::plate_with_round_hole(24);
    const Result result = remesh_surface(plate, options, {}, control);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_FALSE(is_any(result.report, PatchStatus::kReduced));
    EXPECT_EQ(result.mesh.positions.size(), plate.positions.size());
  }
}

/// Makes a cylinder with a low roof. At each of its `n` rim edges lies a triangle whose other sides are shorter.
PolygonMesh cylinder_with_roof(std::uint32_t n) {
  std::vector<Vec3> positions;
  for (const auto& [radius, height, start] : {std::tuple(5.0, 0.0, 0.0), {5.0, 10.0, 0.0}, {4.7, 10.1, 0.5}})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + start) / n;
      positions.push_back({radius * std::cos(angle), radius * std::sin(angle), height});
    }
  std::vector<std::vector<std::uint32_t>> faces(2);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    faces[0].push_back(n - 1 - i);
    faces[1].push_back(2 * n + i);
    faces.push_back({i, j, n + j, n + i});
    faces.push_back({n + i, n + j, 2 * n + i});
    faces.push_back({2 * n + i, n + j, 2 * n + j});
  }
  return shapes::from_lists(positions, faces);
}

TEST(curved_failures, single_triangles_beside_a_finer_boundary_are_sound_at_once) {
  for (const bool is_refined : {false, true})
    for (const double elements : {30.0, 48.0, 60.0}) {
      Options options;
      options.refine = is_refined;
      options.elements_per_circle = elements;
      RunControl control;
      const Result result = remesh_surface(cylinder_with_roof(24), options, {}, control);
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_FALSE(is_any(result.report, PatchStatus::kReduced)) << elements;
      EXPECT_GE(result.mesh.faces.size(), 3 * elements) << "the wall and the floor";
    }
}

}  // namespace
}  // namespace remesh
