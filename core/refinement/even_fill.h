/// Points that fill an area evenly.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Points of a lattice of nearly equilateral triangles, whose edges are at most `size`, inside a region and away from
/// its boundary: what lies between is left to refinement. Rows run along x; the lattice is stretched to fit the box.
/// Input:  the boundary as directed pieces no longer than `size`, the region on their left.
/// Output: rows from below to above, each from left to right.
/// Cost:   O(p log p + n) for p pieces and n points of the lattice in the box's rows that the region meets.
std::vector<Vec2> even_fill(std::span<const std::array<Vec2, 2>> pieces, double size, RunControl& control);

}  // namespace remesh
