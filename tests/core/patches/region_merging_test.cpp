// Tests, through coplanar_regions, that regions are merged that have one plane after all.
#include "core/patches/planar/region_merging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kSheetTolerance = 1e-4;

/// Makes a unit sheet of n x n squares. Every tenth vertex is lifted, and all are moved up or down by noise. Both are
/// given in tolerances.
PolygonMesh lifted_sheet(int n, double lift, double noise) {
  Random random(1);
  PolygonMesh mesh = shapes::sheet(1, 1, n, n);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    mesh.positions[VertexId(v)].z = kSheetTolerance * ((v % 10 == 0 ? lift : 0) + random.uniform(-noise, noise));
  return mesh;
}

/// Expects that all corners of a region are within half the tolerance of its plane. The farthest of them is as far as
/// its deviation says.
void expect_in_band(const StageChain& chain) {
  std::map<RegionId, double> farthest;
  for (FaceId f(0); f.value < chain.surface.face_count(); ++f.value) {
    const RegionId region = chain.regions.of_face[f];
    for (const VertexId v : chain.surface.face(f)) {
      const double distance = std::fabs(chain.regions.planes[region].distance(chain.surface.local[v]));
      farthest[region] = std::max(farthest[region], distance);
    }
  }
  for (const auto& [region, distance] : farthest) {
    EXPECT_LE(distance, chain.tolerance / 2 * (1 + 1e-9));
    EXPECT_EQ(chain.regions.deviation[region], distance);
  }
}

TEST(merge_regions, corners_in_one_band_are_one_region_however_many_attempts_fail_before) {
  // Growth begins in the plane of most vertices, from which the lifted ones are too far, so it leaves many pieces.
  for (const int n : {50, 100, 150, 200}) {
    for (const auto& [lift, noise] : {std::pair(0.66, 0.0), {0.66, 0.1}, {0.3, 0.3}}) {
      const StageChain chain(lifted_sheet(n, lift, noise), kSheetTolerance);
      EXPECT_EQ(chain.region_count(), 1u) << n << ' ' << lift << ' ' << noise;
      expect_in_band(chain);
    }
  }
}

TEST(merge_regions, on_either_side_of_a_slight_fold_there_is_one_region) {
  // The sides hang together, so that growth goes by pieces of them.
  for (const auto& [lift, noise] : {std::pair(0.66, 0.0), {0.66, 0.1}, {0.3, 0.3}}) {
    PolygonMesh mesh = lifted_sheet(100, lift, noise);
    for (Vec3& p : mesh.positions) p.z += 0.05 * std::max(0.0, p.x - 0.6);
    const StageChain chain(mesh, kSheetTolerance);
    EXPECT_EQ(chain.region_count(), 2u) << lift << ' ' << noise;
    expect_in_band(chain);
  }
}

}  // namespace
}  // namespace remesh
