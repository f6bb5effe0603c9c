/// Gives closed surfaces back the volume that they had.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/ordered_input.h"
#include "core/free_form/sheet.h"

namespace remesh {

/// The volumes of the closed components of a surface that becomes coarser. A component is closed if its edges with
/// other than two faces, apart from those that stay with all that is around, cancel each other.
class KeptVolume {
 public:
  /// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
  /// Cost:   O(n log n).
  KeptVolume(const OrderedInput& input, RunControl& control);

  /// Returns the vertices' places, after some were moved along their normals, so that each closed component has its
  /// volume, nearly to rounding. A component for which they would have to move by more than half of `tolerance` stays.
  /// Input:  per vertex, how far it may move in proportion to others; 0 if it stays.
  /// Errors: as above.
  /// Cost:   O(n).
  IdVector<VertexId, Vec3> places(const Sheet& sheet, const IdVector<VertexId, double>& weights, double tolerance,
                                  RunControl& control) const;

 private:
  std::vector<std::uint32_t> component_;  ///< per face of the input
  std::vector<double> volume_;            ///< per component; NaN if it is open
};

}  // namespace remesh
