/// Decides how large triangles have to be beside fixed sides, whose lengths do not change.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"

namespace remesh {

/// A fixed side: it is longer than allowed and is not cut. All values are in the patch's plane.
struct FixedSide {
  Vec2 from, to;
  double size;  ///< the max edge length that is asked for there
};

/// Beside a fixed side, triangles may be as large as the side is long. With the distance from the side, this size
/// shrinks 1.5 times as fast as well-shaped triangles can. If smaller triangles were asked for there, refinement would
/// put countless flat triangles beside the side, or give up. Farther away than a third of the side's length, only the
/// size that is asked for counts.
/// Holds: The answers do not depend on the order of the sides.
class FixedSideSizes {
 public:
  /// Cost: O(n log n), and O(log n) for each question if sides are about as long as they are far apart.
  FixedSideSizes(std::span<const FixedSide> sides, double min_angle_deg, RunControl& control);

  /// Returns the largest size that any fixed side makes necessary at a place, or 0 if none does.
  double at(Vec2 place) const;
  /// Returns whether a fixed side makes an edge of that length necessary at every place within the radius.
  bool allow(double length, Vec2 place, double radius) const { return at(place) - steepest_ * radius >= length; }

 private:
  /// A size at a side, and the slope with which it shrinks with the distance from the side.
  struct Shrinking {
    double size = 0, slope = 0;
    void join(Shrinking other) {
      size = std::max(size, other.size);
      slope = std::min(slope, other.slope);
    }
  };

  double steepest_;
  BoxTree<Shrinking> tree_;
  std::vector<FixedSide> sides_;  ///< ordered as the slots of the tree
};

}  // namespace remesh
