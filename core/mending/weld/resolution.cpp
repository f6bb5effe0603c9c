#include "core/mending/weld/resolution.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "core/base/number_text.h"

namespace remesh {
namespace {

/// The measures of a face, in model units.
struct Measures {
  double longest = 0;             ///< length of the longest side
  double shortest = HUGE_VAL;     ///< length of the shortest side
  double height = HUGE_VAL;       ///< twice the area over the longest side
  double farthest_from_zero = 0;  ///< largest absolute value of a coordinate
};

double largest(const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

/// Differences of halved coordinates do not overflow. In units of the largest difference, no product overflows either.
Measures measures_of(const Surface& surface, FaceId f) {
  const std::span<const VertexId> loop = surface.face(f);
  const auto half = [&](std::size_t i) { return 0.5 * surface.positions[loop[i % loop.size()]]; };
  Measures m;
  double unit = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    m.farthest_from_zero = std::max(m.farthest_from_zero, largest(surface.positions[loop[i]]));
    unit = std::max(unit, largest(half(i) - half(0)));
  }
  if (!(unit > 0)) return {0, 0, 0, m.farthest_from_zero};
  const auto scaled = [&](std::size_t i) {
    const Vec3 d = half(i) - half(0);
    return Vec3{d.x / unit, d.y / unit, d.z / unit};
  };
  Vec3 twice_area;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double side = norm(scaled(i + 1) - scaled(i));
    m.longest = std::max(m.longest, side);
    m.shortest = std::min(m.shortest, side);
    twice_area += cross(scaled(i), scaled(i + 1));
  }
  m.height = norm(twice_area) / m.longest;
  for (double* length : {&m.longest, &m.shortest, &m.height}) *length *= 2 * unit;
  return m;
}

std::string digits_of(double x) { return number_text(x, 4); }

}  // namespace

bool is_unresolved(const Surface& surface, FaceId f) {
  // This is a few times the rounding error of the face's own sides, and of the mesh's largest coordinates.
  constexpr double kResolved = 0x1p-50;
  const Measures m = measures_of(surface, f);
  const double scale = std::max({m.longest, m.farthest_from_zero, largest(surface.centre), surface.unit});
  return std::min(m.shortest, m.height) < kResolved * scale;
}

Error unresolved(const Surface& surface, FaceId f) {
  const Measures m = measures_of(surface, f);
  const std::uint32_t number = surface.face_source[f].value;
  return Error(Code::kCoordinateRange, Stage::kVerify,
               "face " + std::to_string(number) +
                   " is too thin or too small for a result to be proven: its sides are " + digits_of(m.shortest) +
                   " to " + digits_of(m.longest) + " long and its height is " + digits_of(m.height) +
                   ", but the mesh is " + digits_of(2 * surface.unit) +
                   " wide, and doubles have only 16 digits. Correct vertices that lie far off, or leave the face out")
      .at_element(number);
}

}  // namespace remesh
