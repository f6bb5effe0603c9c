/// The measures of a face relative to a curved surface.
#pragma once

#include <algorithm>
#include <limits>

namespace remesh::verification {

/// The smallest and the largest of some numbers. It is empty at first.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  void add(const Range& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  Range widened(double by) const { return {low - by, high + by}; }
};

/// The measures of a face relative to a curved surface.
struct CurvedFace {
  Range distance;      ///< bounds of the signed distance from the surface, over the whole face
  Range facing;        ///< bounds of the cosine between the normals of the face and of the surface, or of its sign
  Range area;          ///< bounds of the area that the face covers on the surface; {0, 0} if the surface is not compact
  double snapped = 0;  ///< the largest distance by which a corner was moved to the apex of a cone
};

}  // namespace remesh::verification
