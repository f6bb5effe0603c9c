/// A tree of axis-aligned boxes with a small tag on each. Searches visit the most promising boxes first.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/slot_tree.h"

namespace remesh {

/// A box in single precision, rounded outwards. It takes half the memory of a box of doubles, and a point outside of it
/// is also outside of the exact box.
struct FloatBox {
  std::array<float, 3> min{HUGE_VALF, HUGE_VALF, HUGE_VALF};
  std::array<float, 3> max{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void add(const FloatBox& b) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = std::min(min[axis], b.min[axis]);
      max[axis] = std::max(max[axis], b.max[axis]);
    }
  }
  void add(const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      min[axis] = std::min(min[axis], rounded_down(p[axis]));
      max[axis] = std::max(max[axis], -rounded_down(-p[axis]));
    }
  }

  /// The largest float that is not above x.
  static float rounded_down(double x) {
    const float f = static_cast<float>(x);
    return static_cast<double>(f) > x ? std::nextafter(f, -HUGE_VALF) : f;
  }
};

/// Returns whether all of the inner box is in the outer one.
template <class Box>
bool contains(const Box& outer, const Box3& inner) {
  for (int axis = 0; axis < 3; ++axis)
    if (inner.min[axis] < outer.min[axis] || inner.max[axis] > outer.max[axis]) return false;
  return true;
}

/// The distance of x from the interval [min, max]; 0 inside it.
inline double excess(double min, double max, double x) { return std::max(0.0, std::max(min - x, x - max)); }

/// The squared distance from p to the nearest point of the box. Every step of the computation is monotone, so even with
/// rounding the result is never more than that of a box inside this one.
inline double squared_distance(const FloatBox& b, const Vec3& p) {
  const double x = excess(b.min[0], b.max[0], p.x);
  const double y = excess(b.min[1], b.max[1], p.y);
  const double z = excess(b.min[2], b.max[2], p.z);
  return x * x + y * y + z * z;
}
inline double squared_distance(const FloatBox& a, const FloatBox& b) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = std::max(0.0, std::max(double{a.min[axis]} - b.max[axis], double{b.min[axis]} - a.max[axis]));
    sum += d * d;
  }
  return sum;
}
/// The squared distance to the box from that point of `from` which is farthest from the box. It is monotone in the box,
/// too.
inline double squared_farthest(const FloatBox& b, const FloatBox& from) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d =
        std::max(excess(b.min[axis], b.max[axis], from.min[axis]), excess(b.min[axis], b.max[axis], from.max[axis]));
    sum += d * d;
  }
  return sum;
}

/// The tag of trees that need none.
struct NoTag {
  void join(NoTag) {}
};

/// The offsets of trees in which bounds depend on distances alone.
struct NoOffsets {
  static constexpr int kAxes = 3;
};
/// Searches add a value to the distance from an entry, and an offset is this value as a length. A node whose entries
/// differ more in their offsets than in their places is split by the offsets, as if they were a fourth axis. Otherwise
/// its bound would be too low for most of its entries.
template <class Of>
struct Offsets {
  static constexpr int kAxes = 4;
  Of of;  ///< called with a tag
};

/// Returns the offset of an entry that limits sizes to `size`, where sizes grow with the distance by `slope`. For steep
/// slopes the offset is nearly constant, but a node must still keep large and small sizes apart: things with a large
/// size are about as large themselves, and so is the box of their node. Therefore `slope` counts as at most 1.
inline float offset_of_size(double size, double slope) {
  constexpr double kFarthest = 0x1p100;  // this is for sizes that hardly grow
  const double steepness = std::min(slope, 1.0);
  return static_cast<float>(size < kFarthest * steepness ? size / steepness : kFarthest);
}

/// Boxes in the slots of a SlotTree. A node of the tree stores a box and a tag, and nothing else.
/// Tag:    a type with a function `Tag::join(other)`, after which the tag is true of both.
/// Holds:  the order of the slots depends on the boxes and their offsets alone, not on threads.
/// Cost:   O(n log n) to build, in parallel.
template <class Tag>
class BoxTree {
 public:
  struct Entry {
    FloatBox box;
    Tag tag;
  };

  using Entries = std::vector<Entry, DefaultInit<Entry>>;
  /// Makes n entries in parallel: calls set(i, entry) with the i-th one, whose box is empty. Clearing millions of
  /// entries first would take long and could not be cancelled.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  template <class Set>
  static Entries make_entries(std::size_t n, RunControl& control, const Set& set);

