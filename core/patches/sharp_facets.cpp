#include "core/patches/sharp_facets.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Returns the angle inside a patch between the ways to the previous corner and to the next one, from 0 to a full turn.
double corner_angle(const Vec3& before, const Vec3& here, const Vec3& after, const Vec3& normal) {
  const Vec3 forwards = after - here, backwards = before - here;
  const double angle = std::atan2(dot(normal, cross(forwards, backwards)), dot(forwards, backwards));
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

}  // namespace

IdVector<PatchId, std::uint8_t> find_sharp_facets(const Surface& surface, const Adjacency& adjacency,
                                                  const PatchSet& patches, const BoundaryLoops& loops,
                                                  const EssentialVertices& essential, double max_angle_deg,
                                                  RunControl& control) {
  IdVector<PatchId, std::uint8_t> is_sharp(patches.count(), 0);
  const double max_angle = max_angle_deg * std::numbers::pi / 180 * (1 - 1e-9);
  StopCheck check(control);
  std::vector<Vec3> corners;
  for (std::uint32_t i = 0; i < patches.count(); ++i) {
    const PatchId p(i);
    for (std::uint32_t l = loops.patch_begin[i]; l < loops.patch_begin[i + 1]; ++l) {
      corners.clear();
      for (const std::uint32_t h : loops.loop(l)) {
        check();
        if (essential[adjacency.from(h)]) corners.push_back(surface.local[adjacency.from(h)]);
      }
      const std::size_t n = corners.size();
      for (std::size_t k = 0; k < n && n > 2; ++k) {
        const double angle =
            corner_angle(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n], patches.planes[p].normal);
        if (angle < max_angle) is_sharp[p] = 1;
      }
    }
  }
  return is_sharp;
}

}  // namespace remesh
