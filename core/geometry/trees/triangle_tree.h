/// A tree of boxes over the triangles of a surface, for finding those near a place.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/geometry/trees/slot_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Triangles in the slots of a SlotTree. A node stores its box and nothing else.
/// Holds:   the slots and boxes depend on the surface alone, not on threads.
/// Cost:    O(n log n) to build, in parallel. A query costs O(log n + what it finds) if the triangles have similar
///          sizes.
class TriangleTree {
 public:
  enum Split {
    kByPlace,  ///< across the axis along which the triangles of a node are spread most
    kByShape,  ///< by split_by_shape, which takes several times as long and is for long triangles
  };

  /// Input:   `groups` is empty or has one entry per face. In nodes of up to 2^13 faces, the faces of one group have
  ///          slots next to each other, and faces of kNoGroup are ordered by place. So few of the nodes below mix faces
  ///          of a group with other faces.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control,
               std::span<const std::uint32_t> groups = {}, Split split = kByPlace);
  static constexpr std::uint32_t kNoGroup = 0xffffffffu;

  std::size_t size() const { return face_.size(); }
  FaceId face(std::size_t slot) const { return face_[slot]; }
  const Box3& box(std::size_t slot) const { return slot_box_[slot]; }

  /// The number of nodes. Nodes are numbered level after level, and from left to right in each level.
  std::size_t node_count() const { return node_box_.size(); }
  /// The slots of a node: the first one, and the one after the last.
  std::pair<std::size_t, std::size_t> slots(std::size_t node) const {
    const int level = static_cast<int>(std::bit_width(node + 1)) - 1;
    const std::size_t j = node - SlotTree::number(level, 0);
    return {slots_.begin(level, j), slots_.begin(level, j + 1)};
  }

  /// Calls visit(slot) for the slots from `first` on whose boxes meet `box` (touching included). It visits them in
  /// ascending order, and stops when visit returns false.
  template <class Visit>
  void visit_meeting(const Box3& box, std::size_t first, const Visit& visit) const {
    visit_meeting(
        box, first, [](std::size_t) { return false; }, visit);
  }
  /// Visits slots in the same way, but skips nodes for which is_of_no_interest(node) holds.
  template <class IsOfNoInterest, class Visit>
  void visit_meeting(const Box3& box, std::size_t first, const IsOfNoInterest& is_of_no_interest,
                     const Visit& visit) const;

  std::size_t leaf_count() const { return std::size_t{1} << slots_.leaf_level(); }
  /// The node of a leaf.
  std::size_t node_of_leaf(std::size_t leaf) const { return SlotTree::number(slots_.leaf_level(), leaf); }
  /// The slots of a leaf: the first one, and the one after the last.
  std::pair<std::size_t, std::size_t> slots_of_leaf(std::size_t leaf) const {
    return {slots_.begin(slots_.leaf_level(), leaf), slots_.begin(slots_.leaf_level(), leaf + 1)};
  }
  const Box3& box_of_node(std::size_t node) const { return node_box_[node]; }
  /// Calls visit(leaf) for the leaves from `first` on whose boxes meet `box`, in ascending order, until visit returns
  /// false.
  template <class Visit>
  void visit_meeting_leaves(const Box3& box, std::size_t first, const Visit& visit) const;

  /// Computes a value for each node: `join` of the values of_slot(i) of the triangles below the node, where i is the
  /// place of a triangle in the order of the tree.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  template <class Value, class OfSlot, class Join>
  std::vector<Value> joined(const OfSlot& of_slot, const Join& join, RunControl& control) const;

 private:
  template <class T>
  using Unset = std::vector<T, DefaultInit<T>>;

  /// Puts the faces into their slots. item_of(f) is what split(items, middle) reorders.
  template <class Item, class ItemOf, class SplitNode>
  void sort(const ItemOf& item_of, std::span<const std::uint32_t> groups, RunControl& control, const SplitNode& split);

  SlotTree slots_;
  Unset<FaceId> face_;    ///< by slot
  Unset<Box3> slot_box_;  ///< by slot
  Unset<Box3> node_box_;  ///< stored level after level
};

/// Returns whether the two closed boxes have a point in common.
inline bool do_meet(const Box3& a, const Box3& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

template <class IsOfNoInterest, class Visit>
void TriangleTree::visit_meeting(const Box3& box, std::size_t first, const IsOfNoInterest& is_of_no_interest,
                                 const Visit& visit) const {
  struct Node {
    int level;
    std::size_t j;
  };
  // The search goes depth first, so at most one sibling waits on each level.
  std::array<Node, SlotTree::kMaxLevels> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const Node node = stack[--depth];
    const std::size_t end = slots_.begin(node.level, node.j + 1), index = SlotTree::number(node.level, node.j);
    if (end <= first || !do_meet(node_box_[index], box) || is_of_no_interest(index)) continue;
    if (node.level < slots_.leaf_level()) {
      stack[depth++] = {node.level + 1, 2 * node.j + 1};
      stack[depth++] = {node.level + 1, 2 * node.j};
      continue;
    }
    for (std::size_t slot = std::max(first, slots_.begin(node.level, node.j)); slot < end; ++slot)
      if (do_meet(slot_box_[slot], box) && !visit(slot)) return;
  }
}

template <class Visit>
void TriangleTree::visit_meeting_leaves(const Box3& box, std::size_t first, const Visit& visit) const {
  struct Node {
    std::size_t number;
    int levels_below;
  };
  std::array<Node, SlotTree::kMaxLevels> stack;
  std::size_t depth = 0;
  const std::size_t first_leaf = node_of_leaf(0);
  stack[depth++] = {0, slots_.leaf_level()};
  while (depth > 0) {
    const auto [node, levels] = stack[--depth];
    const std::size_t last_leaf = ((node + 2) << levels) - 2 - first_leaf;
    if (last_leaf < first || !do_meet(node_box_[node], box)) continue;
    if (levels == 0) {
      if (!visit(node - first_leaf)) return;
      continue;
    }
    stack[depth++] = {2 * node + 2, levels - 1};
    stack[depth++] = {2 * node + 1, levels - 1};
  }
}

template <class Value, class OfSlot, class Join>
std::vector<Value> TriangleTree::joined(const OfSlot& of_slot, const Join& join, RunControl& control) const {
  std::vector<Value> values(node_box_.size());
  StopCheck check(control);
  for (int level = slots_.leaf_level(); level >= 0; --level)
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      check();
      Value& value = values[SlotTree::number(level, j)];
      if (level < slots_.leaf_level()) {
        value = join(values[SlotTree::number(level + 1, 2 * j)], values[SlotTree::number(level + 1, 2 * j + 1)]);
        continue;
      }
      std::size_t slot = slots_.begin(level, j);
      const std::size_t end = slots_.begin(level, j + 1);
      if (slot < end) value = of_slot(slot);
      while (++slot < end) value = join(value, of_slot(slot));
    }
  return values;
}

}  // namespace remesh
