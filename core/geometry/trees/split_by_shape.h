/// Splits long triangles so that boxes along the two halves separate them.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A triangle on its way to a slot of a tree.
struct ShapedItem {
  Vec3 centre;     ///< twice the mean of the corners, which lies in the triangle's plane, unlike its box's centre
  Vec3 reach;      ///< the longest side, in the direction in which its largest coordinate is positive
  double key = 0;  ///< the place in the order by which a node is split
  FaceId face;
};

/// Returns twice the mean of a triangle's corners.
Vec3 place_of(const Triangle& face, std::span<const Vec3> positions);

/// Returns the longest side of a triangle, in the direction in which its largest coordinate is positive.
Vec3 reach_of(const Triangle& face, std::span<const Vec3> positions);

/// Reorders triangles so that the first `middle` of them and the others are as far apart as a split can make them. They
/// are split by place, across the direction in which they are narrow compared with the distances between them: needles
/// side by side are split between needles, whatever their lengths. If the longest sides differ more than the places,
/// triangles are split by these sides: needles that cross each other at one place are split by direction, and large
/// triangles are split from small ones.
/// Holds:   the order depends on the items and the order in which they come, and not on threads. It stays the same if
///          all lengths are multiplied by a power of two.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n), and some microseconds.
/// Source:  R. A. Fisher, The use of multiple measurements in taxonomic problems, 1936: the direction in which the
///          variance between groups is largest, compared with that within groups. Here the places of triangles stand
///          for groups, and their sides for what is within.
void split_by_shape(std::span<ShapedItem> items, std::size_t middle, RunControl& control);

}  // namespace remesh
