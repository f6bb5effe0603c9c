#include "core/refinement/segments/segment_cuts.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/refinement/goals/face_budget.h"

namespace remesh {
namespace {

constexpr std::size_t kSegmentsPerBlock = 1024;

/// Counts the patches beside a segment. Sides of one patch are neighbours in the list.
std::size_t count_patches(std::span<const SegmentSide> sides) {
  std::size_t patches = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) patches += i == 0 || sides[i].patch != sides[i - 1].patch ? 1 : 0;
  return patches;
}

}  // namespace

void SegmentCuts::begin(const SizeField& sizes, std::uint64_t max_triangles, std::uint64_t max_made) {
  messages_.clear();
  cuts_.assign(segments_.size(), {});
  const std::uint64_t max_kept = std::min(max_triangles, max_made);
  // With one cut more than this, there are too many in any case.
  const std::uint64_t max_cuts = max_kept == kNoFaceLimit ? kNoFaceLimit : max_kept + 1;
  std::atomic<std::uint64_t> of_sides = 0, of_messages = 0;
  IdVector<SegmentId, std::uint32_t> counts(segments_.size());
  for_blocks(segments_.size(), kSegmentsPerBlock, control_, [&](std::size_t from, std::size_t to) {
    for (SegmentId s(from); s.value < to; ++s.value) {
      control_.check();
      std::vector<double> cuts = segments_.size_cuts(s, sizes, max_cuts);
      counts[s] = static_cast<std::uint32_t>(cuts.size());
      of_sides += cuts.size() * segments_.sides(s).size();
      // Once there are too many cuts, they are only counted. Which of them are stored by then depends on the threads.
      if ((of_messages += cuts.size() * count_patches(segments_.sides(s))) <= max_kept) cuts_[s] = std::move(cuts);
    }
  });
  if (of_sides > max_triangles)
    thin_out(sizes, max_cuts, counts, static_cast<double>(max_triangles) / 2 / static_cast<double>(of_sides));
  StopCheck check(control_);
  for (const SegmentSide& side : segments_.all_sides()) {
    check();
    if (counts[side.segment] > 0) messages_.push_back({side.patch, side.segment, counts[side.segment]});
  }
  sort_messages();
}

/// Keeps this share of the pieces of each segment. The other half of the triangles is for refinement inside patches.
void SegmentCuts::thin_out(const SizeField& sizes, std::uint64_t max_cuts, IdVector<SegmentId, std::uint32_t>& counts,
                           double share) {
  for_blocks(segments_.size(), kSegmentsPerBlock, control_, [&](std::size_t from, std::size_t to) {
    for (SegmentId s(from); s.value < to; ++s.value) {
      control_.check();
      const std::size_t pieces = std::size_t{counts[s]} + 1;
      const auto left = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(pieces)));
      counts[s] = static_cast<std::uint32_t>(left - 1);
      std::vector<double> all = std::exchange(cuts_[s], {});
      if (left == 1) continue;
      if (all.empty()) all = segments_.size_cuts(s, sizes, max_cuts);
      // There are never more cuts than before.
      cuts_[s].reserve(left - 1);
      for (std::size_t i = 1; i < left; ++i) cuts_[s].push_back(all[i * pieces / left - 1]);
    }
  });
}

void SegmentCuts::exchange(std::vector<FreshCut> fresh) {
  sort_stoppable(fresh.begin(), fresh.end(), control_);
  messages_.clear();
  StopCheck check(control_);
  for (auto from = fresh.begin(); from != fresh.end();) {
    check();
    const SegmentId s = from->cut.segment;
    const auto first = from;
    auto to = from;
    std::vector<double>& cuts = cuts_[s];
    const std::size_t old = cuts.size();
    for (; to != fresh.end() && to->cut.segment == s; ++to)
      if (to == first || to->cut.t != (to - 1)->cut.t) cuts.push_back(to->cut.t);
    const std::uint64_t count = cuts.size() - old;
    std::inplace_merge(cuts.begin(), cuts.begin() + static_cast<std::ptrdiff_t>(old), cuts.end());
    send_to_others(s, {first, to}, count);
    from = to;
  }
  sort_messages();
}

/// Sends to the patches beside a segment the cuts that they have not made themselves. `count` is the number of
/// different cuts in `fresh`.
void SegmentCuts::send_to_others(SegmentId s, std::span<const FreshCut> fresh, std::uint64_t count) {
  const auto sides = segments_.sides(s);
  // If only one patch has the segment, no other patch needs a message.
  if (sides.front().patch == sides.back().patch) return;
  for (const SegmentSide& side : sides) {
    const auto own = static_cast<std::uint64_t>(
        std::count_if(fresh.begin(), fresh.end(), [&](const FreshCut& c) { return c.by == side.patch; }));
    if (own < count) messages_.push_back({side.patch, s, count - own});
  }
}

void SegmentCuts::sort_messages() { sort_unique(messages_, control_); }

std::span<const SegmentCuts::Message> SegmentCuts::messages_for(PatchId patch) const {
  const auto first = std::lower_bound(messages_.begin(), messages_.end(), patch,
                                      [](const Message& m, PatchId p) { return m.patch < p; });
  auto last = first;
  while (last != messages_.end() && last->patch == patch) ++last;
  return {first, last};
}

}  // namespace remesh
