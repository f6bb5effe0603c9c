#include "core/patches/chains/boundary_chains.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/mesh/pinched_vertices.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// The chains of some patches of a mesh with planar patches.
struct Chains {
  explicit Chains(const PolygonMesh& mesh, const std::vector<std::size_t>& faces_of_wanted = {}) : stages(mesh) {
    IdVector<PatchId, std::uint8_t> is_wanted(stages.patches.count(), faces_of_wanted.empty());
    for (const std::size_t f : faces_of_wanted) is_wanted[stages.patch_of(f)] = 1;
    chains =
        boundary_chains(stages.surface, stages.adjacency, stages.patches, stages.loops, stages.essential,
                        pinched_vertices(stages.surface, stages.adjacency, stages.control), is_wanted, stages.control);
  }
  std::vector<Vec3> places(std::size_t c) const {
    std::vector<Vec3> points;
    for (const ChainNode& node : chains[c]) points.push_back(stages.surface.positions[node.vertex]);
    return points;
  }
  /// Expects that the half-edges of nodes are those of the edges along the chain.
  void expect_linked() const {
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const auto nodes = chains[c];
      ASSERT_GE(nodes.size(), 2u);
      for (std::size_t i = 0; i < nodes.size(); ++i)
        for (const std::uint32_t h : {nodes[i].before, nodes[i].after}) {
          if (h == kNone) continue;
          EXPECT_TRUE(stages.adjacency.from(h) == nodes[i].vertex || stages.adjacency.to(h) == nodes[i].vertex);
        }
      const bool is_ring = nodes.front().before != kNone;
      EXPECT_EQ(nodes.back().after != kNone, is_ring);
      EXPECT_TRUE(!is_ring || is_closed(nodes));
    }
  }

  StageChain stages;
  BoundaryChains chains;
};

TEST(boundary_chains, a_box_has_its_twelve_edges) {
  const Chains chains(shapes::box({1, 2, 3}, 3));
  ASSERT_EQ(chains.chains.size(), 12u);
  chains.expect_linked();
  std::set<std::vector<Vec3>> edges;
  for (std::size_t c = 0; c < 12; ++c) {
    const std::vector<Vec3> points = chains.places(c);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_LT(points[0], points[1]);
    edges.insert(points);
  }
  EXPECT_EQ(edges.size(), 12u);
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
}

TEST(boundary_chains, a_hole_is_a_ring_that_begins_at_its_smallest_vertex) {
  const Chains chains(shapes::plate_with_round_hole(16));
  ASSERT_EQ(chains.chains.size(), 2u);
  chains.expect_linked();
  const std::vector<Vec3> outside = chains.places(0), hole = chains.places(1);
  EXPECT_EQ(outside, (std::vector<Vec3>{{-2, -2, 0}, {-2, 2, 0}, {2, 2, 0}, {2, -2, 0}, {-2, -2, 0}}));
  ASSERT_EQ(hole.size(), 17u);
  EXPECT_EQ(hole.front(), *std::min_element(hole.begin(), hole.end()));
  EXPECT_EQ(hole.front(), hole.back());
  EXPECT_LT(hole[1], hole[15]);
}

TEST(boundary_chains, only_chains_of_wanted_patches_are_found) {
  EXPECT_EQ(Chains(shapes::quad_box({1, 1, 1}), {0}).chains.size(), 4u);
  EXPECT_EQ(Chains(shapes::quad_box({1, 1, 1}), {0, 1, 2, 3, 4, 5}).chains.size(), 12u);
}

TEST(boundary_chains, an_edge_with_three_faces_is_one_chain) {
  const Chains chains(shapes::three_pages(2));
  chains.expect_linked();
  // The spine, and the three other sides of each page.
  EXPECT_EQ(chains.chains.size(), 4u);
}

TEST(boundary_chains, surfaces_that_touch_in_a_vertex_have_a_corner_there) {
  const Chains chains(shapes::two_squares_touching_at_a_vertex());
  chains.expect_linked();
  ASSERT_EQ(chains.chains.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(chains.places(c).front(), chains.places(c).back());
    EXPECT_EQ(chains.places(c).size(), 5u);
  }
}

STAGE(boundary_chains, test::kNumbering) {
  const Chains chains(trial.of(shapes::l_bracket(2)));
  for (std::size_t c = 0; c < chains.chains.size(); ++c) trial.same(chains.places(c));
}

}  // namespace
}  // namespace remesh
