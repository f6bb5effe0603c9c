#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/core/verify/cases.h"

namespace remesh {
namespace {

TEST(verify, where_heights_prove_nothing_distances_are_measured) {
  EXPECT_TRUE(is_verified(slope(0)));
  EXPECT_LT(slope(0).verify().deviation, 1e-12);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(is_verified(slope(sign * 0.4e-3)));
    EXPECT_NEAR(slope(sign * 0.4e-3).verify().deviation, 0.4e-3, 1e-12);
    EXPECT_FALSE(slope(sign * 0.6e-3).verify().surface);
  }
}

TEST(verify, measured_distances_are_the_true_ones) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    PolygonMesh output = shapes::rotated(shapes::noisy_sheet(12, seed), {0, 0, 1}, 7.0 * seed);
    for (Vec3& p : output.positions) p.z = 1e-2 * unit(random);
    // In every output triangle the input has one vertex more, a known bit above or below it.
    PolygonMesh input;
    input.positions = output.positions;
    double largest = 0;
    for (std::size_t f = 0; f < output.face_count(); ++f) {
      const auto face = output.face(FaceId(f));
      const double s = 0.4 + 0.3 * unit(random), t = (1 - s) * (0.5 + 0.4 * unit(random));
      Vec3 p = s * input.positions[face[0]] + t * input.positions[face[1]] + (1 - s - t) * input.positions[face[2]];
      const double lift = 1e-3 * unit(random);
      p.z += lift;
      largest = std::max(largest, std::fabs(lift));
      const VertexId middle = input.positions.push_back(p);
      for (int i = 0; i < 3; ++i) {
        for (const VertexId v : {face[i], face[(i + 1) % 3], middle}) input.corners.push_back(v);
        input.face_begin.push_back(static_cast<std::uint32_t>(input.corners.size()));
      }
    }
    Example e;
    e.surface = shapes::surface(input);
    e.surface_patch.assign(input.face_count(), PatchId(0));
    e.frames.push_back({{6, 6, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 32, 0x1p-40});
    e.positions = output.positions.items();
    e.faces = shapes::triangles(output).faces.items();
    e.face_patch.assign(e.faces.size(), PatchId(0));
    e.project();
    e.plane_tolerance = largest * 1.001;
    EXPECT_TRUE(e.verify().surface) << all_words(e.verify());
    EXPECT_NEAR(e.verify().deviation, largest, 1e-9);
    e.plane_tolerance = largest * 0.999;
    EXPECT_FALSE(e.verify().surface);
  }
}
}  // namespace
}  // namespace remesh
