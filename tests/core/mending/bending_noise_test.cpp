#include "core/mending/weld/bending_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/tolerance.h"
#include "core/base/union_find.h"
#include "core/mending/weld/weld.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

TEST(is_noise_present, exact_boxes_have_none_and_rounded_turned_ones_do) {
  const auto is_noisy = [](const PolygonMesh& mesh) {
    const StageChain chain(mesh);
    return is_noise_present(chain.surface, chain.adjacency, chain.geometry, 1e-9, 1e-3, kBendsOfNoise, chain.control);
  };
  EXPECT_FALSE(is_noisy(shapes::box({1, 2, 3}, 4)));
  EXPECT_FALSE(is_noisy(shapes::cylinder(12, 1, 2)));
  EXPECT_TRUE(is_noisy(shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 4), {1, 2, 3}, 40), 1e-4)));
}

TEST(is_noise_present, neither_winding_nor_copies_nor_order_hide_it) {
  RunControl control;
  const auto is_noisy = [&](const PolygonMesh& mesh) {
    std::vector<Diagnostic> diagnostics;
    const Surface surface = weld(mesh, {}, diagnostics, control);
    const Adjacency adjacency(surface.vertex_count(), surface.face_begin, surface.corners, control);
    return is_noise_present(surface, adjacency, face_geometry(surface, control), 1e-9, 1e-3, kBendsOfNoise, control);
  };
  for (const bool is_rounded : {false, true}) {
    PolygonMesh mesh = shapes::rotated(shapes::box({1, 2, 3}), {1, 2, 3}, 40);
    if (is_rounded) mesh = shapes::rounded(mesh, 1e-4);
    // In this mesh, every second triangle looks the other way.
    PolygonMesh flipped = mesh;
    for (std::size_t f = 0; f < mesh.face_count(); f += 2)
      std::swap(flipped.corners[3 * f], flipped.corners[3 * f + 1]);
    const PolygonMesh turned = shapes::turned_over(mesh);
    for (const PolygonMesh& other : {mesh, flipped, turned, shapes::joined(mesh, mesh), shapes::joined(mesh, turned),
                                     shapes::joined(shapes::joined(mesh, flipped), mesh)}) {
      EXPECT_EQ(is_noisy(other), is_rounded);
      for (unsigned seed = 1; seed <= 5; ++seed) EXPECT_EQ(is_noisy(shapes::renumbered(other, seed)), is_rounded);
    }
  }
}

TEST(is_noise_present, of_a_large_face_and_a_small_one_either_may_come_first) {
  // The small triangle's corner is off the large one's plane by a step, the large one's by ten: the step explains both.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -0.1, 1e-3}};
  for (const auto& faces : {std::vector<std::vector<std::uint32_t>>{{0, 1, 2}, {1, 0, 3}}, {{1, 0, 3}, {0, 1, 2}}}) {
    const StageChain chain(shapes::from_lists(points, faces));
    EXPECT_TRUE(is_noise_present(chain.surface, chain.adjacency, chain.geometry, 1e-9, 4e-3 / chain.surface.unit, 1,
                                 chain.control));
  }
}

TEST(is_noise_present, one_bend_in_several_places_is_a_shape_and_several_bends_are_noise) {
  const auto is_noisy = [](const std::vector<double>& heights) {
    // A strip of squares, with the heights of its cross lines.
    PolygonMesh mesh =
        shapes::sheet(static_cast<double>(heights.size() - 1), 1, static_cast<int>(heights.size()) - 1, 1);
    for (Vec3& p : mesh.positions) p.z = heights[static_cast<std::size_t>(std::lround(p.x))];
    const StageChain chain(mesh);
    return is_noise_present(chain.surface, chain.adjacency, chain.geometry, 1e-9, 1e-3, kBendsOfNoise, chain.control);
  };
  EXPECT_FALSE(is_noisy({0, 0, 1e-4, 0, 0, 1e-4, 0, 0, 0}));
  EXPECT_TRUE(is_noisy({0, 0, 1e-4, 0, 0, 2.3e-4, 0, 0, -3.1e-4}));
}

STAGE(is_noise_present, test::kStop) {
  const StageChain chain(shapes::box({1, 2, 3}));
  (void)is_noise_present(chain.surface, chain.adjacency, chain.geometry, 1e-9, 1e-3, kBendsOfNoise, trial.control);
}

}  // namespace
}  // namespace remesh
