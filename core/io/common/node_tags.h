/// Finds what has a number of its own in a file.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/stoppable.h"

namespace remesh {

/// Finds nodes or elements by their tags. They are numbered in the order in which they were added.
class NodeTags {
 public:
  void add(std::uint64_t tag) {
    are_in_order_ = are_in_order_ && tag == tags_.size() + 1;
    if (!are_in_order_ && sorted_.empty())
      for (std::size_t i = 0; i < tags_.size(); ++i) sorted_.push_back({tags_[i], static_cast<std::uint32_t>(i)});
    tags_.push_back(tag);
    if (!are_in_order_) sorted_.push_back({tag, static_cast<std::uint32_t>(tags_.size() - 1)});
  }
  /// Must be called before find.
  /// Output: a tag that two of them have, if there is one.
  std::optional<std::uint64_t> sort(RunControl& control) {
    sort_stoppable(sorted_.begin(), sorted_.end(), control);
    const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end(),
                                          [](const auto& a, const auto& b) { return a.first == b.first; });
    return twice == sorted_.end() ? std::nullopt : std::optional(twice->first);
  }
  /// Output: its number, or -1 if none has the tag.
  std::int64_t find(std::uint64_t tag) const {
    if (are_in_order_) return tag >= 1 && tag <= tags_.size() ? static_cast<std::int64_t>(tag - 1) : -1;
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(tag, std::uint32_t{0}));
    return found == sorted_.end() || found->first != tag ? -1 : std::int64_t{found->second};
  }

  /// The numbers of those whose tags are in a range, by the tags: the first one of it, or of what follows it.
  std::size_t lower_bound(std::uint64_t tag) const {
    if (are_in_order_) return std::min<std::size_t>(std::max<std::uint64_t>(tag, 1) - 1, tags_.size());
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(tag, std::uint32_t{0}));
    return static_cast<std::size_t>(found - sorted_.begin());
  }
  /// The tag and the number of the one at a place in the order of tags.
  std::pair<std::uint64_t, std::uint32_t> at(std::size_t place) const {
    return are_in_order_ ? std::pair(tags_[place], static_cast<std::uint32_t>(place)) : sorted_[place];
  }
  std::size_t size() const { return tags_.size(); }

 private:
  std::vector<std::uint64_t> tags_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_;  ///< empty as long as the tags are 1, 2, 3, ...
  bool are_in_order_ = true;
};

}  // namespace remesh
