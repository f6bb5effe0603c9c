/// Joins regions that have one plane after all.
#pragma once

#include <cstdint>
#include <span>

#include "core/patches/coplanar_regions.h"
#include "core/patches/coplanarity.h"

namespace remesh {

/// Joins neighbouring regions that have one plane after all. Growth begins with a plane as good as one face, and on a
/// thin frame that plane is wrong at the far end by many times the rounding; all corners together know better. Two
/// regions at a time are held against the larger one's plane and against the one nearest to the corners of both, each
/// shifted to the corners' middle; pairs of which one has grown are tried again.
/// Input:  regions from `first_region` on; of each of them a face, and the height of its highest face. Older ones are
///         not touched.
/// Holds:  what coplanar_regions promises of regions. One that has been taken in by another has no faces any more.
/// Cost:   O(n log n). A try costs the smaller region; the larger one is known by its box and by a few faces that did
///         not fit before, and is held against a plane face by face a bounded number of times until it has doubled.
void merge_regions(const Surface& surface, const Adjacency& adjacency, const Coplanarity& rule,
                   std::uint32_t first_region, std::span<const FaceId> seeds, std::span<const double> heights,
                   Regions& regions, RunControl& control);

}  // namespace remesh
