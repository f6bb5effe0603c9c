#include "core/geometry/trees/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// The tree over the first `n` faces of a turned sphere.
struct SphereTree {
  explicit SphereTree(std::size_t n, TriangleTree::Split split = TriangleTree::kByPlace)
      : mesh(shapes::triangles(shapes::rotated(shapes::sphere(4), {1, 2, 3}, 20))),
        tree(mesh.positions.items(), std::span(mesh.faces.items()).first(n), control, {}, split) {}

  RunControl control;
  TriangleMesh mesh;
  TriangleTree tree;
};

constexpr std::size_t kTreeSizes[] = {0, 1, 4, 5, 333, 2048};

constexpr TriangleTree::Split kSplits[] = {TriangleTree::kByPlace, TriangleTree::kByShape};

TEST(triangle_tree, every_face_has_one_slot_with_its_box) {
  for (const std::size_t i : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}) {
    const std::size_t n = kTreeSizes[i / 2];
    const SphereTree sphere(n, kSplits[i % 2]);
    ASSERT_EQ(sphere.tree.size(), n);
    std::vector<FaceId> faces;
    for (std::size_t slot = 0; slot < n; ++slot) {
      faces.push_back(sphere.tree.face(slot));
      Box3 box;
      for (const VertexId v : sphere.mesh.faces[faces.back()]) box.add(sphere.mesh.positions[v]);
      EXPECT_EQ(sphere.tree.box(slot).min, box.min);
      EXPECT_EQ(sphere.tree.box(slot).max, box.max);
    }
    std::sort(faces.begin(), faces.end());
    for (std::size_t f = 0; f < n; ++f) ASSERT_EQ(faces[f], FaceId(f));
  }
}

TEST(triangle_tree, a_query_visits_the_slots_whose_boxes_meet_the_box_in_order) {
  for (const std::size_t n : kTreeSizes) {
    const SphereTree sphere(n);
    Random random(1);
    for (int i = 0; i < 300; ++i) {
      const Vec3 corner{random.uniform(-1.5, 1), random.uniform(-1.5, 1), random.uniform(-1.5, 1)};
      const Box3 box{corner, corner + random.uniform(0, 0.5) * Vec3{1, 1, 1}};
      const std::size_t first = random.bits() % (n + 1);
      std::vector<std::size_t> expected, found;
      for (std::size_t slot = first; slot < n; ++slot)
        if (do_meet(sphere.tree.box(slot), box)) expected.push_back(slot);
      sphere.tree.visit_meeting(box, first, [&](std::size_t slot) {
        found.push_back(slot);
        return true;
      });
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(triangle_tree, a_query_ends_when_the_visitor_has_enough) {
  const SphereTree sphere(2048);
  int visits = 0;
  sphere.tree.visit_meeting({{-1, -1, -1}, {1, 1, 1}}, 0, [&](std::size_t) { return ++visits < 10; });
  EXPECT_EQ(visits, 10);
}

TEST(triangle_tree, boxes_that_touch_meet) {
  EXPECT_TRUE(do_meet({{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}));
  for (int axis = 0; axis < 3; ++axis) {
    Box3 apart{{0, 0, 0}, {1, 1, 1}};
    apart.min[axis] = 1.5;
    apart.max[axis] = 2;
    EXPECT_FALSE(do_meet({{0, 0, 0}, {1, 1, 1}}, apart));
    EXPECT_FALSE(do_meet(apart, {{0, 0, 0}, {1, 1, 1}}));
  }
}

TEST(triangle_tree, faces_of_one_group_stand_next_to_each_other) {
  const SphereTree sphere(1024);
  // Everywhere on the sphere faces of three groups and of none.
  std::vector<std::uint32_t> groups;
  for (std::uint32_t f = 0; f < 1024; ++f) groups.push_back(f % 4 < 3 ? f % 4 : TriangleTree::kNoGroup);
  RunControl control;
  const TriangleTree tree(sphere.mesh.positions.items(), std::span(sphere.mesh.faces.items()).first(1024), control,
                          groups);
  std::vector<std::vector<std::size_t>> slots(3);
  std::vector<FaceId> faces;
  for (std::size_t slot = 0; slot < tree.size(); ++slot) {
    faces.push_back(tree.face(slot));
    const std::uint32_t group = groups[tree.face(slot).value];
    if (group != TriangleTree::kNoGroup) slots[group].push_back(slot);
  }
  std::sort(faces.begin(), faces.end());
  for (std::uint32_t f = 0; f < 1024; ++f) ASSERT_EQ(faces[f], FaceId(f));
  std::size_t mixed = 0;
  for (std::size_t node = 0; node < tree.node_count(); ++node) {
    const auto [first, last] = tree.slots(node);
    for (std::size_t slot = first + 1; slot < last; ++slot)
      if (groups[tree.face(slot).value] != groups[tree.face(first).value]) {
        ++mixed;
        break;
      }
  }
  EXPECT_LT(mixed, 60u);  // of five hundred
}

}  // namespace
}  // namespace remesh
