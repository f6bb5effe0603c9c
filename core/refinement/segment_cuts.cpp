#include "core/refinement/segment_cuts.h"

#include <algorithm>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/refinement/face_budget.h"

namespace remesh {
namespace {

constexpr std::size_t kSegmentsPerTask = 1024;

}  // namespace

void SegmentCuts::begin(const SizeField& sizes, std::uint64_t max_triangles) {
  messages_.clear();
  cuts_.assign(segments_.size(), {});
  for_blocks(segments_.size(), kSegmentsPerTask, control_, [&](std::size_t from, std::size_t to) {
    for (std::size_t s = from; s < to; ++s) {
      control_.check();
      cuts_[SegmentId(s)] = segments_.size_cuts(SegmentId(s), sizes);
    }
  });
  thin_out(max_triangles);
  StopCheck check(control_);
  for (const SegmentSide& side : segments_.all_sides()) {
    check();
    if (!cuts_[side.segment].empty()) messages_.push_back({side.patch, side.segment, cuts_[side.segment].size()});
  }
  sort_messages();
}

void SegmentCuts::thin_out(std::uint64_t max_triangles) {
  if (max_triangles == kNoFaceLimit) return;
  std::uint64_t count = 0;
  StopCheck check(control_);
  for (const SegmentSide& side : segments_.all_sides()) {
    check();
    count += cuts_[side.segment].size();
  }
  if (count <= max_triangles) return;
  // The other half of the triangles is for what patches do inside.
  const double share = static_cast<double>(max_triangles) / 2 / static_cast<double>(count);
  for (std::vector<double>& cuts : cuts_) {
    check();
    const std::size_t pieces = cuts.size() + 1;
    const auto left = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(pieces)));
    // There are never more cuts than before. Each is taken as much later than the one before it.
    for (std::size_t i = 1; i < left; ++i) {
      check();
      cuts[i - 1] = cuts[i * pieces / left - 1];
    }
    cuts.resize(left - 1);
  }
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

/// Tells the patches beside a segment of the cuts that they have not made themselves. `count` is the number of
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

void SegmentCuts::sort_messages() {
  sort_stoppable(messages_.begin(), messages_.end(), control_);
  messages_.erase(std::unique(messages_.begin(), messages_.end()), messages_.end());
}

std::span<const SegmentCuts::Message> SegmentCuts::messages_for(PatchId patch) const {
  const auto first = std::lower_bound(messages_.begin(), messages_.end(), patch,
                                      [](const Message& m, PatchId p) { return m.patch < p; });
  auto last = first;
  while (last != messages_.end() && last->patch == patch) ++last;
  return {first, last};
}

}  // namespace remesh
