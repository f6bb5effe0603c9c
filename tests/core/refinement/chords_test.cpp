#include "core/refinement/rounds/chords.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/triangulation_checks.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using Edge = std::pair<VertexId, VertexId>;

/// Counts the undirected edges inside patches between vertices of the surface.
std::map<Edge, int> inside_edges(const PatchMeshes& meshes) {
  std::map<Edge, int> edges;
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
      const std::uint32_t g = patch.mesh.twin(h);
      const bool is_border = g == Triangulation2d::kNoHalfEdge;
      const Edge edge = std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]);
      if (!is_border && g > h && edge.second.is_valid()) ++edges[edge];
    }
  return edges;
}

std::set<Edge> border_edges(const PatchMeshes& meshes) {
  std::set<Edge> edges;
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      if (patch.mesh.twin(h) == Triangulation2d::kNoHalfEdge)
        edges.insert(std::minmax(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]));
  return edges;
}

void expect_no_shared_chord(const PatchMeshes& meshes) {
  const std::set<Edge> borders = border_edges(meshes);
  for (const auto& [edge, uses] : inside_edges(meshes)) {
    EXPECT_EQ(uses, 1) << edge.first << '-' << edge.second;
    EXPECT_FALSE(borders.count(edge)) << edge.first << '-' << edge.second;
  }
}

bool flip(StageChain& chain) {
  return !flip_chords(chain.meshes, chain.surface.vertex_count(), chain.control).are_any_left;
}
void split(StageChain& chain) {
  split_chords(
      chain.triangulated, chain.surface.vertex_count(), [](PatchId) {}, chain.control);
}

/// Makes a polygon and the same polygon turned over.
PolygonMesh back_to_back(const std::vector<Vec3>& polygon) {
  std::vector<std::uint32_t> front, back;
  for (std::uint32_t i = 0; i < polygon.size(); ++i) {
    front.push_back(i);
    back.insert(back.begin(), i);
  }
  return shapes::from_lists(polygon, {front, back});
}

const std::vector<Vec3> kL{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

/// Makes two patches that are folded together along a bent border (0 1 2). The Delaunay diagonal of both is the chord
/// 0-2.
PolygonMesh folded_along_a_bent_border(const Vec3& corner_of_the_second) {
  return shapes::from_lists({{-1, 0, 0}, {0, -0.25, 0}, {1, 0, 0}, {0, 4, 0}, corner_of_the_second},
                            {{0, 1, 2, 3}, {2, 1, 0, 4}});
}

TEST(flip_chords, two_patches_that_pick_the_same_diagonal_are_told_apart) {
  StageChain chain(folded_along_a_bent_border({0, 5, 0}));
  ASSERT_EQ(chain.meshes.size(), 2u);
  ASSERT_EQ(inside_edges(chain.meshes).size(), 1u) << "both picked the same";
  EXPECT_TRUE(flip(chain));
  EXPECT_EQ(inside_edges(chain.meshes).size(), 2u);
  expect_no_shared_chord(chain.meshes);
  for (const PatchMesh& patch : chain.meshes) expect_valid(patch.uv, patch.mesh);
}

TEST(flip_chords, both_sides_of_a_rhombus_do_not_share_their_diagonal) {
  StageChain chain(shapes::from_lists({{-4, 0, 0}, {0, -1, 0}, {4, 0, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}}));
  ASSERT_EQ(chain.meshes.size(), 2u);
  ASSERT_EQ(inside_edges(chain.meshes).size(), 1u) << "the same four corners, so the same Delaunay diagonal";
  EXPECT_TRUE(flip(chain));
  expect_no_shared_chord(chain.meshes);
}

TEST(flip_chords, the_patch_of_lowest_id_keeps_its_edge) {
  StageChain chain(folded_along_a_bent_border({0, 5, 0}));
  const auto before = triangles_of(chain.meshes[PatchId(0)].mesh);
  EXPECT_TRUE(flip(chain));
  EXPECT_EQ(triangles_of(chain.meshes[PatchId(0)].mesh), before);
}

TEST(flip_chords, where_no_flip_helps_the_chord_stays) {
  // The second patch is reflex at corner 2: the chord is its only diagonal.
  StageChain chain(folded_along_a_bent_border({5, 0.5, 0}));
  ASSERT_EQ(chain.patches.count(), 2u);
  EXPECT_FALSE(flip(chain));
  const std::vector<Chord> left = find_chords(chain.meshes, chain.surface.vertex_count(), chain.control);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].patch, PatchId(1));
}

