/// Cuts a segment for its size, before anything else.

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/refinement/segment_table.h"

namespace remesh {
namespace {

/// This is a relative slack for rounding, so that a length of ten sizes makes ten parts whatever its last digits are.
constexpr double kRelativeSlack = 1e-12;

double last_of(std::span<const double> shells) { return shells.empty() ? 0 : shells.back(); }

double last_piece_of(std::span<const double> shells) {
  return last_of(shells) - (shells.size() < 2 ? 0 : shells[shells.size() - 2]);
}

}  // namespace

std::vector<double> SegmentTable::size_cuts(SegmentId id, const SizeField& sizes) const {
  const BoundarySegment& s = segments_[id];
  std::vector<double> cuts;
  if (const auto known = column_cuts_.find(id); known != column_cuts_.end() && !s.is_locked()) return known->second;
  if (s.is_locked() || (sizes.is_uniform() && !std::isfinite(sizes.largest()))) return cuts;
  const auto at_from = corner_shells_.at({id, true}), at_to = corner_shells_.at({id, false});
  if (!at_from.empty() || !at_to.empty()) {
    cut_evenly(id, 0, 1, sizes, cuts);
    if (!cuts.empty()) cut_at_corners(id, at_from, at_to, sizes, cuts);
  } else if (s.parts.count > 1) {
    cut_between_parts(id, sizes, cuts);
  } else {
    cut_evenly(id, 0, 1, sizes, cuts);
  }
  return cuts;
}

/// Cuts a segment on the shells of the sharp corners at its ends, and evenly between these.
void SegmentTable::cut_at_corners(SegmentId id, std::span<const double> at_from, std::span<const double> at_to,
                                  const SizeField& sizes, std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  // Where the shells of both ends meet, there is room for half a piece between them.
  while (last_of(at_from) + last_of(at_to) > s.length - (last_piece_of(at_from) + last_piece_of(at_to)) / 4) {
    auto& farther = last_of(at_from) >= last_of(at_to) ? at_from : at_to;
    farther = farther.first(farther.size() - 1);
  }
  cuts.clear();
  const double shortest = min_edge_length_ > 0 ? s.floor : 0;
  double from = 0, to = 0;
  for (const double d : at_from) {
    if (std::min(d - from, s.length - d) < shortest) continue;
    cuts.push_back(d / s.length);
    from = d;
  }
  std::vector<double> behind;
  for (const double d : at_to) {
    if (std::min(d - to, s.length - from - d) < shortest) continue;
    behind.push_back(1 - d / s.length);
    to = d;
  }
  cut_evenly(id, from / s.length, 1 - to / s.length, sizes, cuts);
  cuts.insert(cuts.end(), behind.rbegin(), behind.rend());
}

/// Cuts a segment between its equal parts, and then by halves until no piece is longer than the size in its middle.
void SegmentTable::cut_between_parts(SegmentId id, const SizeField& sizes, std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  std::vector<std::array<double, 2>> pieces{{0, 1}};
  while (!pieces.empty()) {
    const auto [t0, t1] = pieces.back();
    pieces.pop_back();
    if ((t1 - t0) * s.length * (1 - kRelativeSlack) <= sizes.at(position(id, t0 + (t1 - t0) / 2))) continue;
    const double t = s.parts.cut(t0, t1);
    if (min_edge_length_ > 0 && std::min(t - t0, t1 - t) * s.length < s.floor) continue;
    cuts.push_back(t);
    pieces.push_back({t0, t});
    pieces.push_back({t, t1});
  }
  std::sort(cuts.begin(), cuts.end());
}

/// Cuts the piece [first, last] into the fewest parts that are no longer than the size there. The parts are equal where
/// the size is. If some would be shorter than the shortest edge, there is one part less.
void SegmentTable::cut_evenly(SegmentId id, double first, double last, const SizeField& sizes,
                              std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  const double shortest = min_edge_length_ > 0 ? s.floor : 0;
  const auto size_at = [&](double t) {
    return std::max(shortest, sizes.is_uniform() ? sizes.largest() : sizes.at(position(id, t)));
  };
  // This is the way along the segment, counted in sizes. Each step is about half as long as the last size.
  std::vector<std::pair<double, double>> way{{first, 0}};  // pairs of the parameter and the number of sizes so far
  double size = size_at(first);
  while (way.back().first < last) {
    const auto [t, count] = way.back();
    double next = sizes.is_uniform() ? last : t + size / 2 / s.length;
    if (!(next < last - 1e-9)) next = last;
    if (!sizes.is_uniform()) size = size_at(t + (next - t) / 2);
    way.emplace_back(next, count + (next - t) * s.length / size);
  }
  const double all = way.back().second;
  const std::size_t before = cuts.size();
  const auto cut_into = [&](double parts) {
    cuts.resize(before);
    std::size_t k = 1;
    for (std::uint64_t i = 1; i < static_cast<std::uint64_t>(parts); ++i) {
      const auto end = static_cast<double>(i);
      if (sizes.is_uniform()) {
        cuts.push_back(first + (last - first) * (end / parts));
        continue;
      }
      const double wanted = all * end / parts;
      while (way[k].second < wanted) ++k;
      const double part = (wanted - way[k - 1].second) / (way[k].second - way[k - 1].second);
      cuts.push_back(way[k - 1].first + part * (way[k].first - way[k - 1].first));
    }
  };
  const auto is_any_short = [&] {
    double from = first;
    for (std::size_t i = before; i <= cuts.size(); ++i) {
      const double to = i < cuts.size() ? cuts[i] : last;
      if ((to - from) * s.length < shortest * (1 - kRelativeSlack)) return true;
      from = to;
    }
    return false;
  };
  cut_into(std::ceil(all * (1 - kRelativeSlack)));
  // With one part less, every part is at least as long as the size, so none is too short.
  if (shortest > 0 && is_any_short()) cut_into(std::floor(all * (1 + kRelativeSlack)));
}

}  // namespace remesh
