#include "core/base/rounded_to_float.h"

#include <cmath>
#include <limits>

namespace remesh {

[[gnu::noinline]] double rounded_to_float(double value) { return static_cast<float>(value); }

double step_of_floats(double value) {
  const auto nearest = static_cast<float>(std::fabs(value));
  return static_cast<double>(std::nextafter(nearest, std::numeric_limits<float>::infinity())) - nearest;
}

}  // namespace remesh