  BoxTree() = default;
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  template <class TheOffsets = NoOffsets>
  BoxTree(std::span<const Entry> entries, RunControl& control, const TheOffsets& offsets = {});

  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t slot) const { return entries_[slot]; }
  /// Returns whether an entry is one of those in the slots, and not a node that joins several.
  bool is_slot(const Entry& entry) const {
    return !std::less<>()(&entry, entries_.data()) && std::less<>()(&entry, entries_.data() + entries_.size());
  }
  /// The index that the slot's entry had when it was given to the constructor.
  std::uint32_t number(std::size_t slot) const { return number_[slot]; }

  /// Calls note(tag, numbers) for each tag of entries and nodes, where `numbers` are those of all entries in it. So
  /// tags can get information that joining alone would not give.
  /// Cost:   O(n log n) numbers are passed in all, in parallel.
  template <class Note>
  void note(const Note& note, RunControl& control);

  /// Calls visit(slot), which may lower `best`, until no entry can lower it any more. `bound(entry)` is the smallest
  /// value that anything in the entry's box can attain, and infinity for entries of no interest. The bound of a node
  /// must not be above the bounds of the entries that it joins.
  template <class Bound, class Visit>
  void search(const double& best, const Bound& bound, const Visit& visit) const;

 private:
  static constexpr std::size_t kBlock = 4096;

  template <class TheOffsets>
  void sort(std::span<const Entry> entries, const TheOffsets& offsets, RunControl& control);
  static void join(Entry& entry, const Entry& other) {
    entry.box.add(other.box);
    entry.tag.join(other.tag);
  }

  // All threads fill these.
  template <class T>
  using Unset = std::vector<T, DefaultInit<T>>;

  SlotTree slots_;
  Unset<Entry> entries_;         ///< by slot
  Unset<std::uint32_t> number_;  ///< by slot
  Unset<Entry> nodes_;           ///< stored level after level
};

template <class Tag>
template <class Set>
typename BoxTree<Tag>::Entries BoxTree<Tag>::make_entries(std::size_t n, RunControl& control, const Set& set) {
  Entries entries(n);
  for_blocks(n, kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Entry entry{};
      set(i, entry);
      entries[i] = entry;
    }
  });
  return entries;
}

template <class Tag>
template <class TheOffsets>
BoxTree<Tag>::BoxTree(std::span<const Entry> entries, RunControl& control, const TheOffsets& offsets)
    : slots_(entries.size()), entries_(entries.size()), number_(entries.size()) {
  if (entries.empty()) return;
  sort(entries, offsets, control);
  nodes_.resize(slots_.node_count());
  const auto joined = [](Entry entry, const Entry& other) {
    join(entry, other);
    return entry;
  };
  const auto of_slots = [&](std::size_t slot, std::size_t end) {
    Entry node = entries_[slot];
    while (++slot < end) join(node, entries_[slot]);
    return node;
  };
  slots_.join(std::span(nodes_), control, of_slots, joined);
}

template <class Tag>
template <class TheOffsets>
void BoxTree<Tag>::sort(std::span<const Entry> entries, const TheOffsets& offsets, RunControl& control) {
  struct Place {
    std::array<float, TheOffsets::kAxes> centre;  ///< twice the box's centre, and the offset if there is one
    std::uint32_t number;
  };
  Unset<Place> places(size());
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int axis = 0; axis < 3; ++axis) places[i].centre[axis] = entries[i].box.min[axis] + entries[i].box.max[axis];
      if constexpr (TheOffsets::kAxes > 3) places[i].centre[3] = 2 * offsets.of(entries[i].tag);
      places[i].number = static_cast<std::uint32_t>(i);
    }
  });
  slots_.sort(std::span(places), control, [&](std::span<Place> of_node, std::size_t middle) {
    split_widest<TheOffsets::kAxes>(
        of_node, middle, [](const Place& p) -> const auto& { return p.centre; },
        [](const Place& p) { return p.number; }, control);
  });
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) {
      number_[slot] = places[slot].number;
      entries_[slot] = entries[number_[slot]];
    }
  });
}

template <class Tag>
template <class Note>
void BoxTree<Tag>::note(const Note& note, RunControl& control) {
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) note(entries_[slot].tag, std::span(number_).subspan(slot, 1));
  });
  for (int level = 0; level <= slots_.leaf_level() && !nodes_.empty(); ++level)
    slots_.visit_level(level, control, [&](std::size_t j) {
      control.check();
      const std::size_t begin = slots_.begin(level, j), end = slots_.begin(level, j + 1);
      note(nodes_[slots_.number(level, j)].tag, std::span(number_).subspan(begin, end - begin));
    });
}

template <class Tag>
template <class Bound, class Visit>
void BoxTree<Tag>::search(const double& best, const Bound& bound, const Visit& visit) const {
  if (nodes_.empty()) return;
  struct Waiting {
    double bound;
    std::size_t node;
  };
  // The search goes depth first, and visits the better child first. So at most one sibling waits on each level.
  std::array<Waiting, SlotTree::kMaxLevels> stack;
  std::size_t depth = 0;
  const int leaf_level = slots_.leaf_level();
  const std::size_t first_leaf = SlotTree::number(leaf_level, 0);
  Waiting here{bound(nodes_[0]), 0};
  while (true) {
    if (here.bound < best) {
      if (here.node < first_leaf) {
        Waiting near{bound(nodes_[2 * here.node + 1]), 2 * here.node + 1};
        Waiting far{bound(nodes_[2 * here.node + 2]), 2 * here.node + 2};
        if (far.bound < near.bound) std::swap(near, far);
        if (far.bound < best) stack[depth++] = far;
        here = near;
        continue;
      }
      const std::size_t j = here.node - first_leaf;
      for (std::size_t slot = slots_.begin(leaf_level, j); slot < slots_.begin(leaf_level, j + 1); ++slot)
        if (bound(entries_[slot]) < best) visit(slot);
    }
    if (depth == 0) return;
    here = stack[--depth];
  }
}

}  // namespace remesh
