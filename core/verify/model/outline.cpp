#include "core/verify/model/outline.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/base/blocks.h"

namespace remesh::verification {

OutlineMeasures measure_outline(std::span<const Vec3> loop, StopCheck& check) {
  OutlineMeasures out;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    check();
    const Vec3 a = loop[i] - loop[0], b = loop[i + 1 == loop.size() ? 0 : i + 1] - loop[0];
    out.twice_area += cross(a, b);
    out.magnitude += norm(a) * norm(b);
    out.length += norm(b - a);
  }
  return out;
}

bool is_flat(std::span<const Vec3> loop, const Vec3& normal, double tolerance, StopCheck& check) {
  return std::all_of(loop.begin(), loop.end(), [&](const Vec3& p) {
    check();
    return std::fabs(dot(p - loop[0], normal)) <= tolerance;
  });
}

void cut_spikes(std::vector<Vec3>& loop, double tolerance, StopCheck& check) {
  const auto is_tip = [&](const Vec3& before, const Vec3& tip, const Vec3& after) {
    const Vec3 a = before - tip, b = after - tip;
    const double to_a = norm(a), to_b = norm(b);
    if (std::min(to_a, to_b) <= tolerance) return true;
    return dot(a, b) > 0 && norm(cross(a, b)) <= tolerance * std::max(to_a, to_b);
  };
  std::size_t staying = 0;  // number of corners that stay so far, at the front of the loop
  for (std::size_t i = 0; i < loop.size(); ++i) {
    check();
    while (staying > 1 && is_tip(loop[staying - 2], loop[staying - 1], loop[i])) --staying;
    loop[staying++] = loop[i];
  }
  // The loop is closed, so spikes across its beginning are cut from both sides.
  std::size_t first = 0;
  for (bool is_cut = true; is_cut && staying - first > 2;) {
    check();
    is_cut = true;
    if (is_tip(loop[staying - 2], loop[staying - 1], loop[first]))
      --staying;
    else if (is_tip(loop[staying - 1], loop[first], loop[first + 1]))
      ++first;
    else
      is_cut = false;
  }
  loop.resize(staying);
  loop.erase(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(first));
}

SimpleOutline::SimpleOutline(std::vector<Vec3> loop, const Vec3& normal, double tolerance, const RunControl& control)
    : loop_(std::move(loop)), normal_(normal), tolerance_(tolerance) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Interval> along = intervals(axis, control);
    const std::uint64_t count = count_overlaps(along, control);
    if (axis > 0 && count >= pair_count_) continue;
    pair_count_ = count;
    sorted_ = std::move(along);
  }
}

std::vector<SimpleOutline::Interval> SimpleOutline::intervals(int axis, const RunControl& control) const {
  std::vector<Interval> result;
  result.reserve(loop_.size());
  StopCheck check(control);
  for (std::size_t i = 0; i < loop_.size(); ++i) {
    check();
    const auto [low, high] = std::minmax({loop_[i][axis], loop_[after(i)][axis]});
    // The interval includes all points within the tolerance of an edge, and the rounding of these points.
    result.push_back({low - tolerance_, high + tolerance_, static_cast<std::uint32_t>(i)});
  }
  sort_stoppable(result.begin(), result.end(), control,
                 [](const Interval& a, const Interval& b) { return a.low != b.low ? a.low < b.low : a.edge < b.edge; });
  return result;
}

std::uint64_t SimpleOutline::count_overlaps(const std::vector<Interval>& sorted, const RunControl& control) const {
  std::uint64_t count = 0;
  StopCheck check(control);
  for (auto i = sorted.begin(); i != sorted.end(); ++i) {
    check();
    const auto end = std::upper_bound(i + 1, sorted.end(), i->high,
                                      [](double high, const Interval& other) { return high < other.low; });
    count += static_cast<std::uint64_t>(end - i - 1);
  }
  return count;
}

bool SimpleOutline::are_boxes_apart(std::size_t i, std::size_t j) const {
  const Vec3 &a = loop_[i], &b = loop_[after(i)], &c = loop_[j], &d = loop_[after(j)];
  for (int axis = 0; axis < 3; ++axis) {
    if (std::min(a[axis], b[axis]) - tolerance_ > std::max(c[axis], d[axis]) + tolerance_) return true;
    if (std::min(c[axis], d[axis]) - tolerance_ > std::max(a[axis], b[axis]) + tolerance_) return true;
  }
  return false;
}

/// Output: positive to the left of edge i.
double SimpleOutline::side(std::size_t i, const Vec3& p) const {
  return dot(cross(loop_[after(i)] - loop_[i], p - loop_[i]), normal_);
}

double SimpleOutline::distance(std::size_t i, const Vec3& p) const {
  const Vec3 way = loop_[after(i)] - loop_[i];
  const double squared = norm_squared(way);
  const double share = squared > 0 ? std::clamp(dot(p - loop_[i], way) / squared, 0.0, 1.0) : 0;
  return norm(p - loop_[i] - share * way);
}

/// True if edge j is clearly on one side of the line of edge i. This test is faster than measuring distances.
bool SimpleOutline::is_beside(std::size_t i, std::size_t j) const {
  const double from = side(i, loop_[j]), to = side(i, loop_[after(j)]);
  const double nearer = std::min(std::fabs(from), std::fabs(to));
  return (from < 0) == (to < 0) && nearer * nearer > tolerance_ * tolerance_ * norm_squared(loop_[after(i)] - loop_[i]);
}

/// True if two edges cross, or the first corner of one is within the tolerance of the other. The second corner of an
/// edge is the first corner of the next edge.
bool SimpleOutline::do_meet(std::size_t i, std::size_t j) const {
  const auto are_apart = [](double a, double b) { return (a < 0) != (b < 0); };
  const bool is_next = j == after(i), is_before = i == after(j);
  if (!is_next && !(distance(i, loop_[j]) > tolerance_)) return true;
  if (!is_before && !(distance(j, loop_[i]) > tolerance_)) return true;
  return !is_next && !is_before && are_apart(side(i, loop_[j]), side(i, loop_[after(j)])) &&
         are_apart(side(j, loop_[i]), side(j, loop_[after(i)]));
}

bool SimpleOutline::is_simple(RunControl& control) const {
  constexpr std::size_t kEdgesPerBlock = 512;
  if (loop_.size() < 3) return false;
  std::atomic<bool> is_simple = true;
  for_blocks(sorted_.size(), kEdgesPerBlock, control, [&](std::size_t begin, std::size_t end) {
    StopCheck check(control);
    for (std::size_t k = begin; k < end && is_simple; ++k) {
      const std::size_t i = sorted_[k].edge;
      for (std::size_t m = k + 1; m < sorted_.size() && sorted_[m].low <= sorted_[k].high; ++m) {
        check();
        const std::size_t j = sorted_[m].edge;
        if (are_boxes_apart(i, j) || is_beside(i, j) || is_beside(j, i) || !do_meet(i, j)) continue;
        is_simple = false;
        return;
      }
    }
  });
  return is_simple;
}

}  // namespace remesh::verification
