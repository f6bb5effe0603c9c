/// Finds the segments that run along curves of curved patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/patches/charts/boundary_curve.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/segments/segment_end.h"

namespace remesh {

/// The traces of the segments beside curved patches.
class TracedSegments {
 public:
  /// A segment, and the patches beside it.
  struct Segment {
    Vec3 from, to;
    std::span<const PatchId> patches;
  };

  TracedSegments() = default;
  /// Input:  `segment_of(i)` returns the i-th segment.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n) if any patch is curved.
  template <class SegmentOf>
  TracedSegments(std::size_t count, const SegmentOf& segment_of, const PatchCharts& charts, RunControl& control) {
    if (!charts.has_curved()) return;
    at_.reserve(count);
    for (std::size_t s = 0; s < count; ++s) {
      if (s % 1024 == 0) control.check_and_move();
      add(segment_of(SegmentId(s)), charts);
    }
  }

  /// Returns the trace of a segment, or null if the segment is straight.
  const CurveTrace* of(SegmentId s) const {
    return at_.empty() || at_[s.value] == kNone ? nullptr : &traces_[at_[s.value]];
  }
  /// Removes the trace of a segment, which is straight from then on.
  void straighten(SegmentId s) { at_[s.value] = kNone; }

 private:
  void add(const Segment& segment, const PatchCharts& charts);

  std::vector<CurveTrace> traces_;
  std::vector<std::uint32_t> at_;  ///< for each segment, its index in `traces_`, or kNone; empty if no patch is curved
};

}  // namespace remesh
