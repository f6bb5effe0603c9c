#include "core/refinement/sizes/local_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

PolygonMesh face_of(const polygons::Loop& loop) {
  PolygonMesh mesh;
  for (const Vec2 p : loop) {
    mesh.corners.push_back(VertexId(mesh.positions.size()));
    mesh.positions.push_back({p.x, p.y, 0});
  }
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  return mesh;
}

/// A patch with its sides and their features.
struct FeatureSubject {
  explicit FeatureSubject(const polygons::Loop& loop) : chain(face_of(loop)) {
    const Triangulation2d& mesh = patch().mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
      if (mesh.is_constrained(h)) sides.push_back(h);
    LocalFeatures search;
    const auto found = search.of(patch(), chain.charts()[PatchId(0)], sides, chain.control);
    features.assign(found.begin(), found.end());
  }
  const PatchMesh& patch() const { return chain.meshes[PatchId(0)]; }
  Vec3 at(std::uint32_t h) const { return chain.surface.positions[patch().vertices[patch().mesh.from(h)]]; }
  Vec3 end_of(std::uint32_t h) const { return at(Triangulation2d::next(h)); }

  StageChain chain;
  std::vector<std::uint32_t> sides;
  std::vector<LocalFeature> features;
};

double distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  return norm(p - (a + std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0) * ab));
}

polygons::Loop convex(std::uint64_t seed, int corners) {
  Random random(seed);
  std::vector<double> angles;
  for (int i = 0; i < corners; ++i) angles.push_back(2 * std::numbers::pi * random.unit());
  std::sort(angles.begin(), angles.end());
  polygons::Loop loop;
  for (const double angle : angles) loop.push_back({std::cos(angle), 0.3 * std::sin(angle)});
  return loop;
}

TEST(local_features, in_a_convex_face_the_distance_is_the_least_to_what_does_not_touch) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const FeatureSubject subject(convex(seed, 3 + static_cast<int>(seed % 20)));
    for (std::size_t i = 0; i < subject.sides.size(); ++i) {
      const Vec3 a = subject.at(subject.sides[i]), b = subject.end_of(subject.sides[i]);
      // With nothing else there, its own length.
      double expected = norm(b - a);
      for (const std::uint32_t h : subject.sides) {
        const Vec3 c = subject.at(h), d = subject.end_of(h);
        if (c != a && c != b) expected = std::min(expected, distance(c, a, b));
        if (c == a || c == b || d == a || d == b) continue;
        expected = std::min({expected, distance(a, c, d), distance(b, c, d)});
      }
      EXPECT_NEAR(subject.features[i].distance, expected, 4 * subject.chain.charts()[PatchId(0)].grid())
          << "seed " << seed;
    }
  }
}

TEST(local_features, small_angles_are_those_of_the_loop_and_all_others_wide) {
  int small = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const FeatureSubject subject(polygons::grown(seed, 24, 6).outer);
    for (std::size_t i = 0; i < subject.sides.size(); ++i) {
      const std::uint32_t h = subject.sides[i], next = subject.features[i].next_at_start;
      ASSERT_TRUE(subject.end_of(next) == subject.at(h));
      const Vec3 u = subject.end_of(h) - subject.at(h), v = subject.at(next) - subject.at(h);
      // Counter-clockwise from u to v, the inside on the left of h.
      double expected = std::atan2(cross(u, v).z, dot(u, v));
      if (expected < 0) expected += 2 * std::numbers::pi;
      const double found = subject.features[i].angle_at_start;
      if (expected < 63 * std::numbers::pi / 180) {
        ++small;
        EXPECT_NEAR(found, expected, 1e-9) << "seed " << seed;
      } else if (expected > 64 * std::numbers::pi / 180) {
        EXPECT_EQ(found, LocalFeature::kWide) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(small, 100);
}

TEST(local_features, a_patch_has_the_same_ones_whatever_was_looked_at_before) {
  LocalFeatures search;
  RunControl control;
  // Sides of one number are elsewhere in each: what was seen from one must not count for the next.
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const FeatureSubject subject(polygons::grown(seed, 30 + static_cast<int>(seed % 3), 8).outer);
    const auto found = search.of(subject.patch(), subject.chain.charts()[PatchId(0)], subject.sides, control);
    ASSERT_EQ(found.size(), subject.features.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].distance, subject.features[i].distance) << "seed " << seed;
      EXPECT_EQ(found[i].next_at_start, subject.features[i].next_at_start);
      EXPECT_EQ(found[i].angle_at_start, subject.features[i].angle_at_start);
    }
  }
}

}  // namespace
}  // namespace remesh
