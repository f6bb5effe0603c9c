#include "core/geometry/intersections/search_limits.h"

#include <bit>

namespace remesh {

std::uint64_t SearchLimits::steps_for(std::size_t faces) {
  constexpr std::uint64_t kFewSteps = 1 << 25, kStepsPerFace = 128;
  return kFewSteps + kStepsPerFace * faces * std::bit_width(faces);
}

}  // namespace remesh
