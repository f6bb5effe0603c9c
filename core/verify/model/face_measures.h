/// Measures of the faces of a patch that planes and curved surfaces share.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The area vector and enclosed volume of a set of faces, with bounds on their rounding.
struct Measures {
  Vec3 twice_area;
  double twice_absolute_area = 0;
  double volume = 0;
  double magnitude = 0;  ///< sum of the products that went into twice_area
  std::size_t terms = 0;

  void add(const Measures& other) {
    twice_area += other.twice_area;
    twice_absolute_area += other.twice_absolute_area;
    volume += other.volume;
    magnitude += other.magnitude;
    terms += other.terms;
  }
  /// A bound on the rounding of `twice_area`. Each term errs by a few units in its last place, each addition by one
  /// unit in that of the sum.
  double rounding() const { return static_cast<double>(terms + 8) * 0x1p-52 * magnitude; }
};

/// True if the input has this triangle in this patch with the same orientation.
/// Cost: O(log n + uses of the edge that fewest faces use).
bool is_input_triangle(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch,
                       std::span<const VertexId> face);

/// True if all faces of a patch are unchanged.
bool is_unchanged(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch, RunControl& control);

}  // namespace remesh::verification
