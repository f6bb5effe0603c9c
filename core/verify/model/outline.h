/// Measures outlines of polygons in space, for the checker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"

namespace remesh::verification {

/// Measures of an outline that depend on its corners alone.
struct OutlineMeasures {
  Vec3 twice_area;
  double magnitude = 0;  ///< the rounding error of `twice_area` is proportional to this
  double length = 0;     ///< length of the outline
};

/// Cost: O(n). `check` is called once for each corner.
OutlineMeasures measure_outline(std::span<const Vec3> loop, StopCheck& check);

/// True if no corner is further than the tolerance from the plane with that unit normal through the first corner.
bool is_flat(std::span<const Vec3> loop, const Vec3& normal, double tolerance, StopCheck& check);

/// Removes the corners at which the outline turns back over itself within the tolerance. Such a spike encloses
/// nothing.
/// Cost: O(n).
void cut_spikes(std::vector<Vec3>& loop, double tolerance, StopCheck& check);

/// Finds out whether a flat outline clearly neither crosses nor touches itself. An outline is clearly simple if no
/// corner is within the tolerance of an edge that does not end there, and no two edges cross. Only edges that overlap
/// along one axis are compared.
class SimpleOutline {
 public:
  /// Sorts the edges along the axis of space along which the fewest pairs of them overlap.
  /// Input: `loop` - the corners, which lie in the plane with that unit normal up to the tolerance.
  /// Cost:  O(n log n).
  SimpleOutline(std::vector<Vec3> loop, const Vec3& normal, double tolerance, const RunControl& control);

  /// The number of pairs of edges that is_simple compares.
  std::uint64_t pair_count() const { return pair_count_; }
  /// True if the outline is clearly simple.
  /// Cost: O(n + pair_count), in parallel.
  bool is_simple(RunControl& control) const;

 private:
  struct Interval {
    double low, high;
    std::uint32_t edge;
  };

  std::size_t after(std::size_t i) const { return i + 1 == loop_.size() ? 0 : i + 1; }
  std::vector<Interval> intervals(int axis, const RunControl& control) const;
  std::uint64_t count_overlaps(const std::vector<Interval>& sorted, const RunControl& control) const;
  bool are_boxes_apart(std::size_t i, std::size_t j) const;
  double side(std::size_t i, const Vec3& p) const;
  double distance(std::size_t i, const Vec3& p) const;
  bool is_beside(std::size_t i, std::size_t j) const;
  bool do_meet(std::size_t i, std::size_t j) const;

  std::vector<Vec3> loop_;
  Vec3 normal_;
  double tolerance_;
  std::vector<Interval> sorted_;  ///< the edges, sorted by where they begin along the axis
  std::uint64_t pair_count_ = 0;
};

}  // namespace remesh::verification