TEST(flip_chords, an_edge_that_is_another_patches_border_is_flipped_away) {
  // The square 0 1 2 3 has its diagonal 0-2 inside; a fin stands on the very vertices 0 and 2.
  StageChain chain(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}},
                                      {{0, 1, 3}, {1, 2, 3}, {0, 2, 4}}));
  ASSERT_EQ(chain.patches.count(), 2u);
  const auto square = chain.patch_of(0);
  ASSERT_TRUE(border_edges(chain.meshes).count({chain.at({0, 0, 0}), chain.at({1, 1, 0})}));
  EXPECT_TRUE(flip(chain));
  expect_no_shared_chord(chain.meshes);
  expect_valid(chain.meshes[square].uv, chain.meshes[square].mesh);
}

TEST(flip_chords, patches_without_common_chords_stay_as_they_are) {
  StageChain chain(shapes::l_bracket(3));
  std::vector<std::vector<Corners>> before;
  for (const PatchMesh& patch : chain.meshes) before.push_back(triangles_of(patch.mesh));
  EXPECT_TRUE(flip(chain));
  for (std::size_t p = 0; p < before.size(); ++p) EXPECT_EQ(triangles_of(chain.meshes[PatchId(p)].mesh), before[p]);
}

TEST(split_chords, two_sheets_that_no_flips_tell_apart_get_points) {
  StageChain chain(back_to_back(kL));
  ASSERT_EQ(chain.patches.count(), 2u);
  EXPECT_FALSE(flip(chain));
  const auto before = triangles_of(chain.meshes[PatchId(0)].mesh);
  split(chain);
  expect_no_shared_chord(chain.meshes);
  EXPECT_EQ(triangles_of(chain.meshes[PatchId(0)].mesh), before);
  const PatchMesh& patch = chain.meshes[PatchId(1)];
  EXPECT_GT(patch.uv.size(), 6u);
  EXPECT_EQ(patch.vertices.size(), patch.uv.size());
  for (std::size_t v = 6; v < patch.vertices.size(); ++v) EXPECT_FALSE(patch.vertices[v].is_valid());
  expect_valid(patch.uv, patch.mesh);
}

TEST(split_chords, one_point_ends_all_chords_of_a_round_patch) {
  std::vector<Vec3> round;
  for (int i = 0; i < 100; ++i)
    round.push_back({std::cos(i * 0.02 * std::numbers::pi), std::sin(i * 0.02 * std::numbers::pi), 0});
  StageChain chain(back_to_back(round));
  ASSERT_EQ(chain.patches.count(), 2u);
  split(chain);
  expect_no_shared_chord(chain.meshes);
  // The hundred corners and a few points; one for each chord would be nearly a hundred more.
  EXPECT_LE(chain.meshes[PatchId(1)].uv.size(), 103u);
  for (const PatchMesh& patch : chain.meshes) {
    expect_valid(patch.uv, patch.mesh);
    expect_locally_delaunay(patch.uv, patch.mesh);
  }
}

TEST(split_chords, the_surface_stays_whole_with_and_without_refinement) {
  for (const double angle : {0.0, 20.0, 25.0, 33.0}) {
    Options options = unrefined();
    options.refine = angle > 0;
    if (angle > 0) options.min_angle_deg = angle;
    const int n = 12;
    for (int seed = 0; seed < 12; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      std::vector<Vec3> star;  // reflex corners everywhere, no two alike
      for (int i = 0; i < n; ++i) {
        const double radius = (i % 2 == 0 ? 1.0 : 0.4) + 0.3 * random.unit();
        star.push_back({radius * std::cos(i * 6.283 / n), radius * std::sin(i * 6.283 / n), 0});
      }
      RunControl control;
      const PolygonMesh mesh = back_to_back(seed == 0 ? kL : star);
      const Result result = remesh_surface(mesh, options, {}, control);
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_TRUE(result.report.output.closed) << angle << ' ' << seed;
      EXPECT_EQ(result.report.output.non_manifold_edges, 0u) << angle << ' ' << seed;
      EXPECT_NEAR(result.report.output.area, result.report.input.area, 1e-12 * result.report.input.area);
      ASSERT_EQ(result.report.patches.size(), 2u);
      if (angle > 0) {
        EXPECT_GT(result.report.output.faces, 2u * (mesh.vertex_count() - 2)) << "not left as it was";
      }
      for (const PatchSummary& patch : result.report.patches) EXPECT_EQ(patch.status, PatchStatus::kRemeshed);
    }
  }
}

}  // namespace
}  // namespace remesh
