/// Disjoint sets of the numbers 0 .. n-1.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/parallel.h"

namespace remesh {

/// The representative of a set is its smallest member, so it does not depend on the order of the joins. Several threads
/// may call `find` and `join` at once. A result of `find` is final only when all joins are over.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n = 0) : parent_(n) {
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    const auto set = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) parent_[i] = static_cast<std::uint32_t>(i);
    };
    if (n <= kBlock)
      set(0, n);
    else
      for_all(0, (n + kBlock - 1) / kBlock,
              [&](std::size_t block) { set(block * kBlock, std::min(n, (block + 1) * kBlock)); });
  }

  std::uint32_t find(std::uint32_t i) {
    while (true) {
      const std::uint32_t parent = at(i).load(std::memory_order_relaxed);
      if (parent == i) return i;
      // This halves the path to the root. If another thread writes this entry at the same time, it also writes an
      // ancestor.
      const std::uint32_t above = at(parent).load(std::memory_order_relaxed);
      if (above != parent) at(i).store(above, std::memory_order_relaxed);
      i = above;
    }
  }
  /// Makes i point at its representative. All joins must be over. Several threads may call this, each for members of
  /// its own. Each call writes only its own member, so no other call can set it back to a mere ancestor.
  void flatten(std::uint32_t i) {
    std::uint32_t root = i;
    for (std::uint32_t above = at(i).load(std::memory_order_relaxed); above != root;) {
      root = above;
      above = at(root).load(std::memory_order_relaxed);
    }
    at(i).store(root, std::memory_order_relaxed);
  }
  /// The representative of i, after flatten() was called for every member.
  std::uint32_t root_of(std::uint32_t i) const { return parent_[i]; }
  /// Joins two sets, and returns whether they were apart. If k sets are left of n, it has returned true n - k times.
  bool join(std::uint32_t i, std::uint32_t j) {
    // Most pairs of neighbours have the same parent already, once some are joined.
    if (at(i).load(std::memory_order_relaxed) == at(j).load(std::memory_order_relaxed)) return false;
    while (true) {
      i = find(i);
      j = find(j);
      if (i == j) return false;
      if (i > j) std::swap(i, j);
      std::uint32_t root = j;  // expected value: j is still a root
      if (at(j).compare_exchange_strong(root, i, std::memory_order_relaxed)) return true;
    }
  }

 private:
  std::atomic_ref<std::uint32_t> at(std::uint32_t i) { return std::atomic_ref(parent_[i]); }

  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> parent_;
};

}  // namespace remesh
