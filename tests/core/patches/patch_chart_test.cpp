#include "core/patches/charts/patch_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

TEST(patch_chart, arcs_outside_of_a_planes_outline_are_within_its_frame_too) {
  // The frame of seven corners of a circle must have room for the whole circle. It depends on the model's size whether
  // the power of two above the corners has.
  constexpr int kCorners = 7, kSizes = 16;
  for (int size = 0; size < kSizes; ++size) {
    const double radius = std::exp2(static_cast<double>(size) / kSizes);
    const StageChain chain(primitives::cylinder(kCorners, radius, 3).mesh);
    CurvedPatches curved;
    curved.at.resize(chain.patches.count(), kNone);
    for (std::uint32_t p = 0; p < chain.patches.count(); ++p)
      if (std::fabs(chain.patches.planes[PatchId(p)].normal.z) < 0.5) {
        // One of the facets stands for a curved patch.
        curved.at[PatchId(p)] = 0;
        curved.curved.push_back(
            {SurfaceId(0), SurfaceMap({SurfaceKind::kCylinder, {}, {0, 0, 1}, radius, 0, 0}, {{radius, 0, 0}, false}),
             CurvedLimits{1, 1, 1, 1, 1}, 1});
        break;
      }
    PatchCharts charts(chain.surface, chain.patches, &curved, {}, chain.control);
    for (std::uint32_t p = 0; p < chain.patches.count(); ++p) {
      if (std::fabs(chain.patches.planes[PatchId(p)].normal.z) < 0.5) continue;
      std::vector<Vec3> points;
      std::vector<Edge3> edges;
      const double z = chain.surface.positions[chain.surface.face(chain.patches.faces_of(PatchId(p))[0])[0]].z;
      const auto at = [&](double part) {
        const double angle = 2 * std::numbers::pi * part;
        return Vec3{radius * std::cos(angle), radius * std::sin(angle), z};
      };
      for (int k = 0; k < kCorners; ++k) points.push_back(at(static_cast<double>(k) / kCorners));
      for (int k = 0; k < kCorners; ++k)
        edges.push_back({points[static_cast<std::size_t>(k)], points[static_cast<std::size_t>((k + 1) % kCorners)]});
      const PatchChart chart = charts.project(PatchId(p), points, edges, kPatchGrid);
      for (int i = 0; i < 100; ++i) {
        const Vec2 place = chart.to_plane(at(i / 100.0));
        EXPECT_LE(std::fabs(place.x), 1) << size;
        EXPECT_LE(std::fabs(place.y), 1) << size;
      }
    }
  }
}

}  // namespace
}  // namespace remesh
