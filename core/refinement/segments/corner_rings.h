/// Decides where the two sides of a sharp corner of a facet are cut for size, so that no small triangles are needed
/// between them.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/segments/segment_end.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

class SegmentTable;

/// Two segment ends that meet at a corner of a patch.
struct Corner {
  SegmentEnd end, other;
  double angle;  ///< radians
};

/// Near a sharp corner of a facet, the distance between the two sides is much smaller than the size. If each side were
/// cut on its own, refinement would fill the area between them with points until all angles are large enough. Or the
/// triangles there would be allowed to have small angles, if both sides happened to be cut at the same distances from
/// the corner. So the sides are cut together.
///
/// The triangle in the corner is one size long. There are three exceptions: it is about half a size long where sizes
/// vary, and if a side ends soon behind it, it is as long as that side, or half as long. Behind it, the pieces are as
/// long as the bound on angles allows for a single row of triangles. They grow as fast as the sides move apart. The
/// pieces of one side end at common distances from the corner, those of the other side end between these distances. All
/// angles except the corner's own meet the bound. This may take a third of the triangles that repeated halving takes,
/// and never takes more. See experiments.md, Sharp corners.
///
/// Where such pieces would be shorter than the floor, or than a 32nd of the size, both sides are cut at the same
/// distances, a size apart. The bound on angles is given up there: these triangles may have smaller angles, as may the
/// triangle in the corner itself (rules.md, Input angles).
class CornerRings {
 public:
  CornerRings() = default;
  /// Input:  The corners of all patches, in any order. The table has their segments, with floors. A small
  ///         goals.max_faces lowers the number of pieces for which the two sides of a corner are cut together.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   A few look-ups of sizes for each piece of each side. The sides around one vertex are the work of one
  ///         thread.
  CornerRings(const SegmentTable& table, std::vector<Corner> corners, const Goals& goals, const SizeField& sizes,
              RunControl& control);

  /// Returns the distances from an end of a segment at which the segment is cut if it is too long. They are ascending
  /// and in model units. They end where the sides are no longer near each other. There are none if no corner at this
  /// end is sharp.
  std::span<const double> at(SegmentEnd end) const;

 private:
  struct Range {
    SegmentEnd end;
    std::size_t begin, size;
  };
  std::vector<Range> ranges_;  ///< sorted by end
  std::vector<double> distances_;
};

}  // namespace remesh
