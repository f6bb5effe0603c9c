/// Puts items into slots under a binary tree whose structure is computed and not stored.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "core/base/blocks.h"
#include "core/base/run_control.h"

namespace remesh {

/// Items are in slots 0 .. n-1, and items that are near each other in space have slots near each other. Node j of level
/// l has the slots [n j / 2^l, n (j+1) / 2^l), so the tree needs no memory but for the values of its nodes. The
/// children of node j are the nodes 2j and 2j + 1 of the next level. A leaf has at most four slots. Nodes are numbered
/// level after level.
class SlotTree {
 public:
  static constexpr std::size_t kMaxLevels = 40;  ///< more than ids have bits

  explicit SlotTree(std::size_t slots = 0) : slots_(slots) {
    constexpr std::size_t kLeafSize = 4;
    while (slots_ > kLeafSize << leaf_level_) ++leaf_level_;
  }

  std::size_t size() const { return slots_; }
  int leaf_level() const { return leaf_level_; }
  std::size_t node_count() const { return number(leaf_level_ + 1, 0); }
  static std::size_t number(int level, std::size_t j) { return (std::size_t{1} << level) - 1 + j; }
  /// The first slot of a node. Its slots end where those of node j + 1 begin.
  std::size_t begin(int level, std::size_t j) const { return (slots_ * j) >> level; }

  /// Calls visit(j) for the nodes of a level, in parallel. Many small nodes share a task, and each large node has one
  /// of its own.
  template <class Visit>
  void visit_level(int level, RunControl& control, const Visit& visit) const {
    const std::size_t nodes = std::size_t{1} << level;
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / slots_), control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) visit(j);
    });
  }

  /// Puts items into the order of their slots. split(items, middle) reorders the items of a node so that the first
  /// `middle` belong to its first child.
  template <class Item, class Split>
  void sort(std::span<Item> items, RunControl& control, const Split& split) const {
    for (int level = 0; level < leaf_level_; ++level)
      visit_level(level, control, [&](std::size_t j) {
        const std::size_t first = begin(level, j);
        split(items.subspan(first, begin(level, j + 1) - first), begin(level + 1, 2 * j + 1) - first);
      });
  }

  /// Computes the value of each node, from the leaves up: of_slots(begin, end) gives that of a leaf, and
  /// of_children(first, second) that of another node.
  /// Input:  there is at least one slot.
  template <class Node, class OfSlots, class OfChildren>
  void join(std::span<Node> nodes, RunControl& control, const OfSlots& of_slots, const OfChildren& of_children) const {
    for (int level = leaf_level_; level >= 0; --level)
      for_blocks(std::size_t{1} << level, kBlock, control, [&](std::size_t j, std::size_t last) {
        for (; j < last; ++j)
          nodes[number(level, j)] =
              level == leaf_level_ ? of_slots(begin(level, j), begin(level, j + 1))
                                   : of_children(nodes[number(level + 1, 2 * j)], nodes[number(level + 1, 2 * j + 1)]);
      });
  }

 private:
  static constexpr std::size_t kBlock = 4096;

  std::size_t slots_;
  int leaf_level_ = 0;
};

/// Reorders items along the axis on which they are spread most, so that no item before `middle` is behind one from
/// `middle` on.
/// Input:  centre_of(item) is the place of an item, by axis. tie_of(item) orders items at one place.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
template <int kAxes = 3, class Item, class CentreOf, class TieOf>
void split_widest(std::span<Item> items, std::size_t middle, const CentreOf& centre_of, const TieOf& tie_of,
                  RunControl& control) {
  control.check();
  using Coordinate = std::decay_t<decltype(centre_of(items.front())[0])>;
  std::array<Coordinate, kAxes> min, max;
  min.fill(std::numeric_limits<Coordinate>::infinity());
  max.fill(-std::numeric_limits<Coordinate>::infinity());
  for (const Item& item : items)
    for (int axis = 0; axis < kAxes; ++axis) {
      const Coordinate x = centre_of(item)[axis];
      min[axis] = std::min(min[axis], x);
      max[axis] = std::max(max[axis], x);
    }
  int widest = 0;
  for (int axis = 1; axis < kAxes; ++axis)
    if (max[axis] - min[axis] > max[widest] - min[widest]) widest = axis;
  std::uint32_t comparisons = 0;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [&](const Item& a, const Item& b) {
                     if (++comparisons % (1u << 16) == 0) control.check_and_move();
                     const Coordinate x = centre_of(a)[widest], y = centre_of(b)[widest];
                     return x != y ? x < y : tie_of(a) < tie_of(b);
                   });
}

}  // namespace remesh
