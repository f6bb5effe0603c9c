#include "core/mending/polygons/triangulated.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/tolerance.h"
#include "core/geometry/planes/projection.h"
#include "core/mending/polygons/polygon_split.h"

namespace remesh {
namespace {

double area_of(const std::vector<Vec3>& loop) { return norm(newell_normal(loop)) / 2; }

/// Returns whether a polygon is flat up to rounding.
bool is_flat(const std::vector<Vec3>& loop) {
  const Vec3 normal = normalized(newell_normal(loop));
  Box3 box;
  double low = 0, high = 0;
  for (const Vec3& p : loop) {
    box.add(p);
    low = std::min(low, dot(p - loop[0], normal));
    high = std::max(high, dot(p - loop[0], normal));
  }
  return high - low <= kToleranceCeiling * box.diagonal();
}

}  // namespace

std::size_t Triangulated::first_of(FaceId f) const {
  if (!are_split()) return f.value;
  return static_cast<std::size_t>(std::lower_bound(face_.begin(), face_.end(), f) - face_.begin());
}

Triangulated::Triangulated(const Surface& surface, RunControl& control, double tolerance)
    : surface_(&surface), are_split_(surface.corners.size() != 3 * surface.face_count()) {
  if (!are_split_) return;
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    if (i % kItemsPerBlock == 0) control.check_and_move();
    double area = 0;
    const PolygonKind kind = visit_triangles(
        surface, FaceId(i), control,
        [&](const Triangle& t) {
          corners_.insert(corners_.end(), t.begin(), t.end());
          face_.push_back(FaceId(i));
          area += area_of({surface.local[t[0]], surface.local[t[1]], surface.local[t[2]]});
        },
        tolerance);
    if (kind != PolygonKind::kSelfCrossing) continue;
    std::vector<Vec3> outline;
    for (const VertexId v : surface.face(FaceId(i))) outline.push_back(surface.local[v]);
    if (is_flat(outline)) excess_area_ += std::max(0.0, area - area_of(outline));
  }
}

}  // namespace remesh
