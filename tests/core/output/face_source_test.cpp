#include "core/output/result/face_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const double t = std::clamp(dot(p - a, b - a) / norm_squared(b - a), 0.0, 1.0);
  return norm(p - (a + t * (b - a)));
}

/// Returns the distance from a convex face to a point in its plane.
double distance_to_face(const PolygonMesh& mesh, FaceId f, const Vec3& p) {
  const auto loop = mesh.face(f);
  Vec3 normal;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    normal +=
        cross(mesh.positions[loop[i]] - mesh.positions[loop[0]], mesh.positions[loop[i + 1]] - mesh.positions[loop[0]]);
  normal = normalized(normal);
  bool is_inside = true;
  double distance = HUGE_VAL;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = mesh.positions[loop[i]], b = mesh.positions[loop[(i + 1) % loop.size()]];
    is_inside = is_inside && dot(cross(b - a, p - a), normal) >= 0;
    distance = std::min(distance, distance_to_segment(a, b, p));
  }
  return is_inside ? std::fabs(dot(p - mesh.positions[loop[0]], normal)) : distance;
}

/// Expects that every output face has a source in its own patch, which is as near to its centroid as any face of that
/// patch.
void expect_nearest(const PolygonMesh& mesh) {
  const StageChain chain(mesh);
  const auto source = face_source(chain.surface, chain.patches, chain.triangulated, chain.control);
  std::uint32_t at = 0;
  for (std::uint32_t p = 0; p < chain.meshes.size(); ++p) {
    const PatchMesh& patch = chain.meshes[PatchId(p)];
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3, ++at) {
      const auto corner = [&](std::uint32_t k) {
        return chain.surface.positions[patch.vertices[patch.mesh.from(h + k)]];
      };
      const Vec3 centroid = (1.0 / 3) * (corner(0) + corner(1) + corner(2));
      ASSERT_LT(at, source.size());
      double nearest = HUGE_VAL;
      bool is_of_patch = false;
      for (const FaceId f : chain.patches.faces_of(PatchId(p))) {
        const FaceId input = chain.surface.face_source[f];
        nearest = std::min(nearest, distance_to_face(mesh, input, centroid));
        is_of_patch = is_of_patch || input == source[FaceId(at)];
      }
      EXPECT_TRUE(is_of_patch);
      EXPECT_LE(distance_to_face(mesh, source[FaceId(at)], centroid), nearest + 1e-9);
    }
  }
  EXPECT_EQ(at, source.size());
}

TEST(face_source, it_is_the_nearest_face_of_the_patch) {
  expect_nearest(shapes::sheet(3, 2, 17, 13));
  expect_nearest(shapes::ring(8));
  expect_nearest(shapes::noisy_sheet(12, 1));
  expect_nearest(shapes::quad_box({1, 2, 3}, 5));
  expect_nearest(shapes::rotated(shapes::l_bracket(6), {1, 2, 3}, 40));
  expect_nearest(shapes::plate_with_round_hole(64));
  expect_nearest(shapes::cylinder(30, 1, 2));
}

TEST(face_source, a_patch_of_one_face_is_its_own_source) {
  const StageChain chain(shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}));
  const auto source = face_source(chain.surface, chain.patches, chain.triangulated, chain.control);
  EXPECT_EQ(source.items(), std::vector<FaceId>(4, FaceId(0)));
}

TEST(face_source, it_counts_as_the_input_does) {
  // A zero-area face in front, which the surface lacks.
  const StageChain chain(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 1, 2}}));
  const auto source = face_source(chain.surface, chain.patches, chain.triangulated, chain.control);
  EXPECT_EQ(source.items(), std::vector<FaceId>{FaceId(1)});
}

}  // namespace
}  // namespace remesh
