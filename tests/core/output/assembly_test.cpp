#include "core/output/result/assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using Edge = std::pair<VertexId, VertexId>;

TEST(assembly, the_faces_of_the_patches_are_joined_over_common_vertices) {
  const StageChain chain(shapes::box({1, 2, 3}, 3));
  const Assembled out = assembly(chain.surface.vertex_count(), chain.meshes, chain.control);
  EXPECT_EQ(out.vertex.size(), 8u);
  EXPECT_EQ(out.faces.size(), 12u);
  ASSERT_EQ(out.face_patch.size(), out.faces.size());
  ASSERT_EQ(out.corner_uv.size(), 3 * out.faces.size());
  EXPECT_TRUE(std::is_sorted(out.vertex.begin(), out.vertex.end()));
  EXPECT_TRUE(std::is_sorted(out.face_patch.begin(), out.face_patch.end()));
  std::map<Edge, int> balance;
  for (std::uint32_t f = 0; f < out.faces.size(); ++f) {
    const PatchMesh& patch = chain.meshes[out.face_patch[FaceId(f)]];
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = out.faces[FaceId(f)][k], b = out.faces[FaceId(f)][(k + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
      const auto at = std::find(patch.vertices.begin(), patch.vertices.end(), out.vertex[a]);
      ASSERT_NE(at, patch.vertices.end());
      EXPECT_EQ(out.corner_uv[3 * f + k], patch.uv[static_cast<std::size_t>(at - patch.vertices.begin())]);
    }
  }
  EXPECT_EQ(balance.size(), 18u);
  for (const auto& [edge, count] : balance) EXPECT_EQ(count, 0) << "closed";
}

TEST(assembly, vertices_that_no_triangle_uses_are_left_out) {
  const StageChain chain(shapes::noisy_sheet(4, 1));
  EXPECT_EQ(assembly(chain.surface.vertex_count(), chain.meshes, chain.control).vertex.size(), 4u);
}

}  // namespace
}  // namespace remesh
