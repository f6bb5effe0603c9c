/// What do_intersect must answer, by the definition word for word and CGAL's exact constructions: the oracle for ours.
#pragma once

#include <CGAL/Gmpq.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <span>
#include <variant>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

class CgalIntersection {
 public:
  explicit CgalIntersection(std::span<const Vec3> positions) {
    for (const Vec3& p : positions) points_.emplace_back(p.x, p.y, p.z);
  }

  bool operator()(const Triangle& f, const Triangle& g) const {
    const std::vector<Point> common =
        std::visit([](const auto& a, const auto& b) { return corners_of_common_part(a, b); }, shape(f), shape(g));
    if (common.empty()) return false;
    // The common part is convex, so it is covered by shared corners and edges only if one of them holds all of it.
    std::set<VertexId> shared;
    for (const VertexId v : f)
      if (std::find(g.begin(), g.end(), v) != g.end()) shared.insert(v);
    const auto is_all_between = [&](VertexId v, VertexId w) {
      return std::all_of(common.begin(), common.end(),
                         [&](const Point& p) { return Segment(at(v), at(w)).has_on(p) || p == at(v); });
    };
    for (const VertexId v : shared)
      for (const VertexId w : shared)
        if (is_all_between(v, w)) return false;
    return true;
  }

  bool has_area(const Triangle& t) const { return std::holds_alternative<Face>(shape(t)); }

 private:
  using Kernel = CGAL::Simple_cartesian<CGAL::Gmpq>;
  using Point = Kernel::Point_3;
  using Segment = Kernel::Segment_3;
  using Face = Kernel::Triangle_3;
  using Shape = std::variant<Point, Segment, Face>;

  const Point& at(VertexId v) const { return points_[v.value]; }

  Shape shape(const Triangle& t) const {
    std::array<Point, 3> p = {at(t[0]), at(t[1]), at(t[2])};
    if (!CGAL::collinear(p[0], p[1], p[2])) return Face(p[0], p[1], p[2]);
    std::sort(p.begin(), p.end());
    if (p[0] == p[2]) return p[0];
    return Segment(p[0], p[2]);
  }

  struct Corners {
    using result_type = std::vector<Point>;
    result_type operator()(const Point& p) const { return {p}; }
    result_type operator()(const Segment& s) const { return {s.source(), s.target()}; }
    result_type operator()(const Face& t) const { return {t[0], t[1], t[2]}; }
    result_type operator()(const std::vector<Point>& polygon) const { return polygon; }
  };

  template <class A, class B>
  static std::vector<Point> corners_of_common_part(const A& a, const B& b) {
    const auto common = CGAL::intersection(a, b);
    if (!common) return {};
    return boost::apply_visitor(Corners(), *common);
  }
  static std::vector<Point> corners_of_common_part(const Point& a, const Point& b) {
    return a == b ? std::vector<Point>{a} : std::vector<Point>{};
  }
  template <class B>
  static std::vector<Point> corners_of_common_part(const Point& a, const B& b) {
    return b.has_on(a) ? std::vector<Point>{a} : std::vector<Point>{};
  }
  template <class A>
  static std::vector<Point> corners_of_common_part(const A& a, const Point& b) {
    return corners_of_common_part(b, a);
  }

  std::vector<Point> points_;
};

}  // namespace remesh
