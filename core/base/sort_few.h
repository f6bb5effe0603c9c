/// Sorts integers that are few in most cases.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stoppable.h"

namespace remesh {

/// Writes `keys`, which are all different, to `sorted` in ascending order. If there are few keys, the place of each is
/// the number of smaller keys; counting these needs no branch that the processor would predict badly. A vertex where
/// very many faces meet may have millions of keys; these are sorted.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
inline void sort_few(std::span<const std::uint64_t> keys, std::span<std::uint64_t> sorted, const RunControl& control) {
  constexpr std::size_t kFew = 16, kMany = 1 << 13;
  if (keys.size() > kFew) {
    std::copy(keys.begin(), keys.end(), sorted.begin());
    if (keys.size() > kMany) return sort_stoppable(sorted.begin(), sorted.end(), control);
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
