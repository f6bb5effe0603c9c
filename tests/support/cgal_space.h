/// CGAL's results for points and triangles in space. They are the oracle for ours.
///
/// CGAL's headers take longer to compile than most tests do, so only the source file of this one includes them.
#pragma once

#include <memory>
#include <span>

#include "core/base/vec.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// An exact test.
/// Output: 1 if the triangle abc turns left as seen from d, -1 if it turns right, 0 if the points are in one plane.
int cgal_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// An exact test whether three points are on one line.
bool cgal_is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// Squared distances, exact to rounding. The triangles must have an area.
double cgal_squared_distance(const Vec3& p, const Corners3& t);
double cgal_squared_distance(const Corners3& s, const Corners3& t);

/// The result that do_intersect must give. It follows the definition literally and uses exact constructions.
class CgalIntersection {
 public:
  explicit CgalIntersection(std::span<const Vec3> positions);
  ~CgalIntersection();
  CgalIntersection(const CgalIntersection&) = delete;
  CgalIntersection& operator=(const CgalIntersection&) = delete;

  bool operator()(const Triangle& f, const Triangle& g) const;
  bool has_area(const Triangle& t) const;

 private:
  struct Points;
  std::unique_ptr<const Points> points_;
};

}  // namespace remesh
