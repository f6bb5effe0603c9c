#include "core/geometry/intersections/axial_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/apart_nodes.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Faces around the line through the first two vertices: at one of them, at both, or elsewhere.
struct Around {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;

  VertexId add(const Vec3& p) {
    positions.push_back(p);
    return VertexId(positions.size() - 1);
  }
};

/// Makes random faces. Their coordinates are either whole numbers, so that many faces just touch the line or lie on it,
/// or any numbers near the line or a little away from it.
Around random_faces(int seed) {
  Random random(seed);
  Around around;
  const double reach = seed % 4 == 1 ? 1e-13 : 1;
  const auto place = [&] {
    return seed % 2 == 0
               ? Vec3{1.0 * random.below(5), 1.0 * random.below(5), 1.0 * random.below(4)}
               : Vec3{1 + reach * random.uniform(-1, 1), 1 + reach * random.uniform(-1, 1), 4 * random.unit()};
  };
  const Vec3 away = seed % 3 == 0 ? Vec3{1e6, -1e7, 3e5} : Vec3{};
  around.add(away + Vec3{1, 1, 1});
  around.add(away + Vec3{1, 1, 3});
  std::vector<VertexId> points;
  for (int i = 0; i < 60; ++i) {
    Vec3 p = away + place();
    while (std::find(around.positions.begin(), around.positions.end(), p) != around.positions.end()) p = away + place();
    points.push_back(around.add(p));
  }
  const auto point = [&] { return points[random.below(static_cast<int>(points.size()))]; };
  for (int i = 0; i < 200; ++i) {
    Triangle face{VertexId(0), VertexId(1), point()};
    if (i % 4 != 0) face[i % 2] = point();
    if (i % 4 == 3) face[1] = point();
    around.faces.push_back(face);
  }
  return around;
}

TEST(axial_bounds, what_meets_a_face_at_the_line_is_not_apart_from_it) {
  std::size_t met = 0, apart = 0;
  for (int seed = 0; seed < 12; ++seed) {
    const Around around = random_faces(seed);
    RunControl control;
    const TriangleTree tree(around.positions, around.faces, control);
    const AxialBounds bounds(tree, around.positions, around.faces, VertexId(0), VertexId(1), control);
    for (const Triangle& face : around.faces) {
      if (face[0] != VertexId(0) && face[1] != VertexId(1)) continue;
      SCOPED_TRACE(seed);
      const AxialBounds::Arc arc = bounds.arc_of(face);
      const NodeCounts counts = expect_no_met_node_is_apart(
          tree, around.positions, around.faces, face, [&](std::size_t node) { return bounds.are_apart(arc, node); });
      met += counts.met;
      apart += counts.apart;
    }
  }
  EXPECT_GT(met, 1000u);
  EXPECT_GT(apart, 1000u);
}

TEST(axial_bounds, pages_of_a_book_are_apart_wherever_the_turn_begins) {
  constexpr int kPages = 64;
  Around around;
  const VertexId from = around.add({0, 0, 0}), to = around.add({1, 2, 3});
  const Vec3 u = normalized(cross(Vec3{1, 2, 3}, {1, 0, 0})), v = normalized(cross(Vec3{1, 2, 3}, u));
  for (int i = 0; i < kPages; ++i) {
    const double angle = 2 * M_PI * i / kPages;
    around.faces.push_back({from, to, around.add(std::cos(angle) * u + std::sin(angle) * v)});
  }
  RunControl control;
  const TriangleTree tree(around.positions, around.faces, control);
  const AxialBounds bounds(tree, around.positions, around.faces, from, to, control);
  for (const Triangle& face : around.faces) {
    int near = 0;
    for (std::size_t node = tree.node_count() / 2; node < tree.node_count(); ++node)
      near += !bounds.are_apart(bounds.arc_of(face), node);
    EXPECT_LE(near, 2);  // leaves
  }
}

}  // namespace
}  // namespace remesh
