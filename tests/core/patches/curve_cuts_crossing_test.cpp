// Tests that boundaries of few pieces neither cross nor fall together.

#include "core/patches/chains/curve_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/cut_parts.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using namespace cut_parts;

TEST(curve_cuts, the_rims_of_a_thin_ring_do_not_cross) {
  const int facets = 360;
  for (const double wall : {0.05, 0.2, 1.0, 4.0}) {
    const Asked asked = elements(12, kRadius, height(kRadius, facets));
    const CutPart part(part_of(primitives::tube(facets, kRadius, wall, 30)), asked);
    SCOPED_TRACE(wall);
    expect_conforming(part);
    const double gap = (kRadius - wall) * std::cos(kPi / facets);  // to the nearest place of the other rim, about
    double outer_in = HUGE_VAL, inner_out = 0;
    std::size_t most = 0;
    for (std::uint32_t l = 0; l < part.loop_count(); ++l) {
      const std::vector<Vec3> points = part.points(l);
      most = std::max(most, points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 middle = 0.5 * (points[i] + points[(i + 1) % points.size()]);
        const double at_corner = std::hypot(points[i].x, points[i].y), r = std::hypot(middle.x, middle.y);
        if (at_corner > kRadius - wall / 2)
          outer_in = std::min(outer_in, r);
        else
          inner_out = std::max(inner_out, at_corner);
      }
    }
    EXPECT_GT(outer_in, inner_out);
    EXPECT_LE(kRadius - outer_in, (kRadius - gap) / 4);
    const bool is_wide = height(kRadius, 12) <= wall / 4;
    EXPECT_EQ(part.cuts.capped, is_wide ? 0u : 4u);
    if (is_wide) {
      EXPECT_EQ(most, 12u);
    } else {
      int fewest = 12;
      while (height(kRadius, fewest) > wall / 4) ++fewest;
      EXPECT_GE(most, static_cast<std::size_t>(fewest));
      EXPECT_LE(most, static_cast<std::size_t>(fewest + 2));
    }
  }
}

TEST(curve_cuts, an_arc_of_one_piece_and_its_chord_do_not_become_one_edge) {
  for (const int n : {5, 9, 14}) {
    const CutPart part(segment_of_disc(n, 70), {100, 2 * kPi / 3});
    SCOPED_TRACE(n);
    expect_conforming(part);
    for (const std::uint32_t patch : {1u, 2u}) {
      const std::vector<Vec3> points = part.points(part.first_loop(patch));
      ASSERT_EQ(points.size(), 3u);
      // The additional vertex is in the middle of the arc.
      const double middle = 35 * kPi / 180;
      const double z = patch == 1 ? 0 : 3;
      EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const Vec3& p) {
        return norm(p - Vec3{4 * std::cos(middle), 4 * std::sin(middle), z}) < 1e-14;
      }));
    }
  }
}

TEST(curve_cuts, half_a_disc_is_cut_like_a_circle) {
  for (const int n : {3, 4, 12}) {
    const CutPart part(segment_of_disc(40, 180), {100, 2 * kPi / n});
    expect_conforming(part);
    EXPECT_EQ(part.points(part.first_loop(1)).size(), static_cast<std::size_t>((n + 1) / 2 + 1)) << n;
  }
}

