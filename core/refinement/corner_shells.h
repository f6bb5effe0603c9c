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
/// what is between them fills with points until all angles are large enough: a needle of two degrees that is ten sizes
/// long takes a hundred triangles. So the sides are cut together, at common distances from the corner, the first at a
/// size; there the triangle in the corner ends. Behind it the pieces are as long as the bound on angles allows for
/// triangles in one row, and grow as fast as the sides part: those of one side end at the common distances, those of
/// the other between them. That takes a third of the triangles, and all have the angle that was asked for.
///
/// Where such pieces would be shorter than the floor, the sides are cut at the same distances, a size apart: the angle
/// cannot be had, and so the triangles between them are excused, as is the corner's own (REFINEMENT, rule 4).
class CornerShells {
 public:
  CornerShells() = default;
  /// Input: the corners of all patches, in any order; the table has its segments, with their floors.
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
