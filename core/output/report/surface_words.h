/// Names surfaces in messages that people read.
#pragma once

#include <cstdint>
#include <string>

#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// Formats a whole number with a comma before every three digits: `1,252`.
std::string grouped_digits(std::uint64_t number);

/// Formats a predicted number with two digits: `about 12,000`.
std::string about(double number);

/// Formats a number of surfaces of one kind: `1 torus`, `14 cylinders`, `2 free regions`.
std::string count_text(std::uint64_t count, SurfaceKind kind);

}  // namespace remesh
