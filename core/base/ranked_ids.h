/// A small set of ids in ascending order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/stoppable.h"

namespace remesh {

/// Different ids in ascending order, and the rank of each among them. The memory is reused from one set to the next.
template <class I>
class RankedIds {
 public:
  /// Replaces the set. `ids` may be in any order and may repeat.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n) if about one in eight ids between the smallest and the largest is there or more, O(n log n)
  ///         otherwise.
  void assign(std::span<const I> ids, const RunControl& control) {
    ids_.clear();
    ranks_.clear();
    if (ids.empty()) return;
    const auto [low, high] = std::minmax_element(ids.begin(), ids.end());
    first_ = low->value;
    const std::size_t range = std::size_t{high->value} - first_ + 1;
    if (range / kSparse <= ids.size()) {
      ranks_.assign(range, 0);
      for (const I id : ids) ranks_[id.value - first_] = 1;
      for (std::size_t i = 0; i < range; ++i) {
        if (ranks_[i] == 0) continue;
        ranks_[i] = static_cast<std::uint32_t>(ids_.size());
        ids_.push_back(I(first_ + i));
      }
      return;
    }
    ids_.assign(ids.begin(), ids.end());
    sort_unique(ids_, control);
  }

  std::span<const I> ids() const { return ids_; }
  std::size_t size() const { return ids_.size(); }
  I operator[](std::size_t rank) const { return ids_[rank]; }
  /// The rank of one of the ids.
  /// Input: `id` is in the set.
  std::uint32_t rank(I id) const {
    if (!ranks_.empty()) return ranks_[id.value - first_];
    return static_cast<std::uint32_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }

 private:
  /// If fewer than one in this many ids of the range are in the set, ranks are not stored for the whole range.
  static constexpr std::size_t kSparse = 8;

  std::vector<I> ids_;
  std::vector<std::uint32_t> ranks_;  ///< by id less `first_`; empty if the ids are sparse
  std::uint32_t first_ = 0;
};

}  // namespace remesh
