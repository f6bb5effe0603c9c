/// Rounding to floats that no compiler leaves out.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// The float nearest to a number, ties to even; an infinity beyond the largest float.
/// It is a function of its own, one number at a time, since GCC 12 drops the rounding where it turns two coordinates to
/// floats and back at once (`-O2 -fno-trapping-math`).
double rounded_to_float(double value);

inline Vec3 rounded_to_float(const Vec3& p) {
  return {rounded_to_float(p.x), rounded_to_float(p.y), rounded_to_float(p.z)};
}

}  // namespace remesh
