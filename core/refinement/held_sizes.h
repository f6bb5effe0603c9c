/// How large triangles have to be beside sides that stay as long as they are.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/box_tree.h"

namespace remesh {

/// A side of a patch that is longer than it may be, and is not cut. All in the plane.
struct HeldSide {
  Vec2 from, to;
  double size;  ///< the longest edge that is asked for there
};

/// Beside held sides triangles are as long as these, farther away as much smaller as well shaped ones can be, and half
/// as much again. Asked for less there, refinement would put flat triangles without number beside a side, or give up.
/// What is beyond a third of a side's length has the size that is asked for.
/// Holds:  no answer depends on the order of the sides.
class HeldSizes {
 public:
  /// Cost:   O(n log n), and O(log n) a question where sides are about as long as they are far apart.
  HeldSizes(std::span<const HeldSide> sides, double min_angle_deg, RunControl& control);

  /// The largest size that a side makes necessary at a place; 0 where none does.
  double at(Vec2 place) const;
  /// Does a side make an edge of that length necessary, wherever it is within that radius of the place?
  bool allow(double length, Vec2 place, double radius) const { return at(place) - steepest_ * radius >= length; }

 private:
  /// A size that shrinks with the distance.
  struct Shrinking {
    double size = 0, slope = 0;
    void join(Shrinking other) {
      size = std::max(size, other.size);
      slope = std::min(slope, other.slope);
    }
  };

  double steepest_;
  BoxTree<Shrinking> tree_;
  std::vector<HeldSide> sides_;  ///< by slot
};

}  // namespace remesh
