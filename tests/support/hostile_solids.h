/// Families of solids and sheets that meet in as many ways as a file can make them meet, so that the stage that cuts
/// and unites solids has much work. Tests and measurements make each of them in any size.
#pragma once

#include <cstddef>
#include <span>

#include "core/mesh/mesh.h"
#include "tests/support/hostile_families.h"

namespace remesh::hostile {

/// Lists all families:
/// - sheets through one line, and fans around one vertex whose facets cross each other,
/// - boxes that are stacked on each other, and squares that overlap in one plane,
/// - soups of small triangles, of which each crosses a few, and of large ones, of which each crosses most,
/// - combs whose teeth cut those of another one: each its neighbour, or each of them all,
/// - needles through a plate,
/// - icospheres of 1,280 faces and radius 1 at random places, as many for each volume as 200 in a cube of side 10,
/// - cubes in a row, of which each shares a side with the next one, and hexagonal bolts of 20 faces, half sunk into a
///   plate.
std::span<const Family> meeting_families();

}  // namespace remesh::hostile
