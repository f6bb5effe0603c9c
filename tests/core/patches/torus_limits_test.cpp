#include "core/patches/curved/torus_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/base/error.h"
#include "tests/support/errors.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

constexpr double kRadius = 5, kTube = 2;

/// Options with a tolerance, and without a number of elements.
Options with_tolerance_alone() {
  Options options;
  options.surface_tolerance = 1;
  return options;
}

/// The limits of a torus, its facets' distance from it, and what is asked.
struct Case {
  CurvedLimits limits{1, 0.2, 0.5, 0.95, 0.3};
  double chord_height = 0.1;
  SurfaceKind kind = SurfaceKind::kTorus;
  Options options = with_tolerance_alone();
};

/// Returns new limits of a torus, of whose facets only those stay whose corners are all within. Each facet is a patch.
CurvedLimits limits_of(const std::function<bool(const Vec3&)>& is_within, const Case& c = {}) {
  const PolygonMesh all = primitives::torus(48, 48, 24, kRadius, kTube).mesh;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::size_t f = 0; f < all.face_count(); ++f) {
    std::vector<std::uint32_t> face;
    bool stays = true;
    for (const VertexId v : all.face(FaceId(f))) {
      face.push_back(v.value);
      stays = stays && is_within(all.positions[v]);
    }
    if (stays) faces.push_back(face);
  }
  const Surface surface = shapes::surface(shapes::from_lists(all.positions.items(), faces));
  PatchSet facets;
  RecognisedSurfaces recognised;
  RecognisedSurface torus;
  torus.shape = {c.kind, {}, {0, 0, 1}, kRadius, kTube, 0};
  torus.input_chord_height = c.chord_height;
  recognised.surfaces.push_back(torus);
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    facets.of_face.push_back(PatchId(f));
    facets.faces.push_back(FaceId(f));
    facets.face_begin.push_back(static_cast<std::uint32_t>(facets.faces.size()));
    facets.planes.push_back({});
    facets.deviation.push_back(0);
    recognised.of_patch.push_back(SurfaceId(0));
  }
  std::vector<CurvedLimits> limits{c.limits};
  RunControl control;
  fit_limits_of_tori({surface, facets, recognised, 1e-9}, curved_goals_of(c.options, 1), limits, control);
  return limits[0];
}

bool is_on_outer_half(const Vec3& p) { return std::hypot(p.x, p.y) > kRadius - 1e-9; }
bool is_on_inner_half(const Vec3& p) { return std::hypot(p.x, p.y) < kRadius + 1e-9; }

bool is_anywhere(const Vec3&) { return true; }

TEST(torus_limits, the_outer_half_of_a_torus_may_be_as_deep_as_its_boundary) {
  const Case c;
  EXPECT_EQ(limits_of(is_on_outer_half).max_height, c.limits.boundary_tolerance);
  EXPECT_EQ(limits_of(is_on_outer_half).boundary_tolerance, c.limits.boundary_tolerance);
}

TEST(torus_limits, where_edges_are_outside_of_the_tube_facets_and_result_share_the_tolerance) {
  for (const auto& is_within : {is_on_inner_half, is_anywhere}) {
    Case c;
    c.limits.max_height = 0.9;
    const CurvedLimits limits = limits_of(is_within, c);
    EXPECT_LT(limits.max_height + c.chord_height, c.limits.tolerance);
    EXPECT_GT(limits.max_height, 0.7 * c.limits.tolerance);
    EXPECT_LE(limits.boundary_tolerance, limits.max_height);
    // Limits that are finer already stay.
    EXPECT_EQ(limits_of(is_within).max_height, Case().limits.max_height);
  }
}

TEST(torus_limits, facets_stay_if_the_coarsest_result_would_be_finer_than_they_are) {
  Case c;
  c.chord_height = 0.05;
  c.limits = {0.1, 0.04, 0.5, 0.095, 0.03};
  EXPECT_EQ(limits_of(is_on_inner_half, c).max_height, c.limits.max_height);
  c.options.refine = false;
  EXPECT_EQ(limits_of(is_on_inner_half, c).tolerance, 0);
  EXPECT_GT(limits_of(is_on_outer_half, c).tolerance, 0);
  c.chord_height = 0.08;
  EXPECT_EQ(limits_of(is_on_outer_half, c).tolerance, 0);
}

TEST(torus_limits, other_surfaces_and_tori_that_stay_facets_are_left_alone) {
  Case cylinder, facets, elements;
  cylinder.kind = SurfaceKind::kCylinder;
  EXPECT_EQ(limits_of(is_on_outer_half, cylinder).max_height, cylinder.limits.max_height);
  facets.limits = {};
  EXPECT_EQ(limits_of(is_on_outer_half, facets).max_height, 0);
  elements.options.elements_per_circle = 16;
  EXPECT_EQ(limits_of(is_on_inner_half, elements).boundary_tolerance, elements.limits.boundary_tolerance);
}

}  // namespace
}  // namespace remesh
