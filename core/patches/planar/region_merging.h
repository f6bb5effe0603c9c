/// Joins regions that lie in one plane.
#pragma once

#include <cstdint>
#include <span>

#include "core/patches/planar/coplanarity.h"
#include "core/patches/planar/regions.h"

namespace remesh {

/// Joins neighbouring regions that lie in one plane, although growth has separated them. Growth begins with the plane
/// of a single face. On a thin frame, that plane is wrong at the far end by many times the rounding, and all corners
/// together give a better one. Two regions at a time are tested against two planes: the larger region's, and the one
/// nearest to the corners of both. Each plane is shifted to the middle of the corners. Pairs of which one region has
/// grown are tested again.
/// Input:  the regions from `first_region` on; for each of them a face, and the height of its highest face. Older
///         regions are not changed.
/// Holds:  the promises of coplanar_regions about regions. A region that was joined to another one has no faces any
///         more.
/// Cost:   O(n log n). A test costs as much as the smaller region. The larger region is represented by its box and by a
///         few faces that did not fit before. It is tested face by face only a bounded number of times until it has
///         doubled. Pairs that have no region in common are tested in parallel.
void merge_regions(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule,
                   std::uint32_t first_region, std::span<const FaceId> seeds, std::span<const double> heights,
                   Regions& regions, RunControl& control);

}  // namespace remesh
