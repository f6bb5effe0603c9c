/// Totals of the checks of patches.
#pragma once

namespace remesh::verification {

/// Totals over the patches, summed in patch order.
struct ShapeSums {
  double deviation = 0;      ///< largest distance between input and output
  double volume_change = 0;  ///< volume of the output minus that of the input, meaningful for closed surfaces
  double volume_bound = 0;   ///< the part of it that deviations and rounding explain
};

}  // namespace remesh::verification
