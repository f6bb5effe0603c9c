/// Finds vertices with equal coordinates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A place with its index. The order is that of places, and that of indices where places are equal.
struct IndexedPlace {
  Vec3 position;
  std::uint32_t index;

  friend bool operator<(const IndexedPlace& a, const IndexedPlace& b) {
    return a.position != b.position ? a.position < b.position : a.index < b.index;
  }
};

/// Writes to `first`, for each place that is used, the index of the first one that is equal, in parallel.
/// Input:  `is_used` - empty if all are used. `first` has an entry for each place; those of others stay as they are.
/// Output: false if that takes too long, because someone has chosen coordinates that collide. Then `first` is of no
///         use, and find_equal_by_sort takes a bounded time.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(places)
bool find_equal_by_hash(std::span<const Vec3> positions, std::span<const std::uint8_t> is_used,
                        std::span<std::uint32_t> first, RunControl& control);

/// Does the same by sorting.
/// Output: the places that are used, in order.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(n log n) for n places
std::vector<IndexedPlace> find_equal_by_sort(std::span<const Vec3> positions, std::span<const std::uint8_t> is_used,
                                             std::span<std::uint32_t> first, RunControl& control);

}  // namespace remesh
