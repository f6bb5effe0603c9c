#include "core/patches/torus_limits.h"

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

/// Returns the limits of a torus, of whose facets only those stay whose corners are all within. Each facet is a patch.
CurvedLimits limits_of(const std::function<bool(const Vec3&)>& is_within, const CurvedLimits& before,
                       SurfaceKind kind = SurfaceKind::kTorus) {
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
  torus.shape = {kind, {}, {0, 0, 1}, kRadius, kTube, 0};
  recognised.surfaces.push_back(torus);
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    facets.of_face.push_back(PatchId(f));
    facets.faces.push_back(FaceId(f));
    facets.face_begin.push_back(static_cast<std::uint32_t>(facets.faces.size()));
    facets.planes.push_back({});
    facets.deviation.push_back(0);
    recognised.of_patch.push_back(SurfaceId(0));
  }
  std::vector<CurvedLimits> limits{before};
  RunControl control;
  deepen_tori(surface, facets, recognised, 1e-9, limits, control);
  return limits[0];
}

bool is_on_outer_half(const Vec3& p) { return std::hypot(p.x, p.y) > kRadius - 1e-9; }
bool is_on_inner_half(const Vec3& p) { return std::hypot(p.x, p.y) < kRadius + 1e-9; }

constexpr CurvedLimits kBefore{1, 0.2, 0.5, 0.9, 0.3};

TEST(torus_limits, the_outer_half_of_a_torus_may_be_as_deep_as_its_boundary) {
  EXPECT_EQ(limits_of(is_on_outer_half, kBefore).max_height, kBefore.boundary_tolerance);
}

TEST(torus_limits, where_edges_are_outside_of_the_tube_the_limits_stay) {
  EXPECT_EQ(limits_of(is_on_inner_half, kBefore).max_height, kBefore.max_height);
  EXPECT_EQ(limits_of([](const Vec3&) { return true; }, kBefore).max_height, kBefore.max_height);
}

TEST(torus_limits, other_surfaces_and_tori_that_stay_facets_are_left_alone) {
  EXPECT_EQ(limits_of(is_on_outer_half, kBefore, SurfaceKind::kCylinder).max_height, kBefore.max_height);
  EXPECT_EQ(limits_of(is_on_outer_half, {}).max_height, 0);
}

}  // namespace
}  // namespace remesh
