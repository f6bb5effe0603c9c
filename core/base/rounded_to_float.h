/// Rounds doubles to floats in a way that no compiler optimises away.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// The float nearest to a number, ties to even. Beyond the largest float it is an infinity.
/// This is a function of its own that rounds one number at a time, because GCC 12 drops the rounding if it converts two
/// coordinates to floats and back at once (`-O2 -fno-trapping-math`).
double rounded_to_float(double value);

inline Vec3 rounded_to_float(const Vec3& p) {
  return {rounded_to_float(p.x), rounded_to_float(p.y), rounded_to_float(p.z)};
}

/// The distance from the float nearest to a number to the next float away from zero.
double step_of_floats(double value);

}  // namespace remesh
