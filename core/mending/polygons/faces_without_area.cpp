#include "core/mending/polygons/faces_without_area.h"

#include "core/base/blocks.h"
#include "core/geometry/exact/predicates.h"

namespace remesh {

bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 && orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
         orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

bool is_without_area(const Surface& surface, FaceId f) {
  const auto loop = surface.face(f);
  // Original coordinates, scaled exactly, so that a line of the input is a line here.
  const auto exact = [&](int i) { return (1 / surface.unit) * surface.positions[loop[i]]; };
  return loop.size() == 3 && is_collinear(exact(0), exact(1), exact(2));
}

std::vector<FaceId> faces_without_area(const Surface& surface, RunControl& control) {
  return select_ids<FaceId>(surface.face_count(), kItemsPerBlock, control,
                            [&](std::size_t f) { return is_without_area(surface, FaceId(f)); });
}

}  // namespace remesh
