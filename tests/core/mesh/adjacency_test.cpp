#include "core/mesh/adjacency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Ends = std::pair<std::uint32_t, std::uint32_t>;

Adjacency adjacency_of(const PolygonMesh& mesh) {
  RunControl control;
  return {mesh.vertex_count(), mesh.face_begin, mesh.corners, control};
}

Ends ends(const Adjacency& adjacency, std::uint32_t h) {
  return std::minmax(adjacency.from(h).value, adjacency.to(h).value);
}

/// Makes a mesh of which only the connections matter.
PolygonMesh connected(std::uint32_t vertices, const std::vector<std::vector<std::uint32_t>>& faces) {
  return shapes::from_lists(std::vector<Vec3>(vertices), faces);
}

TEST(adjacency, an_edge_of_two_faces_joins_twins) {
  const PolygonMesh mesh = connected(4, {{0, 1, 2}, {2, 1, 3}});
  const Adjacency adjacency = adjacency_of(mesh);
  EXPECT_EQ(adjacency.edge_count(), 5u);
  EXPECT_EQ(adjacency.twin(1), 3u);
  EXPECT_EQ(adjacency.twin(3), 1u);
  for (const std::uint32_t h : {0u, 2u, 4u, 5u}) EXPECT_EQ(adjacency.twin(h), kNone) << h;
}

TEST(adjacency, an_edge_of_three_faces_holds_all_of_them_and_has_no_twins) {
  const PolygonMesh mesh = connected(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  const Adjacency adjacency = adjacency_of(mesh);
  const auto around = adjacency.half_edges(adjacency.edge_of(0));
  EXPECT_EQ(std::vector<std::uint32_t>(around.begin(), around.end()), (std::vector<std::uint32_t>{0, 3, 6}));
  for (const std::uint32_t h : around) EXPECT_EQ(adjacency.twin(h), kNone);
}

TEST(adjacency, faces_that_run_the_same_way_along_an_edge_are_no_twins) {
  const PolygonMesh mesh = connected(4, {{0, 1, 2}, {0, 1, 3}});
  const Adjacency adjacency = adjacency_of(mesh);
  EXPECT_EQ(adjacency.half_edges(adjacency.edge_of(0)).size(), 2u);
  EXPECT_EQ(adjacency.twin(0), kNone);
}

TEST(adjacency, a_polygon_meets_itself_along_a_bridge) {
  // A square with a triangular hole: 0 1 2 3, the bridge 0-4 walked twice.
  const PolygonMesh mesh = connected(7, {{0, 1, 2, 3, 0, 4, 5, 6, 4}});
  const Adjacency adjacency = adjacency_of(mesh);
  EXPECT_EQ(adjacency.edge_count(), 8u);
  EXPECT_EQ(adjacency.twin(4), 8u);
  EXPECT_EQ(adjacency.twin(8), 4u);
}

TEST(adjacency, next_goes_round_the_face) {
  const PolygonMesh mesh = connected(5, {{0, 1, 2}, {0, 2, 3, 4}});
  const Adjacency adjacency = adjacency_of(mesh);
  EXPECT_EQ(adjacency.next(2), 0u);
  EXPECT_EQ(adjacency.next(3), 4u);
  EXPECT_EQ(adjacency.next(6), 3u);
  EXPECT_EQ(adjacency.to(6), VertexId(0));
}

/// Compares the adjacency of a mesh with one that is computed by a map.
void expect_grouped(const PolygonMesh& mesh) {
  const Adjacency adjacency = adjacency_of(mesh);
  std::map<Ends, std::vector<std::uint32_t>> expected;
  for (std::uint32_t f = 0, h = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t k = 0; k < face.size(); ++k, ++h) {
      ASSERT_EQ(adjacency.face_of(h), FaceId(f));
      ASSERT_EQ(adjacency.from(h), face[k]);
      expected[std::minmax(face[k].value, face[(k + 1) % face.size()].value)].push_back(h);
    }
  }
  ASSERT_EQ(adjacency.edge_count(), expected.size());
  std::vector<EdgeId> odd;
  EdgeId e(0);
  for (const auto& [key, half_edges] : expected) {  // a map, so in the promised order
    const auto around = adjacency.half_edges(e);
    ASSERT_EQ(std::vector<std::uint32_t>(around.begin(), around.end()), half_edges);
    const bool are_twins = around.size() == 2 && adjacency.from(around[0]) != adjacency.from(around[1]);
    if (!are_twins) odd.push_back(e);
    for (const std::uint32_t h : around) {
      ASSERT_EQ(ends(adjacency, h), key);
      ASSERT_EQ(adjacency.edge_of(h), e);
      ASSERT_EQ(adjacency.twin(h), !are_twins ? kNone : h == around[0] ? around[1] : around[0]);
    }
    ++e.value;
  }
  EXPECT_EQ(std::vector<EdgeId>(adjacency.odd_edges().begin(), adjacency.odd_edges().end()), odd);
}

TEST(adjacency, random_faces_are_grouped_as_a_map_groups_them) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const bool is_large = trial == 0;
    const auto vertices = static_cast<std::uint32_t>(is_large ? 5000 : random.integer(3, 20));
    std::vector<std::vector<std::uint32_t>> faces;
    for (int f = is_large ? 20'000 : random.integer(1, 40); f > 0; --f) {
      std::vector<std::uint32_t> face;
      for (int k = random.integer(3, 6); k > 0; --k)
        face.push_back(static_cast<std::uint32_t>(random.below(static_cast<int>(vertices))));
      faces.push_back(face);
    }
    expect_grouped(connected(vertices, faces));
  }
}

TEST(adjacency, the_edges_of_a_sound_surface_are_grouped_too_and_those_at_a_fault_in_it) {
  PolygonMesh mesh = shapes::box({1, 2, 3}, 20);
  expect_grouped(mesh);
  std::swap(mesh.corners[0], mesh.corners[1]);   // a face turned over
  mesh.corners[300] = mesh.corners[301];         // one with a repeated corner
  mesh.corners.resize(mesh.corners.size() - 3);  // one that is missing
  mesh.face_begin.pop_back();
  expect_grouped(mesh);
}

TEST(adjacency, the_edges_at_a_hub_are_grouped) {
  // A fan so wide that its edges are sorted in parallel, the faces in no order.
  constexpr std::uint32_t kRim = 150'000;
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < kRim; ++i) {
    const auto k = static_cast<std::uint32_t>(std::uint64_t{i} * 7919 % kRim);
    faces.push_back({0, 1 + k, 1 + (k + 1) % kRim});
  }
  expect_grouped(connected(kRim + 1, faces));
}

STAGE(adjacency, test::kStop) {
  const PolygonMesh mesh = connected(3, {{0, 1, 2}});
  Adjacency(mesh.vertex_count(), mesh.face_begin, mesh.corners, trial.control);
}

TEST(adjacency, a_mesh_without_faces_has_no_edges) {
  const PolygonMesh mesh = connected(3, {});
  EXPECT_EQ(adjacency_of(mesh).edge_count(), 0u);
}

}  // namespace
}  // namespace remesh
