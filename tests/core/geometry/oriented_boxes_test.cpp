#include "core/geometry/trees/oriented_boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/apart_nodes.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Triangles with corners of their own.
struct Soup {
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::size_t n = positions.size();
    positions.insert(positions.end(), {a, b, c});
    faces.push_back({VertexId(n), VertexId(n + 1), VertexId(n + 2)});
  }
};

TEST(oriented_boxes, what_meets_a_triangle_of_a_node_is_not_apart_from_it) {
  for (int seed = 0; seed < 6; ++seed) {
    Random random(seed);
    Soup soup;
    // Whole coordinates, so that many just touch, and faces without area among them; or needles at any place.
    const auto place = [&] {
      return seed % 2 == 0 ? Vec3{1.0 * random.below(6), 1.0 * random.below(6), 1.0 * random.below(3)}
                           : Vec3{random.unit(), random.unit(), 0.1 * random.unit()};
    };
    for (int i = 0; i < 150; ++i) {
      const Vec3 a = place(), b = place();
      soup.add(a, b, seed % 2 == 0 ? place() : b + 0.01 * place());
    }
    RunControl control;
    const TriangleTree tree(soup.positions, soup.faces, control);
    const OrientedBoxes boxes(tree, soup.positions, soup.faces, 0, control);
    std::size_t met = 0, apart = 0;
    for (const Triangle& face : soup.faces) {
      SCOPED_TRACE(seed);
      const OrientedBoxes::Query query = boxes.query(face);
      const NodeCounts counts = expect_no_met_node_is_apart(
          tree, soup.positions, soup.faces, face, [&](std::size_t node) { return boxes.are_apart(query, node); });
      met += counts.met;
      apart += counts.apart;
    }
    EXPECT_GT(met, 100u);
    EXPECT_GT(apart, 100u);
  }
}

TEST(oriented_boxes, of_needles_side_by_side_and_askew_a_few_nodes_are_not_apart) {
  constexpr int kNeedles = 4000;
  Soup soup;
  for (int i = 0; i < kNeedles; ++i) {
    const Vec3 from = (1.0 * i / kNeedles) * Vec3{1, -1, 0};
    soup.add(from, from + Vec3{1, 1, 1}, from + Vec3{1 + 0.1 / kNeedles, 1, 1});
  }
  RunControl control;
  const TriangleTree tree(soup.positions, soup.faces, control);
  const OrientedBoxes boxes(tree, soup.positions, soup.faces, 0, control);
  std::size_t by_boxes = 0, by_oriented = 0;
  for (std::size_t slot = 0; slot < tree.size(); slot += 100) {
    tree.visit_meeting(tree.box(slot), 0, [&](std::size_t) { return ++by_boxes > 0; });
    const OrientedBoxes::Query query = boxes.query(soup.faces[tree.face(slot).value]);
    tree.visit_meeting(
        tree.box(slot), 0, [&](std::size_t node) { return boxes.are_apart(query, node); },
        [&](std::size_t) { return ++by_oriented > 0; });
  }
  EXPECT_GT(by_boxes, 40u * 2000);
  EXPECT_LT(by_oriented, 40u * 40);
}

}  // namespace
}  // namespace remesh
