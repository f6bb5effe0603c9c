#include "core/mending/polygons/covered_polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

Surface cut(const PolygonMesh& mesh, double tolerance = 1e-9) {
  RunControl control;
  Surface surface = shapes::surface(mesh);
  const Adjacency edges(surface.vertex_count(), surface.face_begin, surface.corners, control);
  cut_covered_polygons(surface, edges, tolerance, control);
  return surface;
}

/// The corners of the triangles, each in order, and all in order.
std::vector<std::array<VertexId, 3>> triangles(const Surface& surface, std::uint32_t first, std::uint32_t end) {
  std::vector<std::array<VertexId, 3>> all;
  for (std::uint32_t f = first; f < end; ++f) {
    const auto loop = surface.face(FaceId(f));
    EXPECT_EQ(loop.size(), 3u);
    std::array<VertexId, 3> t{loop[0], loop[1], loop[2]};
    std::sort(t.begin(), t.end());
    all.push_back(t);
  }
  std::sort(all.begin(), all.end());
  return all;
}

using Faces = std::vector<std::vector<std::uint32_t>>;

/// A triangulation of a convex polygon, drawn at random.
Faces random_triangulation(std::vector<std::uint32_t> loop, Random& random) {
  Faces result;
  while (loop.size() > 3) {
    const auto i = static_cast<std::size_t>(random.unit() * static_cast<double>(loop.size())) % loop.size();
    result.push_back({loop[i], loop[(i + 1) % loop.size()], loop[(i + 2) % loop.size()]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>((i + 1) % loop.size()));
  }
  result.push_back(loop);
  return result;
}

TEST(cut_covered_polygons, a_polygon_gets_the_triangles_that_lie_over_it_from_either_side) {
  for (int seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const std::uint32_t n = 4 + static_cast<std::uint32_t>(seed) % 9;
    std::vector<Vec3> points;
    std::vector<std::uint32_t> loop;
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      points.push_back({std::cos(angle), std::sin(angle), 0});
      loop.push_back(i);
    }
    Faces faces{loop};
    for (std::vector<std::uint32_t> t : random_triangulation(loop, random)) {
      if (seed % 2 != 0) std::reverse(t.begin(), t.end());
      faces.push_back(t);
    }
    const Surface surface = cut(shapes::from_lists(points, faces));
    ASSERT_EQ(surface.face_count(), 2 * (n - 2));
    EXPECT_EQ(triangles(surface, 0, n - 2), triangles(surface, n - 2, 2 * (n - 2)));
    for (std::uint32_t f = 0; f < n - 2; ++f) EXPECT_EQ(surface.face_source[FaceId(f)], FaceId(0));
    // With one triangle less, the polygon is not covered.
    faces.pop_back();
    EXPECT_EQ(cut(shapes::from_lists(points, faces)).face_count(), faces.size());
  }
}

TEST(cut_covered_polygons, a_bent_polygon_is_cut_by_its_own_triangles_but_not_by_those_behind_it) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0.25}, {1, 1, 0}, {0, 1, 0.25}};
  EXPECT_EQ(cut(shapes::from_lists(points, {{0, 1, 2, 3}, {0, 1, 2}, {2, 3, 0}})).face_count(), 4u);
  EXPECT_EQ(cut(shapes::from_lists(points, {{0, 1, 2, 3}, {2, 1, 0}, {0, 3, 2}})).face_count(), 3u);
  EXPECT_EQ(cut(shapes::from_lists(points, {{0, 1, 2, 3}, {2, 1, 0}, {0, 3, 2}}), 1).face_count(), 4u);
}

TEST(cut_covered_polygons, triangles_in_the_notch_of_a_polygon_do_not_lie_over_it) {
  // A dart, the triangle that fills its notch, and the two triangles of both together.
  const std::vector<Vec3> points{{0, 0, 0}, {2, -1, 0}, {1, 0, 0}, {2, 1, 0}};
  const Faces faces{{0, 1, 2, 3}, {1, 3, 2}, {0, 1, 3}};
  EXPECT_EQ(cut(shapes::from_lists(points, faces)).face_count(), 3u);
}

TEST(cut_covered_polygons, a_surface_of_polygons_is_left_alone) {
  const PolygonMesh box = shapes::quad_box({1, 2, 3}, 3);
  EXPECT_EQ(cut(box).face_count(), box.face_count());
}

}  // namespace
}  // namespace remesh
