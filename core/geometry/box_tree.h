/// A tree of axis-aligned boxes with something small noted on each, searched best first.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A box in single precision, rounded outwards: half the memory, and what is outside of it is outside of the exact one.
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

/// How far x is outside of [min, max].
inline double excess(double min, double max, double x) { return std::max(0.0, std::max(min - x, x - max)); }

/// From a place to the nearest point of the box. Every step is monotone: never more than that of a box inside this one,
/// rounding included.
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
/// From the place of `from` that is farthest from the box to the box; as monotone in the box.
inline double squared_farthest(const FloatBox& b, const FloatBox& from) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d =
        std::max(excess(b.min[axis], b.max[axis], from.min[axis]), excess(b.min[axis], b.max[axis], from.max[axis]));
    sum += d * d;
  }
  return sum;
}

/// For trees in which nothing is noted.
struct NoTag {
  void join(NoTag) {}
};

/// The boxes stand in slots 0 .. n-1, neighbours in space near each other. Node j of level l has the slots
/// [n j / 2^l, n (j+1) / 2^l): arithmetic, so that a node is its box and its tag and nothing else.
/// Tag:    what is noted; `Tag::join(other)` makes it true of both.
/// Holds:  the order of the slots depends on the boxes alone, not on threads.
/// Cost:   O(n log n) to build, in parallel.
template <class Tag>
class BoxTree {
 public:
  struct Entry {
    FloatBox box;
    Tag tag;
  };

  BoxTree() = default;
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  BoxTree(std::span<const Entry> entries, RunControl& control);

  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::size_t slot) const { return entries_[slot]; }
  /// Is it one of those, not a node that joins some?
  bool is_slot(const Entry& entry) const {
    return !std::less<>()(&entry, entries_.data()) && std::less<>()(&entry, entries_.data() + entries_.size());
  }
  /// Which of the entries given to the constructor this is.
  std::uint32_t number(std::size_t slot) const { return number_[slot]; }

  /// Lets note(tag, numbers) add to each tag, of entries and of nodes, what is to be learnt only from all that is in
  /// it. Cost:   O(n log n) of what is noted, in parallel.
  template <class Note>
  void note(const Note& note, RunControl& control);

  /// Lets visit(slot) lower `best` until no entry can. `bound(entry)` is the least that anything in an entry's box may
  /// attain, infinity for what is of no interest; it must not be more for an entry than for those joined to it.
  template <class Bound, class Visit>
  void search(const double& best, const Bound& bound, const Visit& visit) const;

 private:
  /// A leaf has at most this many slots.
  static constexpr std::size_t kLeafSize = 4;
  static constexpr std::size_t kMaxLevels = 40;  ///< more than ids have bits
  static constexpr std::size_t kBlock = 4096;

  static std::size_t node_index(int level, std::size_t j) { return (std::size_t{1} << level) - 1 + j; }
  std::size_t node_begin(int level, std::size_t j) const { return (size() * j) >> level; }

  struct Place {
    std::array<float, 3> centre;  ///< of the box, twice
    std::uint32_t number;
  };
  static void split(std::span<Place> places, std::size_t middle, RunControl& control);
  void sort(std::span<const Entry> entries, RunControl& control);
  static void join(Entry& entry, const Entry& other) {
    entry.box.add(other.box);
    entry.tag.join(other.tag);
  }

  int leaf_level_ = 0;
  std::vector<Entry> entries_;         ///< by slot
  std::vector<std::uint32_t> number_;  ///< by slot
  std::vector<Entry> nodes_;           ///< level after level
};

template <class Tag>
BoxTree<Tag>::BoxTree(std::span<const Entry> entries, RunControl& control)
    : entries_(entries.size()), number_(entries.size()) {
  if (entries.empty()) return;
  while (size() > kLeafSize << leaf_level_) ++leaf_level_;
  sort(entries, control);
  nodes_.resize(node_index(leaf_level_ + 1, 0));
  for (int level = leaf_level_; level >= 0; --level)
    for_blocks(std::size_t{1} << level, kBlock, control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        Entry& node = nodes_[node_index(level, j)];
        if (level < leaf_level_) {
          node = nodes_[node_index(level + 1, 2 * j)];
          join(node, nodes_[node_index(level + 1, 2 * j + 1)]);
        } else {
          std::size_t slot = node_begin(level, j);
          node = entries_[slot];
          while (++slot < node_begin(level, j + 1)) join(node, entries_[slot]);
        }
      }
    });
}

template <class Tag>
void BoxTree<Tag>::sort(std::span<const Entry> entries, RunControl& control) {
  std::vector<Place> places(size());
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int axis = 0; axis < 3; ++axis) places[i].centre[axis] = entries[i].box.min[axis] + entries[i].box.max[axis];
      places[i].number = static_cast<std::uint32_t>(i);
    }
  });
  for (int level = 0; level < leaf_level_; ++level) {
    // One task for many small nodes, one node a task where they are large.
    const std::size_t nodes = std::size_t{1} << level;
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / size()), control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        const std::size_t begin = node_begin(level, j), end = node_begin(level, j + 1);
        split(std::span(places).subspan(begin, end - begin), node_begin(level + 1, 2 * j + 1) - begin, control);
      }
    });
  }
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) {
      number_[slot] = places[slot].number;
      entries_[slot] = entries[number_[slot]];
    }
  });
}

/// Parts the places so that all before `middle` are, along the longest axis, before all from there on.
template <class Tag>
void BoxTree<Tag>::split(std::span<Place> places, std::size_t middle, RunControl& control) {
  control.check();
  FloatBox centres;
  for (const Place& p : places) centres.add(FloatBox{p.centre, p.centre});
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (centres.max[axis] - centres.min[axis] > centres.max[longest] - centres.min[longest]) longest = axis;
  std::uint32_t comparisons = 0;
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(middle), places.end(),
                   [&](const Place& a, const Place& b) {
                     if (++comparisons % (1u << 16) == 0) control.check();
                     return std::pair(a.centre[longest], a.number) < std::pair(b.centre[longest], b.number);
                   });
}

template <class Tag>
template <class Note>
void BoxTree<Tag>::note(const Note& note, RunControl& control) {
  for_blocks(size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) note(entries_[slot].tag, std::span(number_).subspan(slot, 1));
  });
  for (int level = 0; level <= leaf_level_ && !nodes_.empty(); ++level) {
    const std::size_t nodes = std::size_t{1} << level;
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / size()), control, [&](std::size_t j, std::size_t last) {
      for (; j < last; ++j) {
        control.check();
        const std::size_t begin = node_begin(level, j), end = node_begin(level, j + 1);
        note(nodes_[node_index(level, j)].tag, std::span(number_).subspan(begin, end - begin));
      }
    });
  }
}

template <class Tag>
template <class Bound, class Visit>
void BoxTree<Tag>::search(const double& best, const Bound& bound, const Visit& visit) const {
  if (nodes_.empty()) return;
  struct Waiting {
    double bound;
    std::size_t node;
  };
  // Depth first, the better child first: at most one waiting sibling a level.
  std::array<Waiting, kMaxLevels> stack;
  std::size_t depth = 0;
  const std::size_t first_leaf = node_index(leaf_level_, 0);
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
      for (std::size_t slot = node_begin(leaf_level_, j); slot < node_begin(leaf_level_, j + 1); ++slot)
        if (bound(entries_[slot]) < best) visit(slot);
    }
    if (depth == 0) return;
    here = stack[--depth];
  }
}

}  // namespace remesh
