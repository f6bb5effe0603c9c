/// Sorting of few numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace remesh {

/// Writes numbers, all different, in ascending order. Of few, as most often, each goes behind as many as are smaller:
/// no branch on what nobody can foresee.
inline void put_in_order(std::span<const std::uint64_t> keys, std::span<std::uint64_t> sorted) {
  constexpr std::size_t kFew = 16;
  if (keys.size() > kFew) {
    std::copy(keys.begin(), keys.end(), sorted.begin());
    return std::sort(sorted.begin(), sorted.end());
  }
  std::array<std::uint32_t, kFew> rank;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::uint32_t before = 0;
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint32_t is_before = keys[j] < keys[i];
      before += is_before;
      rank[j] += 1 - is_before;
    }
    rank[i] = before;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) sorted[rank[i]] = keys[i];
}

}  // namespace remesh
