/// This file has the members of PatchRefiner for pieces of the boundary. They cut the patch's own pieces, take over the
/// cuts of other patches, and tell why some pieces are not cut.

#include <algorithm>
#include <array>

#include "core/refinement/patch_refiner.h"

namespace remesh {

void PatchRefiner::clear_circle(std::uint32_t side) {
  while (true) {
    const std::uint32_t h = mesh_.half_edge_of_side(side);
    const std::uint32_t v = mesh_.apex(h);
    if (!is_free(v)) return;
    const Vec2 p = mesh_.point(v);
    if (!(dot(mesh_.point(mesh_.from(h)) - p, mesh_.point(mesh_.to(h)) - p) < 0)) return;
    mesh_.remove(v);
    classify_changed();
  }
}

bool PatchRefiner::cut_side(std::uint32_t side) {
  const Side s = sides_[side];
  const std::optional<double> t = segments_.cut(segment_of(s), s.t0, s.t1);
  if (!t || !cut_side_at(side, *t)) return false;
  own_cuts_.push_back({segment_of(s), *t});
  quota_ -= std::min(quota_, cost_of_cut(segment_of(s)));
  return true;
}

bool PatchRefiner::cut_side_at(std::uint32_t side, double t) {
  const SegmentId segment = segment_of_side(side);
  const std::uint32_t partner = sides_[side].partner;
  const Vec2 p = chart_.to_plane(segments_.position(segment, t));
  const std::uint32_t v = cut_one(side, t, p, kNone);
  if (v == kNone) return false;
  const auto fresh = static_cast<std::uint32_t>(sides_.size() - 1);
  add_to_chain(fresh);
  if (partner == kNone) return true;
  // This is a slit. Each side keeps the piece at its own start, so the pairs cross over.
  if (cut_one(partner, t, p, v) == kNone) return false;
  sides_[side].partner = fresh + 1;
  sides_[fresh + 1].partner = side;
  sides_[fresh].partner = partner;
  sides_[partner].partner = fresh;
  return true;
}

std::uint32_t PatchRefiner::cut_one(std::uint32_t side, double t, Vec2 p, std::uint32_t vertex) {
  const SegmentId segment = segment_of_side(side);
  clear_circle(side);
  const std::uint32_t v = mesh_.cut(side, p, vertex);
  if (v == kNone) {
    impossible_ = segment;
    return kNone;
  }
  set_vertex(v, segment, t);
  Side& first = sides_[side];
  Side second = first;
  (first.is_forward ? first.t1 : first.t0) = t;
  (first.is_forward ? second.t0 : second.t1) = t;
  sides_.push_back(second);
  classify_changed();
  return v;
}

void PatchRefiner::take_over(SegmentId segment, std::span<const double> cuts) {
  const auto chain = std::lower_bound(chains_.begin(), chains_.end(), segment,
                                      [](const Chain& c, SegmentId s) { return c.segment < s; });
  at_->pieces.clear();
  for (std::uint32_t s = chain->first; s != kNone; s = sides_[s].next) at_->pieces.push_back(s);
  std::sort(at_->pieces.begin(), at_->pieces.end(),
            [&](std::uint32_t a, std::uint32_t b) { return sides_[a].t0 < sides_[b].t0; });
  // For each piece, the cuts inside it are made by halves. The middle one is the first, so that no vertex gets all of
  // them as neighbours.
  at_->ranges.clear();
  for (const std::uint32_t piece : at_->pieces) {
    const auto first = std::upper_bound(cuts.begin(), cuts.end(), sides_[piece].t0);
    const auto last = std::lower_bound(first, cuts.end(), sides_[piece].t1);
    at_->ranges.push_back(
        {piece, static_cast<std::size_t>(first - cuts.begin()), static_cast<std::size_t>(last - cuts.begin())});
  }
  while (!at_->ranges.empty()) {
    const Workplace::Range range = at_->ranges.back();
    at_->ranges.pop_back();
    if (range.first == range.last) continue;
    const std::size_t middle = range.first + (range.last - range.first) / 2;
    const auto fresh = static_cast<std::uint32_t>(sides_.size());
    if (!cut_side_at(range.piece, cuts[middle])) return;
    const bool is_before = sides_[range.piece].t1 == cuts[middle];
    at_->ranges.push_back({is_before ? range.piece : fresh, range.first, middle});
    at_->ranges.push_back({is_before ? fresh : range.piece, middle + 1, range.last});
  }
}

bool PatchRefiner::is_any_locked(std::span<const std::uint32_t> sides) const {
  return std::any_of(sides.begin(), sides.end(), [&](auto s) { return segments_[segment_of_side(s)].is_locked(); });
}

/// Returns the reason why a locked side is not cut.
PatchRefiner::State PatchRefiner::why_locked(Lock lock) {
  switch (lock) {
    case Lock::kKept: return State::kLocked;
    case Lock::kAsked: return State::kMinEdge;
    case Lock::kNoRoom:
    case Lock::kNone: break;
  }
  return State::kSizeFloor;
}

/// Returns the stronger of two reasons, which is the one that would hold without the other. A boundary that must stay
/// does so whatever else holds. What rounding forbids is forbidden even if the shortest edge allows it.
PatchRefiner::State PatchRefiner::stronger(State a, State b) {
  const auto rank = [](State s) { return s == State::kLocked ? 2 : s == State::kSizeFloor ? 1 : 0; };
  return rank(b) > rank(a) ? b : a;
}

/// Returns the reason why none of these sides is cut. If none of them is locked, this is `otherwise`.
PatchRefiner::State PatchRefiner::why_uncut(std::span<const std::uint32_t> sides, State otherwise) const {
  std::optional<State> why;
  for (const std::uint32_t side : sides) {
    const Lock lock = segments_[segment_of_side(side)].lock;
    if (lock != Lock::kNone) why = why ? stronger(*why, why_locked(lock)) : why_locked(lock);
  }
  return why.value_or(otherwise);
}

}  // namespace remesh
