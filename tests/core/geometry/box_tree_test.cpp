#include "core/geometry/trees/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

struct Least {
  float value = HUGE_VALF;
  void join(Least other) { value = std::min(value, other.value); }
};
using Tree = BoxTree<Least>;

std::vector<Tree::Entry> boxes(int n) {
  Random random(1);
  std::vector<Tree::Entry> entries(n);
  for (Tree::Entry& e : entries) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    e.box.add(p);
    e.box.add(p + Vec3{random.uniform(0, 0.1), random.uniform(0, 0.1), 0});
    e.tag.value = static_cast<float>(random.unit());
  }
  return entries;
}

TEST(box_tree, boxes_in_single_precision_hold_what_was_added) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), 0.5};
    FloatBox box;
    box.add(p);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(box.min[axis], p[axis]);
      EXPECT_GE(box.max[axis], p[axis]);
      EXPECT_LE(box.max[axis] - box.min[axis], 2e-7);
    }
    EXPECT_EQ(box.min[2], box.max[2]);
    EXPECT_EQ(squared_distance(box, p), 0);
  }
}

TEST(box_tree, the_farthest_place_of_a_box_is_one_of_its_corners) {
  const std::vector<Tree::Entry> entries = boxes(60);
  for (const Tree::Entry& a : entries)
    for (const Tree::Entry& b : entries) {
      double farthest = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const auto at = [&](int axis) -> double {
          return (corner >> axis) % 2 == 0 ? b.box.min[axis] : b.box.max[axis];
        };
        farthest = std::max(farthest, squared_distance(a.box, Vec3{at(0), at(1), at(2)}));
      }
      EXPECT_EQ(squared_farthest(a.box, b.box), farthest);
    }
}

TEST(box_tree, the_best_of_all_is_found_for_any_number_of_boxes) {
  RunControl control;
  for (const int n : {0, 1, 2, 4, 5, 8, 9, 31, 1000, 20000}) {
    const std::vector<Tree::Entry> entries = boxes(n);
    const Tree tree(entries, control);
    ASSERT_EQ(tree.size(), entries.size());
    Random random(3);
    for (int i = 0; i < 20; ++i) {
      const Vec3 p{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
      const auto value = [&](const Tree::Entry& e) { return e.tag.value + std::sqrt(squared_distance(e.box, p)); };
      double expected = HUGE_VAL, best = HUGE_VAL;
      for (const Tree::Entry& e : entries) expected = std::min(expected, value(e));
      std::size_t visits = 0, found = 0;
      tree.search(best, value, [&](std::size_t slot) {
        ++visits;
        found = slot;
        best = value(tree[slot]);
      });
      EXPECT_EQ(best, expected);
      if (n > 0) {
        EXPECT_EQ(value(entries[tree.number(found)]), expected);
      }
      EXPECT_LE(visits, 200u);
    }
  }
}

/// One in a hundred of the boxes asks for little, and the others, which are in the same places, for much.
TEST(box_tree, what_differs_in_its_offsets_is_not_in_one_node) {
  RunControl control;
  Random random(4);
  std::vector<Tree::Entry> entries = boxes(20000);
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].tag.value = i % 100 == 0 ? 0.25f : 10.0f;
  const auto offset = [](Least size) { return size.value; };
  const Tree plain(entries, control), split(entries, control, Offsets<decltype(offset)>{offset});
  std::size_t looks_at_plain = 0, looks_at_split = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto best_of = [&](const Tree& tree, std::size_t& looks) {
      const auto value = [&](const Tree::Entry& e) {
        ++looks;
        return e.tag.value + std::sqrt(squared_distance(e.box, p));
      };
      double best = HUGE_VAL;
      tree.search(best, value, [&](std::size_t slot) { best = std::min(best, value(tree[slot])); });
      return best;
    };
    EXPECT_EQ(best_of(split, looks_at_split), best_of(plain, looks_at_plain));
  }
  EXPECT_LT(4 * looks_at_split, 3 * looks_at_plain);
}

TEST(box_tree, what_has_no_finite_bound_is_never_visited) {
  RunControl control;
  const Tree tree(boxes(100), control);
  const double best = HUGE_VAL;
  tree.search(
      best, [](const Tree::Entry&) { return HUGE_VAL; }, [](std::size_t) { FAIL(); });
}

TEST(box_tree, each_slot_is_told_from_the_nodes_above_it) {
  RunControl control;
  for (const int n : {1, 2, 100}) {
    const Tree tree(boxes(n), control);
    int slots = 0, nodes = 0;
    const double best = HUGE_VAL;
    tree.search(
        best,
        [&](const Tree::Entry& e) {
          ++(tree.is_slot(e) ? slots : nodes);
          return 0.0;
        },
        [](std::size_t) {});
    EXPECT_EQ(slots, n);
    EXPECT_GE(nodes, 1);
  }
}

TEST(box_tree, what_is_noted_on_a_tag_is_told_of_all_that_is_in_it) {
  RunControl control;
  for (const int n : {0, 1, 4, 5, 1000}) {
    std::vector<Tree::Entry> entries = boxes(n);
    std::vector<float> values(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) values[i] = std::exchange(entries[i].tag.value, HUGE_VALF);
    Tree tree(entries, control);
    tree.note(
        [&](Least& tag, std::span<const std::uint32_t> among) {
          for (const std::uint32_t i : among) tag.join({values[i]});
        },
        control);
    for (std::size_t slot = 0; slot < tree.size(); ++slot) EXPECT_EQ(tree[slot].tag.value, values[tree.number(slot)]);
    // The tags of nodes lead to the least of all.
    double best = HUGE_VAL;
    tree.search(
        best, [](const Tree::Entry& e) { return e.tag.value; }, [&](std::size_t slot) { best = tree[slot].tag.value; });
    EXPECT_EQ(best, n == 0 ? HUGE_VAL : *std::min_element(values.begin(), values.end()));
  }
}

STAGE(box_tree, test::kWorkers, test::kStop) {
  const Tree tree(boxes(30'000), trial.control);
  for (std::size_t slot = 0; slot < tree.size(); ++slot) trial.in_order(tree.number(slot));
}

}  // namespace
}  // namespace remesh
