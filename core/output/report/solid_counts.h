/// Numbers that tell what became of faces that intersected.
#pragma once

#include <cstddef>
#include <optional>

namespace remesh {

/// Counts what was done to make triangles one conforming surface, or the boundary of a union of solids. These are the
/// triangles before refinement, whose corners are the input's vertices that stay.
struct SolidCounts {
  std::size_t curves = 0;            ///< pairs of triangles that crossed each other, and were cut along their curve
  std::size_t cut_patches = 0;       ///< patches with triangles that were cut
  std::size_t shared = 0;            ///< triangles that took the place of several that lay on each other
  std::size_t coplanar_classes = 0;  ///< groups of patches that lay on each other in part
  /// The cells into which the surface divides space before anything is dropped, without the one outside. It is empty if
  /// some triangles still intersect.
  std::optional<std::size_t> cells;
  std::size_t dropped = 0;  ///< triangles that do not bound the union
  std::size_t turned = 0;   ///< outermost closed shells that faced inwards, and were turned over for the union
  std::size_t rounds = 0;   ///< how often points were joined, because rounding had made new intersections
  std::size_t left = 0;     ///< pairs of triangles that still intersect
  double moved = 0;         ///< how far points have moved at most, in model units
};

}  // namespace remesh
