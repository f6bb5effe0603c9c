// Tests what the checker says of vertices of the input that are elsewhere in the result.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/core/verify/curved_example.h"

namespace remesh {
namespace {

const AnalyticSurface kCapPlane{SurfaceKind::kPlane, {}, {0, 0, 1}, 0, 0, 0};
const AnalyticSurface kMovedShaft{SurfaceKind::kCylinder, {}, {0, 0, 1}, 1, 0, 0};
constexpr double kTolerance = 0.1;
constexpr double kHeight = 2;

/// The point number k of n on a half circle. Its ends are exact.
Vec3 on_half(int k, int n, double radius, double z) {
  if (k == 0 || k == n) return {k == 0 ? radius : -radius, 0, z};
  return {radius * std::cos(kPi * k / n), radius * std::sin(kPi * k / n), z};
}

/// Makes half of a shaft: a bottom, a top, half a barrel of n facets, and a flat. The flat's corners are on the barrel.
PatchedMesh half_bar(int n, double radius) {
  PatchedMesh mesh;
  std::vector<Vec3> top, bottom;
  for (int k = 0; k <= n; ++k) {
    top.push_back(on_half(k, n, radius, kHeight));
    bottom.push_back(on_half(n - k, n, radius, 0));
  }
  mesh.add_fan(PatchId(0), bottom);
  mesh.add_fan(PatchId(1), top);
  for (int k = 0; k < n; ++k)
    mesh.add_fan(PatchId(2), {on_half(k, n, radius, 0), on_half(k + 1, n, radius, 0),
                              on_half(k + 1, n, radius, kHeight), on_half(k, n, radius, kHeight)});
  mesh.add_fan(PatchId(3), {on_half(n, n, radius, 0), on_half(0, n, radius, 0), on_half(0, n, radius, kHeight),
                            on_half(n, n, radius, kHeight)});
  return mesh;
}

/// Claims that the result is such a shaft, and that its four corners were moved from where they were.
Example moved_shaft(int before, int after, double radius) {
  Example e = curved_example(half_bar(before, 1), half_bar(after, radius),
                             {kCapPlane, kCapPlane, kMovedShaft, kCapPlane}, kTolerance);
  if (radius == 1) return e;
  for (VertexId v(0); v.value < e.positions.size(); ++v.value)
    for (VertexId s(0); s.value < e.surface.vertex_count(); ++s.value) {
      const Vec3 &from = e.surface.positions[s], &to = e.positions[v.value];
      if (from.y == 0 && to.y == 0 && from.z == to.z && from.x * to.x > 0) e.moved.push_back({v, s});
    }
  return e;
}

TEST(moved_vertices, corners_may_move_along_the_planes_that_meet_there) {
  for (const int after : {5, 6, 8, 12}) {
    const double turn = kPi / after, radius = std::sqrt(turn / std::sin(turn));
    const Example e = moved_shaft(24, after, radius);
    ASSERT_EQ(e.moved.size(), 4U);
    const Verdict verdict = e.verify();
    EXPECT_TRUE(verdict.all_true()) << after << " " << (verdict.failures.empty() ? "" : verdict.failures[0]);
    for (std::uint32_t p = 0; p < 4; ++p) {
      EXPECT_LE(verdict.patch_bounds[p], kTolerance) << p;
      EXPECT_GE(verdict.patch_bounds[p] * (1 + 1e-9), true_distance(e, PatchId(p), 1e-3)) << p;
    }
    // The bound of the flat is how far its sides have moved.
    EXPECT_NEAR(verdict.patch_bounds[3], radius - 1, 1e-9);
  }
}

TEST(moved_vertices, what_has_not_been_claimed_is_refused) {
  const Example e = moved_shaft(24, 8, 1.02);
  ASSERT_TRUE(is_verified(e));
  for (std::size_t i = 0; i < e.moved.size(); ++i) {
    Example spoilt = e;
    spoilt.moved.erase(spoilt.moved.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(is_verified(spoilt)) << i;
  }
}

struct Spoiling {
  std::string name;
  std::function<void(Example&)> run;
};

TEST(moved_vertices, every_other_move_is_refused) {
  const Example e = moved_shaft(24, 8, 1.02);
  ASSERT_TRUE(is_verified(e));
  const auto corner = [](Example& of) -> Vec3& { return of.positions[of.moved[0].output.value]; };
  const std::vector<Spoiling> all{
      {"twice the tolerance away", [&](Example& of) { corner(of).x *= (1 + 2 * kTolerance) / 1.02; }},
      {"inside, twice the tolerance away", [&](Example& of) { corner(of).x *= (1 - 2 * kTolerance) / 1.02; }},
      {"out of the plane of the flat", [&](Example& of) { corner(of).y = 1e-4; }},
      {"out of the plane of a cap", [&](Example& of) { corner(of).z += 1e-4; }},
      {"two corners exchanged", [](Example& of) { std::swap(of.moved[0].of_surface, of.moved[1].of_surface); }},
      {"a vertex that was dropped",
       [](Example& of) {
         // Any other vertex of the input's barrel.
         while (of.surface.positions[of.moved[0].of_surface].y == 0) ++of.moved[0].of_surface.value;
       }},
      {"one vertex twice", [](Example& of) { of.moved[1].of_surface = of.moved[0].of_surface; }},
      {"a number that is none", [](Example& of) { of.moved[0].of_surface = VertexId(of.surface.vertex_count()); }},
      {"an output number that is none", [](Example& of) { of.moved[0].output = VertexId(of.positions.size()); }},
      {"where the surface is a plane",
       [](Example& of) {
         of.curved_of_patch.clear();
         of.curved.clear();
       }},
  };
  for (const Spoiling& spoiling : all) {
    Example spoilt = e;
    spoiling.run(spoilt);
    // Where it can be projected, its plane coordinates are right.
    if (!spoilt.curved_of_patch.empty()) spoilt.project();
    EXPECT_FALSE(is_verified(spoilt)) << spoiling.name;
  }
}

TEST(moved_vertices, a_vertex_off_all_curved_patches_may_not_move) {
  // A box with a pin is not needed for this: the shaft counts as four planes and one curved patch far away.
  PatchedMesh input = half_bar(24, 1), output = half_bar(24, 1);
  const auto add_box = [](PatchedMesh& mesh, double side) {
    const std::vector<Vec3> base{{5, 0, 0}, {5 + side, 0, 0}, {5 + side, 1, 0}, {5, 1, 0}};
    const auto up = [](Vec3 p) {
      p.z = 1;
      return p;
    };
    mesh.add_fan(PatchId(4), {base[3], base[2], base[1], base[0]});
    mesh.add_fan(PatchId(5), {up(base[0]), up(base[1]), up(base[2]), up(base[3])});
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3 &a = base[k], &b = base[(k + 1) % 4];
      mesh.add_fan(PatchId(6 + k), {a, b, up(b), up(a)});
    }
  };
  add_box(input, 1);
  add_box(output, 1.001);
  std::vector<AnalyticSurface> surfaces(10, kCapPlane);
  surfaces[2] = kMovedShaft;
  Example e = curved_example(input, output, surfaces, kTolerance);
  for (VertexId v(0); v.value < e.positions.size(); ++v.value)
    if (e.positions[v.value].x == 5 + 1.001)
      for (VertexId s(0); s.value < e.surface.vertex_count(); ++s.value) {
        const Vec3& from = e.surface.positions[s];
        if (from.x == 6 && from.y == e.positions[v.value].y && from.z == e.positions[v.value].z)
          e.moved.push_back({v, s});
      }
  ASSERT_EQ(e.moved.size(), 4U);
  EXPECT_FALSE(is_verified(e));
}

}  // namespace
}  // namespace remesh
