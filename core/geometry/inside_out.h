/// Closed pieces of a surface that look the wrong way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"

namespace remesh {

struct InsideOut {
  std::vector<std::uint8_t> is_inside_out;  ///< per face; empty if none is
  std::vector<FaceId> first_faces;          ///< the first face of each such piece, ascending
};

/// Finds the closed, consistently wound, edge-connected pieces that enclose a negative volume and lie within an even
/// number of others. Within an odd number a negative volume is a cavity's, as it should be; a positive one is never
/// called wrong, since it may be a solid of its own.
/// Input:  coordinates within [-2^250, 2^250]. Polygons count as fans, whose signed parts give the right sums.
/// Holds:  exact in what lies within what, where pieces do not cross. A piece is judged by its lexicographically
///         smallest vertex, moved by an infinitesimal if it touches another one.
/// Cost:   O(n); for negative pieces, if there are others, a tree and for each what lies in one direction from it.
///         Where that is more than 1e7 triangles in all, as in a nest of very many, the rest is judged by the nearest
///         piece in the other direction alone; which one is nearest is told to rounding, then.
InsideOut find_inside_out(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                          std::span<const VertexId> corners, const Adjacency& edges, RunControl& control);

}  // namespace remesh
