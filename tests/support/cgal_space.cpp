#include "tests/support/cgal_space.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <variant>
#include <vector>

namespace remesh {
namespace {

template <class Kernel>
typename Kernel::Point_3 point(const Vec3& p) {
  return {p.x, p.y, p.z};
}

using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Doubles = CGAL::Simple_cartesian<double>;

Doubles::Triangle_3 triangle(const Corners3& t) {
  return {point<Doubles>(t[0]), point<Doubles>(t[1]), point<Doubles>(t[2])};
}

using Fractions = CGAL::Simple_cartesian<CGAL::Gmpq>;
using Point = Fractions::Point_3;
using Side = Fractions::Segment_3;
using Face = Fractions::Triangle_3;
using Shape = std::variant<Point, Side, Face>;

struct Corners {
  using result_type = std::vector<Point>;
  result_type operator()(const Point& p) const { return {p}; }
  result_type operator()(const Side& s) const { return {s.source(), s.target()}; }
  result_type operator()(const Face& t) const { return {t[0], t[1], t[2]}; }
  result_type operator()(const std::vector<Point>& polygon) const { return polygon; }
};

template <class A, class B>
std::vector<Point> corners_of_common_part(const A& a, const B& b) {
  const auto common = CGAL::intersection(a, b);
  if (!common) return {};
  return boost::apply_visitor(Corners(), *common);
}
std::vector<Point> corners_of_common_part(const Point& a, const Point& b) {
  return a == b ? std::vector<Point>{a} : std::vector<Point>{};
}
template <class B>
std::vector<Point> corners_of_common_part(const Point& a, const B& b) {
  return b.has_on(a) ? std::vector<Point>{a} : std::vector<Point>{};
}
template <class A>
std::vector<Point> corners_of_common_part(const A& a, const Point& b) {
  return corners_of_common_part(b, a);
}

}  // namespace

int cgal_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return CGAL::orientation(point<Predicates>(a), point<Predicates>(b), point<Predicates>(c), point<Predicates>(d));
}

bool cgal_is_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  return CGAL::collinear(point<Predicates>(a), point<Predicates>(b), point<Predicates>(c));
}

double cgal_squared_distance(const Vec3& p, const Corners3& t) {
  return CGAL::squared_distance(point<Doubles>(p), triangle(t));
}

double cgal_squared_distance(const Corners3& s, const Corners3& t) {
  return CGAL::squared_distance(triangle(s), triangle(t));
}

struct CgalIntersection::Points {
  const Point& at(VertexId v) const { return list[v.value]; }

  Shape shape(const Triangle& t) const {
    std::array<Point, 3> p = {at(t[0]), at(t[1]), at(t[2])};
    if (!CGAL::collinear(p[0], p[1], p[2])) return Face(p[0], p[1], p[2]);
    std::sort(p.begin(), p.end());
    if (p[0] == p[2]) return p[0];
    return Side(p[0], p[2]);
  }

  std::vector<Point> list;
};

CgalIntersection::CgalIntersection(std::span<const Vec3> positions) {
  Points points;
  for (const Vec3& p : positions) points.list.push_back(point<Fractions>(p));
  points_ = std::make_unique<const Points>(std::move(points));
}

CgalIntersection::~CgalIntersection() = default;

bool CgalIntersection::operator()(const Triangle& f, const Triangle& g) const {
  const std::vector<Point> common = std::visit(
      [](const auto& a, const auto& b) { return corners_of_common_part(a, b); }, points_->shape(f), points_->shape(g));
  if (common.empty()) return false;
  // The common part is convex, so shared corners and edges cover it only if one of them contains all of it.
  std::set<VertexId> shared;
  for (const VertexId v : f)
    if (std::find(g.begin(), g.end(), v) != g.end()) shared.insert(v);
  const auto is_all_between = [&](VertexId v, VertexId w) {
    const Point &from = points_->at(v), &to = points_->at(w);
    return std::all_of(common.begin(), common.end(),
                       [&](const Point& p) { return Side(from, to).has_on(p) || p == from; });
  };
  for (const VertexId v : shared)
    for (const VertexId w : shared)
      if (is_all_between(v, w)) return false;
  return true;
}

bool CgalIntersection::has_area(const Triangle& t) const { return std::holds_alternative<Face>(points_->shape(t)); }

}  // namespace remesh
