#include "core/geometry/trees/slot_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

constexpr std::size_t kSizes[] = {1, 2, 4, 5, 31, 100'000};

TEST(slot_tree, the_nodes_of_a_level_have_all_slots_and_children_those_of_their_node) {
  for (const std::size_t n : kSizes) {
    const SlotTree tree(n);
    ASSERT_EQ(tree.size(), n);
    for (int level = 0; level <= tree.leaf_level(); ++level) {
      const std::size_t nodes = std::size_t{1} << level;
      EXPECT_EQ(tree.begin(level, 0), 0u);
      EXPECT_EQ(tree.begin(level, nodes), n);
      for (std::size_t j = 0; j < nodes; ++j) {
        ASSERT_LT(tree.begin(level, j), tree.begin(level, j + 1));
        if (level < tree.leaf_level()) {
          ASSERT_EQ(tree.begin(level + 1, 2 * j), tree.begin(level, j));
        } else {
          ASSERT_LE(tree.begin(level, j + 1) - tree.begin(level, j), 4u);
        }
      }
    }
    EXPECT_EQ(tree.node_count(), SlotTree::number(tree.leaf_level(), (std::size_t{1} << tree.leaf_level()) - 1) + 1);
  }
}

TEST(slot_tree, what_is_noted_on_nodes_is_joined_from_below) {
  RunControl control;
  for (const std::size_t n : kSizes) {
    const SlotTree tree(n);
    std::vector<std::size_t> counts(tree.node_count());
    tree.join(
        std::span(counts), control, [](std::size_t begin, std::size_t end) { return end - begin; },
        [](std::size_t a, std::size_t b) { return a + b; });
    EXPECT_EQ(counts[0], n);
  }
}

TEST(slot_tree, items_are_parted_along_the_axis_on_which_they_are_spread_widest) {
  RunControl control;
  Random random(1);
  for (const std::size_t n : kSizes) {
    std::vector<Vec3> items(n);
    for (Vec3& p : items) p = {random.uniform(0, 1), random.uniform(0, 100), random.uniform(0, 1)};
    const SlotTree tree(n);
    tree.sort(std::span(items), control, [&](std::span<Vec3> of_node, std::size_t middle) {
      split_widest(
          of_node, middle, [](const Vec3& p) -> const Vec3& { return p; }, [](const Vec3& p) { return p; }, control);
    });
    if (tree.leaf_level() == 0) continue;
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>(tree.begin(1, 1));
    const auto is_lower = [](const Vec3& a, const Vec3& b) { return a.y < b.y; };
    EXPECT_LE(std::max_element(items.begin(), middle, is_lower)->y, std::min_element(middle, items.end(), is_lower)->y);
  }
}

STAGE(slot_tree, test::kStop) {
  std::vector<Vec3> items(5);
  const auto itself = [](const Vec3& p) { return p; };
  split_widest(std::span(items), 2, itself, itself, trial.control);
}

}  // namespace
}  // namespace remesh
