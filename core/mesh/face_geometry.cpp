#include "core/mesh/face_geometry.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace remesh {
namespace {

Vec3 some_normal_to(const Vec3& direction) {
  const Vec3 d{std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)};
  const Vec3 axis = d.x <= d.y && d.x <= d.z ? Vec3{1, 0, 0} : d.y <= d.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return normalized(cross(direction, axis));
}

}  // namespace

FaceGeometries face_geometry(const Surface& surface, RunControl& control) {
  FaceGeometries result = FaceGeometries::of_size(surface.face_count());
  for_all(tbb::blocked_range<std::size_t>(0, surface.face_count(), 8192), [&](const auto& range) {
    control.check();
    for (std::size_t f = range.begin(); f < range.end(); ++f) {
      const auto loop = surface.face(FaceId(f));
      const Vec3 origin = surface.local[loop[0]];
      Vec3 twice_area;
      Box3 box;
      double longest = 0;
      Vec3 longest_side;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 a = surface.local[loop[i]];
        const Vec3 b = surface.local[loop[i + 1 == loop.size() ? 0 : i + 1]];
        twice_area += cross(a - origin, b - origin);
        if (norm_squared(b - a) > longest) {
          longest = norm_squared(b - a);
          longest_side = b - a;
        }
        if (loop.size() > 3) box.add(a);
      }
      const double extent = loop.size() == 3 ? std::sqrt(longest) : box.diagonal();
      FaceGeometry& g = result[FaceId(f)];
      const double length = norm(twice_area);
      g.normal = length > 0 ? Vec3{twice_area.x / length, twice_area.y / length, twice_area.z / length} : Vec3{};
      if (g.normal == Vec3{}) g.normal = some_normal_to(longest_side);
      g.area = 0.5 * length;
      g.height = extent > 0 ? 2 * g.area / extent : 0;
    }
  });
  return result;
}

}  // namespace remesh
