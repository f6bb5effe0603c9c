#include "core/patches/charts/patch_locator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/geometry/planes/projection.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// The locator of a mesh's first patch.
struct Located {
  explicit Located(const PolygonMesh& mesh)
      : chain(mesh),
        faces(chain.patches.faces_of(PatchId(0))),
        chart(chain.charts()[PatchId(0)]),
        locator(chain.surface, faces, chart, chain.control) {}

  Vec2 uv(VertexId v) const { return chart.to_plane(chain.surface.positions[v]); }

  StageChain chain;
  std::span<const FaceId> faces;
  PatchChart chart;
  PatchLocator locator;
};

double distance_to_segment(Vec2 a, Vec2 b, Vec2 p) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}

/// Returns the distance of p from a convex face whose corners run counter-clockwise.
double distance_to_loop(const std::vector<Vec2>& loop, Vec2 p) {
  bool is_inside = true;
  double distance = HUGE_VAL;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
    is_inside = is_inside && cross(b - a, p - a) >= 0;
    distance = std::min(distance, distance_to_segment(a, b, p));
  }
  return is_inside ? 0 : distance;
}

TEST(patch_locator, it_finds_the_nearest_face) {
  for (const PolygonMesh& mesh : {shapes::sheet(3, 2, 17, 13), shapes::noisy_sheet(12, 1), shapes::ring(8),
                                  shapes::quad_box({1, 2, 3}, 5), shapes::plate_with_round_hole(64)}) {
    const Located in(mesh);
    Random random(1);
    for (int i = 0; i < 200; ++i) {
      const Vec2 p{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
      std::vector<double> distances;
      for (const FaceId f : in.faces) {
        std::vector<Vec2> loop;
        for (const VertexId v : in.chain.surface.face(f)) loop.push_back(in.uv(v));
        distances.push_back(distance_to_loop(loop, p));
      }
      const PatchLocator::Place found = in.locator.nearest(p);
      ASSERT_LT(found.face, distances.size());
      EXPECT_LE(distances[found.face], *std::min_element(distances.begin(), distances.end()) + 1e-12);
      const auto loop = in.chain.surface.face(in.faces[found.face]);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NE(std::find(loop.begin(), loop.end(), found.corners[k]), loop.end());
        EXPECT_EQ(found.uv[k], in.uv(found.corners[k]));
      }
    }
  }
}

TEST(patch_locator, of_equally_near_faces_it_is_the_first) {
  // Coordinates that are exact in the plane, too.
  const Located in(shapes::sheet(4, 4, 16, 16));
  for (std::uint32_t v = 0; v < in.chain.surface.vertex_count(); ++v) {
    std::uint32_t first = 0;
    while (true) {
      const auto loop = in.chain.surface.face(in.faces[first]);
      if (std::find(loop.begin(), loop.end(), VertexId(v)) != loop.end()) break;
      ++first;
    }
    EXPECT_EQ(in.locator.nearest(in.uv(VertexId(v))).face, first) << VertexId(v);
  }
}

STAGE(patch_locator, test::kStop) {
  const StageChain chain(shapes::sheet(1, 1, 2, 2));
  PatchLocator(chain.surface, chain.patches.faces_of(PatchId(0)), chain.charts()[PatchId(0)], trial.control);
}

}  // namespace
}  // namespace remesh
