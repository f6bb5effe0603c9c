#include "core/output/report/surface_words.h"

#include <algorithm>
#include <cmath>

namespace remesh {
namespace {

struct Words {
  std::string_view one, many;
};

Words words_of(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane: return {"plane", "planes"};
    case SurfaceKind::kCylinder: return {"cylinder", "cylinders"};
    case SurfaceKind::kCone: return {"cone", "cones"};
    case SurfaceKind::kSphere: return {"sphere", "spheres"};
    case SurfaceKind::kTorus: return {"torus", "tori"};
    case SurfaceKind::kRevolution: return {"surface of revolution", "surfaces of revolution"};
    case SurfaceKind::kFree: return {"free region", "free regions"};
  }
  return {};
}

}  // namespace

std::string grouped_digits(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t left = digits.size(); left > 3; left -= 3) digits.insert(left - 3, 1, ',');
  return digits;
}

std::string about(double number) {
  const double step = number < 100 ? 1 : std::pow(10, std::floor(std::log10(number)) - 1);
  return "about " + grouped_digits(static_cast<std::uint64_t>(std::min(std::round(number / step) * step, 0x1p62)));
}

std::string count_text(std::uint64_t count, SurfaceKind kind) {
  const Words words = words_of(kind);
  return grouped_digits(count) + " " + std::string(count == 1 ? words.one : words.many);
}

}  // namespace remesh
