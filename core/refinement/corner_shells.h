/// Sharp corners of facets: where their sides are cut for size, so that what is between them needs no small triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/refinement/goals.h"
#include "core/refinement/size_field.h"

namespace remesh {

class SegmentTable;

/// Two segments that meet in a patch. The end `from` of segment s is 2 s, its end `to` 2 s + 1.
struct Corner {
  std::uint32_t end, other;
  double angle;  ///< radians
};

/// Near a sharp corner of a facet its sides are much nearer to each other than sizes are large. Cut each on its own,
/// what is between them fills with points until all angles are large enough, or is excused where both happen to be cut
/// at the same distances from the corner. So the sides are cut together. The triangle in the corner is a size long
/// (half of it where sizes vary; or as long as a side that ends soon behind that, or half as long); behind it the
/// pieces are as long as the bound on angles allows for triangles in one row, and grow as fast as the sides part: those
/// of one side end at common distances, those of the other between them. All angles but the corner's own are what was
/// asked for: with 107 triangles before and 37 now, at 25 degrees, in a corner of two whose sides are 10 and 9.3 sizes
/// long; with as many as before at worst.
///
/// Where such pieces would be shorter than the floor, or than a 32nd of the size, the sides are cut at the same
/// distances, a size apart: the angle is given up there, and the triangles are excused, as is the corner's own
/// (rules.md, Input angles).
class CornerShells {
 public:
  CornerShells() = default;
  /// Input:  the corners of all patches, in any order; the table has its segments, with their floors.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   a few sizes for each piece of each side. Sides around one vertex are one thread's work.
  CornerShells(const SegmentTable& table, std::vector<Corner> corners, const Goals& goals, const SizeField& sizes,
               RunControl& control);

  /// The distances from an end of a segment at which that is cut if it is too long: ascending, model units, as far as
  /// the sides are near each other. Empty where no corner is sharp.
  std::span<const double> at(std::uint32_t end) const;

 private:
  struct Range {
    std::uint32_t end;
    std::size_t begin, size;
  };
  std::vector<Range> ranges_;  ///< by end
  std::vector<double> distances_;
};

}  // namespace remesh
