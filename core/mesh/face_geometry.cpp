#include "core/mesh/face_geometry.h"

#include <cmath>
#include <span>

#include "core/base/parallel.h"
#include "core/base/prefault_pages.h"

namespace remesh {

FaceGeometries face_geometry(const Surface& surface, RunControl& control) {
  FaceGeometries result = FaceGeometries::of_size(surface.face_count());
  for_ranges(0, surface.face_count(), 8192, [&](std::size_t begin, std::size_t end) {
    control.check();
    prefault_pages(std::span(result.items()).subspan(begin, end - begin));
    for (std::size_t f = begin; f < end; ++f) {
      const auto loop = surface.face(FaceId(f));
      const Vec3 origin = surface.local[loop[0]];
      Vec3 twice_area;
      double longest = 0;
      Vec3 longest_side;
      const auto add_side = [&](const Vec3& side) {
        if (const double length = norm_squared(side); length > longest) {
          longest = length;
          longest_side = side;
        }
      };
      double extent = 0;
      if (loop.size() == 3) {
        const Vec3 b = surface.local[loop[1]], c = surface.local[loop[2]];
        twice_area += cross(b - origin, c - origin);
        for (const Vec3& side : {b - origin, c - b, origin - c}) add_side(side);
        extent = std::sqrt(longest);
      } else {
        Box3 box;
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const Vec3 a = surface.local[loop[i]], b = surface.local[loop[i + 1 == loop.size() ? 0 : i + 1]];
          twice_area += cross(a - origin, b - origin);
          add_side(b - a);
          box.add(a);
        }
        extent = box.diagonal();
      }
      FaceGeometry& g = result[FaceId(f)];
      const double length = norm(twice_area);
      g.normal = length > 0 ? Vec3{twice_area.x / length, twice_area.y / length, twice_area.z / length} : Vec3{};
      if (g.normal == Vec3{}) g.normal = unit_across(longest_side);
      g.area = 0.5 * length;
      g.height = extent > 0 ? 2 * g.area / extent : 0;
    }
  });
  return result;
}

}  // namespace remesh
