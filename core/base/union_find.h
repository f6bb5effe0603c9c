/// Disjoint sets of 0 .. n-1.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace remesh {

/// The representative of a set is its smallest member, so it does not depend on the order of the joins.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Returns whether the two were apart.
  bool join(std::uint32_t i, std::uint32_t j) {
    i = find(i);
    j = find(j);
    if (i > j) std::swap(i, j);
    parent_[j] = i;
    return i != j;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace remesh
