/// Says how thoroughly a refined patch is thinned out.
#pragma once

namespace remesh {

/// Tells what is tried for a point that the bounds may not need.
enum class Thinning {
  kFull,
  /// A point is only left out, and no point takes the place of two. That takes half the time. It is enough where the
  /// limit on faces ends refinement before its bounds are met, so that there is no smallest result.
  kQuick,
};

}  // namespace remesh
