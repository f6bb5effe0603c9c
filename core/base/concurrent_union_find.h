/// Disjoint sets of 0 .. n-1 that several threads join at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace remesh {

/// The representative of a set is its smallest member. What the sets are once all joins have ended does not depend on
/// the order of the joins, nor on who made them.
/// Source: Anderson, Woll: Wait-free parallel algorithms for the union-find problem, 1991; roots are linked by number.
class ConcurrentUnionFind {
 public:
  explicit ConcurrentUnionFind(std::size_t n) : step_up_(n) {}

  /// Any number of threads at once.
  void join(std::uint32_t i, std::uint32_t j) {
    if (parent(i) == parent(j)) return;  // as most often, after a while
    while (true) {
      i = find(i);
      j = find(j);
      if (i == j) return;
      if (i > j) std::swap(i, j);
      // Another thread may have found j a parent meanwhile.
      std::uint32_t none = 0;
      if (step_up_[j].compare_exchange_strong(none, j - i, std::memory_order_relaxed)) return;
    }
  }

  /// Is it the smallest of its set?
  bool is_root(std::uint32_t i) const { return step_up_[i].load(std::memory_order_relaxed) == 0; }

 private:
  std::uint32_t parent(std::uint32_t i) const { return i - step_up_[i].load(std::memory_order_relaxed); }

  std::uint32_t find(std::uint32_t i) {
    for (std::uint32_t up = parent(i); up != i; up = parent(i)) {
      // Halves the path. Whatever others write there meanwhile is an ancestor, too.
      const std::uint32_t over = parent(up);
      if (over != up) step_up_[i].store(i - over, std::memory_order_relaxed);
      i = over;
    }
    return i;
  }

  /// How far below i its parent is; a root's is 0. So the sets of one need no setting up but zeros.
  std::vector<std::atomic<std::uint32_t>> step_up_;
};

}  // namespace remesh
