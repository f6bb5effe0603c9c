#include "core/mesh/equal_places.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {

bool find_equal_by_hash(std::span<const Vec3> positions, std::span<const std::uint8_t> is_used,
                        std::span<std::uint32_t> first, RunControl& control) {
  constexpr std::uint64_t kFree = 0xffffffffffffffffu;
  constexpr std::size_t kMaxLooks = 16;  // per vertex, on average
  // Adding 0 turns -0 into 0, because both are equal.
  const auto hash = [](const Vec3& p) {
    std::uint64_t h = 0;
    for (const double c : {p.x, p.y, p.z}) {
      h = (h ^ std::bit_cast<std::uint64_t>(c + 0.0)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
    return h;
  };
  // All threads fill one table. An entry is a vertex and the upper half of its hash, which distinguishes it from most
  // other vertices; comparing coordinates would read memory far away. The slot that a place gets depends on the
  // threads. But the slot always ends up with the first vertex at the place.
  std::vector<std::uint64_t, DefaultInit<std::uint64_t>> table(std::bit_ceil(2 * positions.size() + 1));
  for_blocks(table.size(), kItemsPerBlock, control,
             [&](std::size_t begin, std::size_t end) { std::fill_n(&table[begin], end - begin, kFree); });
  const std::size_t mask = table.size() - 1;
  std::atomic<bool> is_colliding = false;
  constexpr int kHalf = 32;
  const auto enter = [&](std::uint32_t i, std::uint64_t of_place, std::size_t& looks) {
    const Vec3 p = positions[i];
    const std::uint64_t own = of_place >> kHalf << kHalf | i;
    for (std::size_t slot = of_place & mask;; slot = (slot + 1) & mask, ++looks) {
      const std::atomic_ref entry(table[slot]);
      std::uint64_t other = entry.load(std::memory_order_relaxed);
      if (other == kFree && entry.compare_exchange_strong(other, own, std::memory_order_relaxed)) return slot;
      if ((other ^ own) >> kHalf != 0 || positions[static_cast<std::uint32_t>(other)] != p) continue;
      while (own < other && !entry.compare_exchange_weak(other, own, std::memory_order_relaxed)) continue;
      return slot;
    }
  };
  for_blocks(positions.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    std::size_t looks = 0;
    // Several vertices are handled at once, because the table is large, and it takes time until a slot arrives from
    // memory.
    std::array<std::uint64_t, 16> hashes;
    for (std::size_t i = begin; i < end && !is_colliding; begin = i) {
      const std::size_t stop = std::min(end, begin + hashes.size());
      for (std::size_t k = begin; k < stop; ++k) {
        hashes[k - begin] = hash(positions[k]);
        __builtin_prefetch(&table[hashes[k - begin] & mask], 1);
      }
      for (; i < stop; ++i)
        if (is_used.empty() || is_used[i] != 0)
          first[i] = static_cast<std::uint32_t>(enter(static_cast<std::uint32_t>(i), hashes[i - begin], looks));
      if (looks > kMaxLooks * kItemsPerBlock) is_colliding = true;
    }
  });
  if (is_colliding) return false;
  for_blocks(positions.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (is_used.empty() || is_used[i] != 0) first[i] = static_cast<std::uint32_t>(table[first[i]]);
  });
  return true;
}

std::vector<IndexedPlace> find_equal_by_sort(std::span<const Vec3> positions, std::span<const std::uint8_t> is_used,
                                             std::span<std::uint32_t> first, RunControl& control) {
  std::vector<IndexedPlace> sorted;
  sorted.reserve(positions.size());
  StopCheck check(control);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    check();
    if (is_used.empty() || is_used[i] != 0) sorted.push_back({positions[i], i});
  }
  sort_stoppable(sorted.begin(), sorted.end(), control);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    check();
    const bool is_first = k == 0 || sorted[k].position != sorted[k - 1].position;
    first[sorted[k].index] = is_first ? sorted[k].index : first[sorted[k - 1].index];
  }
  return sorted;
}

}  // namespace remesh