TEST(curve_cuts, two_arcs_of_one_piece_do_not_become_one_edge) {
  // A lens on a sphere, between two points that are 90 degrees apart. No plane is near.
  const int facets = 12;
  const Vec3 from{4 * std::sqrt(0.5), -4 * std::sqrt(0.5), 0}, to{4 * std::sqrt(0.5), 4 * std::sqrt(0.5), 0};
  const Vec3 middle = 0.5 * (from + to);
  std::vector<std::vector<Vec3>> arcs;
  for (const double tilt : {-0.35, 0.35}) {
    // The plane of the arc contains both points. It is turned about their chord.
    const Vec3 normal{-std::sin(tilt), 0, std::cos(tilt)};
    const Vec3 centre = dot(middle, normal) * normal;
    const Vec3 x = normalized(from - centre), y = cross(normal, x);
    const double radius = norm(from - centre), turn = 2 * std::asin(norm(to - from) / (2 * radius));
    std::vector<Vec3> arc{from};
    for (int i = 1; i < facets; ++i)
      arc.push_back(centre + radius * (std::cos(turn * i / facets) * x + std::sin(turn * i / facets) * y));
    arc.push_back(to);
    arcs.push_back(arc);
  }
  std::vector<Vec3> places(arcs[0]);
  places.insert(places.end(), arcs[1].begin() + 1, arcs[1].end() - 1);
  std::vector<std::vector<std::uint32_t>> faces;
  const auto on_second = [&](int i) { return static_cast<std::uint32_t>(i == 0 || i == facets ? i : facets + i); };
  for (int i = 0; i < facets; ++i) {
    std::vector<std::uint32_t> face{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1)};
    if (i + 1 < facets) face.push_back(on_second(i + 1));
    if (i > 0) face.push_back(on_second(i));
    faces.push_back(face);
  }
  const PolygonMesh mesh = shapes::from_lists(places, faces);
  const CutPart part(
      {with_groups(mesh, std::vector<std::uint32_t>(faces.size(), 0)), {{SurfaceKind::kSphere, {}, {}, 4, 0, 0}}},
      {100, 2 * kPi / 3});
  const std::vector<Vec3> points = part.points(0);
  ASSERT_EQ(points.size(), 4u);
  for (const Vec3& p : points) EXPECT_NEAR(norm(p), 4, 1e-14);
  // Each arc has got its middle.
  for (const double side : {-1, 1})
    EXPECT_TRUE(std::any_of(points.begin(), points.end(),
                            [&](const Vec3& p) { return std::fabs(p.y) < 1e-14 && side * p.z > 0.1; }));
}

/// Returns whether two edges of a closed polyline in a plane z = constant cross or touch, other than neighbours in
/// their common vertex.
bool crosses_itself(const std::vector<Vec3>& points) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& p) {
    const double area = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const Vec3 &a = points[i], &b = points[i + 1], &c = points[j], &d = points[(j + 1) % n];
      if (side(a, b, c) * side(a, b, d) <= 0 && side(c, d, a) * side(c, d, b) <= 0) return true;
    }
  return false;
}

TEST(curve_cuts, the_arcs_of_a_crescent_do_not_cross) {
  // Two arcs between (-3, 0) and (3, 0), as high as this in the middle.
  std::size_t fewest = 60;
  for (const double lower : {0.2, 0.9})
    for (const double upper : {1.0, 2.5})
      for (const int n : {3, 6, 8, 10, 16, 40}) {
        const int facets = 30;
        std::vector<Vec2> base;
        std::vector<AnalyticSurface> shapes;
        for (const double high : {lower, upper}) {
          const double radius = (9 + high * high) / (2 * high), half = std::asin(3 / radius);
          const int sign = high == lower ? 1 : -1;
          for (int i = 0; i < facets; ++i) {
            const double angle = sign * half * (2.0 * i / facets - 1);
            base.push_back({radius * std::sin(angle), high - radius + radius * std::cos(angle)});
          }
          shapes.push_back({SurfaceKind::kCylinder, {0, high - radius, 0}, {0, 0, 1}, radius, 0, 0});
        }
        base[0] = {-3, 0};
        base[facets] = {3, 0};
        const PolygonMesh mesh = shapes::prism(base, 1);
        std::vector<std::uint32_t> groups;
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
          const auto face = mesh.face(FaceId(f));
          Vec3 sum;
          for (const VertexId v : face) sum += mesh.positions[v];
          const Vec3 middle = 0.25 * sum;
          if (face.size() != 4)
            groups.push_back(mesh.positions[face[0]].z == 0 ? 2 : 3);
          else
            groups.push_back(std::fabs(shapes[0].distance(middle)) < std::fabs(shapes[1].distance(middle)) ? 0 : 1);
        }
        shapes.resize(4, {SurfaceKind::kPlane, {}, {}, 0, 0, 0});
        const CutPart part({with_groups(mesh, groups), shapes}, {100, 2 * kPi / n});
        SCOPED_TRACE(n);
        expect_conforming(part);
        ASSERT_FALSE(crosses_itself(part.points_before(part.first_loop(2))));
        EXPECT_FALSE(crosses_itself(part.points(part.first_loop(2)))) << lower << " " << upper;
        fewest = std::min(fewest, part.points(part.first_loop(2)).size());
      }
  EXPECT_LT(fewest, 20u);  // the arcs are really cut anew
}

}  // namespace
}  // namespace remesh
