/// The planes of regions: fits them to faces, and measures how far faces are from them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/run_control.h"
#include "core/geometry/planes/plane.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"
#include "core/patches/planar/coplanarity.h"

namespace remesh {

/// Sums over faces, for the plane through them. They are weighted by area, so that the normal depends on the rim alone.
struct PlaneSums {
  Vec3 area_vector, moment;
  double area = 0;

  void add(const FaceGeometry& g, const Vec3& centre) {
    area_vector += g.area * g.normal;
    moment += g.area * centre;
    area += g.area;
  }
  void add(const PlaneSums& other) {
    area_vector += other.area_vector;
    moment += other.moment;
    area += other.area;
  }
  Plane plane() const { return {(1 / area) * moment, normalized(area_vector)}; }
};

/// The measures of a region's faces relative to its plane.
struct Extent {
  double deviation = 0;  ///< distance of the farthest corner
  double height = 0;     ///< height of the highest face
  void add(const Extent& other) {
    deviation = std::max(deviation, other.deviation);
    height = std::max(height, other.height);
  }
};

struct FittedPlane {
  Plane plane;
  Extent extent;
};

/// Finds planes of faces of one surface, and compares faces with planes. Lists of faces have the numbers of the faces.
/// Input:  the arguments must outlive this object.
/// Holds:  sums are made block by block, in the order of the faces. So they are the same for any number of threads.
/// Cost:   each function is linear in the faces' corners.
class RegionPlanes {
 public:
  RegionPlanes(const Surface& surface, const FaceGeometries& geometry, const Coplanarity& rule, RunControl& control)
      : surface_(surface), geometry_(geometry), rule_(rule), control_(control) {}

  /// Finds the plane of an island that fits one, as most islands do. Growing would find the same region.
  /// Output: empty if the ladder made the seed a region of its own, or if no plane was found that fits all faces.
  std::optional<FittedPlane> of_all(FaceId seed, std::span<const std::uint32_t> island) const;

  /// Sums over faces. Thin faces are left out, except the seed.
  PlaneSums sum_of(FaceId seed, std::span<const std::uint32_t> faces) const;

  /// Output: empty if some face does not fit the plane.
  std::optional<Extent> extent_if_all_fit(std::span<const std::uint32_t> faces, const Plane& plane, double tol) const;

  Extent extent_of(std::span<const std::uint32_t> faces, const Plane& plane) const;

 private:
  bool move_to_corners(Plane& plane, std::span<const std::uint32_t> faces, double band) const;

  template <class Sum, class Add>
  Sum sum_over(std::span<const std::uint32_t> faces, const Add& add) const;

  const Surface& surface_;
  const FaceGeometries& geometry_;
  const Coplanarity& rule_;
  RunControl& control_;
};

}  // namespace remesh
