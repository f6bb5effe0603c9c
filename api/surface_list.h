/// Makes a short list of the surfaces of a report, for people to read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh::api {

/// All surfaces of one kind.
struct SurfaceGroup {
  SurfaceKind kind = SurfaceKind::kFree;
  std::uint64_t count = 0;
  std::uint64_t faces = 0;  ///< faces of the input
  double area = 0;
  /// The count and the sizes: `14 cylinders: 8 of r 2.5 (holes), 6 of r 3.175 (holes)`.
  std::string text;
};

/// Groups the surfaces by kind. In the text of a group, surfaces of the same size are counted together.
/// Output:  the kinds that occur, and within a text the sizes, each from the largest area to the smallest.
/// Holds:   two sizes are the same only if they differ by no more than the tolerances of the two surfaces explain. A
///          size has only the digits that the deviation of its facets allows, and at most six.
/// Cost:    O(n log n).
std::vector<SurfaceGroup> list_surfaces(const RecognisedSurfaces& recognised);

}  // namespace remesh::api
