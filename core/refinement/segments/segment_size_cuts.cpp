/// Cuts a segment for its size, before any other cut.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/refinement/segments/segment_table.h"

namespace remesh {
namespace {

/// A relative slack for rounding, so that a length of ten sizes makes ten parts whatever its last digits are.
constexpr double kCutSlack = 1e-12;

double last_of(std::span<const double> rings) { return rings.empty() ? 0 : rings.back(); }

double last_piece_of(std::span<const double> rings) {
  return last_of(rings) - (rings.size() < 2 ? 0 : rings[rings.size() - 2]);
}

/// The way along a part of a segment, counted in sizes. Each step is about half as long as the last size, but not
/// shorter than `shortest`.
class WayInSizes {
 public:
  /// Input: `length` is that of the whole segment, and `size_at(t)` the size at the parameter t. The shortest step is
  ///        given as a part of the segment.
  template <class SizeAt>
  WayInSizes(double first, double last, double length, double shortest_step, const SizeAt& size_at)
      : steps_{{first, 0}} {
    double size = size_at(first);
    while (steps_.back().first < last) {
      const auto [t, count] = steps_.back();
      double next = t + std::max(size / 2 / length, shortest_step);
      if (!(next < last - 1e-9)) next = last;
      size = size_at(t + (next - t) / 2);
      steps_.emplace_back(next, count + (next - t) * length / size);
    }
  }

  double sizes() const { return steps_.back().second; }
  /// Returns the parameter up to which the way has this number of sizes. The number must not be smaller than in the
  /// last call.
  double after(double sizes) {
    while (steps_[k_].second < sizes) ++k_;
    const auto [t, count] = steps_[k_ - 1];
    return t + (sizes - count) / (steps_[k_].second - count) * (steps_[k_].first - t);
  }
  void begin_again() { k_ = 1; }

 private:
  std::vector<std::pair<double, double>> steps_;  ///< the parameter and the number of sizes so far
  std::size_t k_ = 1;
};

}  // namespace

std::vector<double> SegmentTable::size_cuts(SegmentId id, const SizeField& sizes, std::uint64_t max_cuts) const {
  const BoundarySegment& s = segments_[id];
  std::vector<double> cuts;
  if (const auto known = column_cuts_.find(id); known != column_cuts_.end() && !s.is_locked()) return known->second;
  if (s.is_locked() || (sizes.is_uniform() && !std::isfinite(sizes.largest()))) return cuts;
  const auto at_from = corner_rings_.at({id, true}), at_to = corner_rings_.at({id, false});
  if (!at_from.empty() || !at_to.empty()) {
    cut_evenly(id, 0, 1, sizes, max_cuts, cuts);
    if (!cuts.empty()) cut_at_corners(id, at_from, at_to, sizes, max_cuts, cuts);
  } else if (s.parts.count > 1) {
    cut_between_parts(id, sizes, max_cuts, cuts);
  } else {
    cut_evenly(id, 0, 1, sizes, max_cuts, cuts);
  }
  return cuts;
}

/// Cuts a segment on the rings of the sharp corners at its ends, and evenly between these.
void SegmentTable::cut_at_corners(SegmentId id, std::span<const double> at_from, std::span<const double> at_to,
                                  const SizeField& sizes, std::uint64_t max_cuts, std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  // If the rings of both ends meet, half a piece must fit between them.
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
  cut_evenly(id, from / s.length, 1 - to / s.length, sizes, max_cuts, cuts);
  cuts.insert(cuts.end(), behind.rbegin(), behind.rend());
}

/// Cuts a segment between its equal parts, and then by halves until no piece is longer than the size in its middle.
void SegmentTable::cut_between_parts(SegmentId id, const SizeField& sizes, std::uint64_t max_cuts,
                                     std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  // Longer pieces come first, so that the remaining pieces have about equal lengths.
  std::vector<std::array<double, 2>> pieces{{0, 1}};
  for (std::size_t i = 0; i < pieces.size() && cuts.size() < max_cuts; ++i) {
    const auto [t0, t1] = pieces[i];
    if ((t1 - t0) * s.length * (1 - kCutSlack) <= sizes.at(position(id, t0 + (t1 - t0) / 2))) continue;
    const double t = s.parts.cut(t0, t1);
    if (min_edge_length_ > 0 && std::min(t - t0, t1 - t) * s.length < s.floor) continue;
    cuts.push_back(t);
    pieces.push_back({t0, t});
    pieces.push_back({t, t1});
  }
  std::sort(cuts.begin(), cuts.end());
}

/// Cuts the piece [first, last] into the min number of parts that are no longer than the size at their place. The parts
/// are equal where the size is. If some part would be shorter than the shortest edge, there is one part less. There are
/// at most max_cuts + 1 parts.
void SegmentTable::cut_evenly(SegmentId id, double first, double last, const SizeField& sizes, std::uint64_t max_cuts,
                              std::vector<double>& cuts) const {
  const BoundarySegment& s = segments_[id];
  const double shortest = min_edge_length_ > 0 ? s.floor : 0;
  const double max_parts = static_cast<double>(max_cuts) + 1, shortest_step = (last - first) / (2 * max_parts);
  std::optional<WayInSizes> way;
  if (!sizes.is_uniform())
    way.emplace(first, last, s.length, shortest_step,
                [&](double t) { return std::max(shortest, sizes.at(position(id, t))); });
  const double all = way ? way->sizes() : std::max(0.0, last - first) * s.length / std::max(shortest, sizes.largest());
  const std::size_t before = cuts.size();
  const auto cut_into = [&](double parts) {
    cuts.resize(before);
    if (way) way->begin_again();
    for (std::uint64_t i = 1; i < static_cast<std::uint64_t>(parts); ++i) {
      const auto end = static_cast<double>(i);
      cuts.push_back(way ? way->after(all * end / parts) : first + (last - first) * (end / parts));
    }
  };
  const auto is_any_short = [&] {
    double from = first;
    for (std::size_t i = before; i <= cuts.size(); ++i) {
      const double to = i < cuts.size() ? cuts[i] : last;
      if ((to - from) * s.length < shortest * (1 - kCutSlack)) return true;
      from = to;
    }
    return false;
  };
  cut_into(std::min(std::ceil(all * (1 - kCutSlack)), max_parts));
  // With one part less, every part is at least as long as the size, so none is too short.
  if (shortest > 0 && is_any_short()) cut_into(std::min(std::floor(all * (1 + kCutSlack)), max_parts));
}

}  // namespace remesh
