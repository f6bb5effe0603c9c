#include "core/stages/assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

using Edge = std::pair<VertexId, VertexId>;

/// Undirected edges inside each patch, by surface vertices.
std::map<Edge, int> inside_edges(const std::vector<PatchMesh>& meshes) {
  std::map<Edge, int> edges;
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
      const std::uint32_t g = patch.mesh.twin(h);
      const bool is_border = g == Triangulation2d::kNone;
      if (!is_border && g > h)
        ++edges[std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)])];
    }
  return edges;
}

std::set<Edge> border_edges(const std::vector<PatchMesh>& meshes) {
  std::set<Edge> edges;
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      if (patch.mesh.twin(h) == Triangulation2d::kNone)
        edges.insert(std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]));
  return edges;
}

void expect_no_shared_chord(const std::vector<PatchMesh>& meshes) {
  const std::set<Edge> borders = border_edges(meshes);
  for (const auto& [edge, uses] : inside_edges(meshes)) {
    EXPECT_EQ(uses, 1) << edge.first << '-' << edge.second;
    EXPECT_FALSE(borders.count(edge)) << edge.first << '-' << edge.second;
  }
}

/// Two patches folded together along a bent border (0 1 2): the Delaunay diagonal of both is the chord 0-2.
PolygonMesh folded_along_a_bent_border(const Vec3& corner_of_the_second) {
  return shapes::from_lists({{-1, 0, 0}, {0, -0.25, 0}, {1, 0, 0}, {0, 4, 0}, corner_of_the_second},
                            {{0, 1, 2, 3}, {2, 1, 0, 4}});
}

TEST(resolve_chords, two_patches_that_pick_the_same_diagonal_are_told_apart) {
  StageChain chain(folded_along_a_bent_border({0, 5, 0}));
  ASSERT_EQ(chain.meshes.size(), 2u);
  ASSERT_EQ(inside_edges(chain.meshes).size(), 1u) << "both picked the same";
  EXPECT_TRUE(resolve_chords(chain.meshes, chain.control).empty());
  EXPECT_EQ(inside_edges(chain.meshes).size(), 2u);
  expect_no_shared_chord(chain.meshes);
  for (const PatchMesh& patch : chain.meshes) expect_valid(patch.uv, patch.mesh);
}

TEST(resolve_chords, both_sides_of_a_rhombus_do_not_share_their_diagonal) {
  StageChain chain(shapes::from_lists({{-4, 0, 0}, {0, -1, 0}, {4, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}}));
  ASSERT_EQ(chain.meshes.size(), 2u);
  ASSERT_EQ(inside_edges(chain.meshes).size(), 1u) << "the same four corners, so the same Delaunay diagonal";
  EXPECT_TRUE(resolve_chords(chain.meshes, chain.control).empty());
  expect_no_shared_chord(chain.meshes);
}

TEST(resolve_chords, the_patch_of_lowest_id_keeps_its_edge) {
  StageChain chain(folded_along_a_bent_border({0, 5, 0}));
  const auto before = triangles_of(chain.meshes[0].mesh);
  resolve_chords(chain.meshes, chain.control);
  EXPECT_EQ(triangles_of(chain.meshes[0].mesh), before);
}

TEST(resolve_chords, where_no_flip_helps_the_patch_is_named) {
  // The second patch is reflex at corner 2: the chord is its only diagonal.
  StageChain chain(folded_along_a_bent_border({5, 0.5, 0}));
  ASSERT_EQ(chain.patches.count(), 2u);
  EXPECT_EQ(resolve_chords(chain.meshes, chain.control), std::vector<PatchId>{PatchId(1)});
}

TEST(resolve_chords, an_edge_that_is_another_patches_border_is_flipped_away) {
  // The square 0 1 2 3 has its diagonal 0-2 inside; a fin stands on the very vertices 0 and 2.
  StageChain chain(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
                                      {{0, 1, 3}, {1, 2, 3}, {0, 2, 4}}));
  ASSERT_EQ(chain.patches.count(), 2u);
  const auto square = chain.patch_of(0);
  ASSERT_TRUE(border_edges(chain.meshes).count({chain.at({0, 0, 0}), chain.at({1, 1, 0})}));
  EXPECT_TRUE(resolve_chords(chain.meshes, chain.control).empty());
  expect_no_shared_chord(chain.meshes);
  expect_valid(chain.meshes[square.value].uv, chain.meshes[square.value].mesh);
}

TEST(resolve_chords, patches_without_common_chords_stay_as_they_are) {
  StageChain chain(shapes::l_bracket(3));
  std::vector<std::vector<Corners>> before;
  for (const PatchMesh& patch : chain.meshes) before.push_back(triangles_of(patch.mesh));
  EXPECT_TRUE(resolve_chords(chain.meshes, chain.control).empty());
  for (std::size_t p = 0; p < before.size(); ++p) EXPECT_EQ(triangles_of(chain.meshes[p].mesh), before[p]);
}

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
    const PatchMesh& patch = chain.meshes[out.face_patch[FaceId(f)].value];
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
