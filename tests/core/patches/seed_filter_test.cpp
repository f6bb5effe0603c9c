// Tests which edges recognition begins with: all that may be rulings or edges of a surface, and few others.

#include "core/patches/recognition/seed_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/patches/planar/patch_summary.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/surface_seeds.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kFeatureAngleDeg = 30;

/// The facets of a mesh, and the seeds between them.
class Facetted {
 public:
  explicit Facetted(PolygonMesh mesh, double tolerance = 1e-9)
      : mesh_(std::move(mesh)),
        chain_(mesh_, tolerance),
        summaries_(chain_.patches.count()),
        facets_{chain_.surface, chain_.adjacency, chain_.patches, chain_.loops, chain_.essential, summaries_},
        graph_(facets_, kFeatureAngleDeg, chain_.control) {}

  const FacetGraph& graph() const { return graph_; }
  template <class IsWanted>
  std::vector<SurfaceSeed> seeds(const IsWanted& is_wanted) {
    return find_seeds(graph_, chain_.control, is_wanted);
  }
  std::vector<SurfaceSeed> all_seeds() {
    return seeds([](const SurfaceSeed&) { return true; });
  }
  std::size_t smooth_neighbours(PatchId p) const {
    std::size_t count = 0;
    graph_.for_each_neighbour(p, [&](PatchId) { ++count; });
    return count;
  }
  std::vector<SurfaceSeed> in_order(std::vector<SurfaceSeed> seeds) const {
    SeedQueue queue(std::move(seeds), graph_, chain_.control);
    std::vector<SurfaceSeed> ordered;
    while (const SurfaceSeed* const seed = queue.next()) ordered.push_back(*seed);
    return ordered;
  }

 private:
  PolygonMesh mesh_;
  StageChain chain_;
  std::vector<PatchSummary> summaries_;
  Facets facets_;
  FacetGraph graph_;
};

/// Moves each vertex along its own direction, so that the surface is smooth and of no kind.
PolygonMesh bumpy(PolygonMesh mesh) {
  for (Vec3& p : mesh.positions) {
    const double height = 0.1 * std::sin(5 * p.x + 1) * std::sin(4 * p.y + 2) * std::sin(6 * p.z);
    p = (1 + height) * p;
  }
  return mesh;
}

bool may_begin(const FacetGraph& graph, const SurfaceSeed& seed, double tolerance) {
  return !kinds_that_may_begin(graph, seed, tolerance).is_empty();
}

TEST(seed_filter, every_edge_of_a_sphere_of_triangles_may_begin_one) {
  Facetted sphere(shapes::sphere(4));
  const std::vector<SurfaceSeed> seeds = sphere.all_seeds();
  // A closed surface of 2048 triangles has 3072 edges.
  ASSERT_EQ(seeds.size(), 3072U);
  for (const SurfaceSeed& seed : seeds)
    EXPECT_TRUE(kinds_that_may_begin(sphere.graph(), seed, 1e-10).has(SurfaceKind::kSphere));
}

TEST(seed_filter, every_ruling_of_a_shaft_or_a_cone_may_begin_one) {
  for (const primitives::Model& model : primitives::explained()) {
    if (!model.name.starts_with("cylinder") && !model.name.starts_with("cone")) continue;
    SCOPED_TRACE(model.name);
    Facetted part(model.mesh);
    for (const SurfaceSeed& seed : part.all_seeds()) {
      const PatchId f = seed.facet, g = part.graph().beyond(seed.side);
      // The edge between two facets with neighbours on both sides is inside of the surface.
      if (part.smooth_neighbours(f) < 2 || part.smooth_neighbours(g) < 2) continue;
      EXPECT_TRUE(may_begin(part.graph(), seed, 1e-7));
    }
  }
}

TEST(seed_filter, few_edges_of_a_smooth_surface_of_no_kind_may_begin_one) {
  Facetted ball(bumpy(shapes::sphere(5)));
  const std::size_t all = ball.all_seeds().size();
  const std::size_t few =
      ball.seeds([&](const SurfaceSeed& seed) { return may_begin(ball.graph(), seed, 1e-8); }).size();
  // A neighbour is near by chance where the surface curves as a sphere, a cylinder or a cone does.
  EXPECT_GT(all, 12'000U);
  EXPECT_LT(few, all / 20);
}

TEST(seed_queue, it_gives_all_seeds_and_the_longest_first) {
  Facetted ball(bumpy(shapes::sphere(6)));
  std::vector<SurfaceSeed> seeds = ball.all_seeds();
  // There are more than are sorted at first.
  ASSERT_GT(seeds.size(), 40'000U);
  const std::vector<SurfaceSeed> ordered = ball.in_order(seeds);
  ASSERT_EQ(ordered.size(), seeds.size());
  std::vector<double> lengths;
  for (const SurfaceSeed& seed : seeds) lengths.push_back(seed.length_squared);
  std::sort(lengths.rbegin(), lengths.rend());
  for (std::size_t i = 0; i < ordered.size(); ++i) ASSERT_EQ(ordered[i].length_squared, lengths[i]);
  std::reverse(seeds.begin(), seeds.end());
  const std::vector<SurfaceSeed> again = ball.in_order(seeds);
  for (std::size_t i = 0; i < ordered.size(); ++i) ASSERT_EQ(ordered[i].side, again[i].side);
}

TEST(seed_queue, a_sample_has_its_part_of_the_seeds) {
  Facetted ball(bumpy(shapes::sphere(6)));
  const double all = static_cast<double>(ball.all_seeds().size());
  for (const double part : {0.05, 0.3, 0.8}) {
    const auto sampled =
        static_cast<double>(ball.seeds([&](const SurfaceSeed& seed) { return is_in_sample(seed, part); }).size());
    // Five standard deviations of a drawn number.
    EXPECT_NEAR(sampled / all, part, 5 * std::sqrt(part * (1 - part) / all));
  }
}

}  // namespace
}  // namespace remesh
