#include "tests/bench/surface_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <queue>
#include <stdexcept>

#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive_3.h>

namespace remesh::bench {
namespace {

using Point = DistanceKernel::Point_3;
using Vector = DistanceKernel::Vector_3;
using Triangles = std::vector<DistanceTriangle>;
using Tree = CGAL::AABB_tree<
    CGAL::AABB_traits_3<DistanceKernel, CGAL::AABB_triangle_primitive_3<DistanceKernel, Triangles::const_iterator>>>;

constexpr double kAccuracy = 0.01;
/// A part is cut along the side of a facet if both halves are at least this wide, as a fraction of the part's size. So
/// parts do not become too thin.
constexpr double kMinHalf = 0.05;
constexpr std::size_t kMaxParts = 50'000'000;

double length(const Vector& v) { return std::sqrt(v.squared_length()); }

double size_of(const DistanceTriangle& t) {
  return std::sqrt(
      std::max({squared_distance(t[0], t[1]), squared_distance(t[1], t[2]), squared_distance(t[2], t[0])}));
}

Triangles with_area(const Triangles& triangles) {
  Triangles kept;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(kept),
               [](const DistanceTriangle& t) { return t.squared_area() > 0; });
  if (kept.empty()) throw std::runtime_error("a surface without triangles");
  return kept;
}

struct Part {
  double upper;
  Triangles::const_iterator facet;  ///< the facet nearest to the part's centroid
  DistanceTriangle corners;
  bool operator<(const Part& other) const { return upper < other.upper; }
};

/// The search in one direction.
class Search {
 public:
  explicit Search(const Tree& tree) : tree_(tree) {}

  SurfaceDistance run(const Triangles& from, double enough, double too_far) {
    for (const DistanceTriangle& t : from) push(t);
    while (lower_ <= too_far && parts_.top().upper > std::max(enough, (1 + kAccuracy) * lower_)) {
      if (++cuts_ > kMaxParts) throw std::runtime_error("the distance takes too long to measure");
      const Part part = parts_.top();
      parts_.pop();
      if (!cut_along_a_side(part)) cut_in_the_middle(part.corners);
    }
    return {lower_, std::max(lower_, parts_.top().upper)};
  }

 private:
  void push(const DistanceTriangle& t) {
    const Point centre = centroid(t);
    const auto [nearest, facet] = tree_.closest_point_and_primitive(centre);
    const double here = std::sqrt(squared_distance(centre, nearest));
    lower_ = std::max(lower_, here);
    double radius = 0, at_corners = 0;
    for (int i = 0; i < 3; ++i) {
      radius = std::max(radius, std::sqrt(squared_distance(centre, t[i])));
      at_corners = std::max(at_corners, std::sqrt(squared_distance(t[i], *facet)));
    }
    parts_.push({std::min(here + radius, at_corners), facet, t});
  }

  /// Cuts a part along the plane that stands on a side of its facet. Beside that side another facet is nearest.
  /// Output: false if no such plane divides the part well.
  bool cut_along_a_side(const Part& part) {
    const DistanceTriangle& facet = *part.facet;
    const Vector normal = cross_product(facet[1] - facet[0], facet[2] - facet[0]);
    std::array<double, 3> best{};
    double widest = kMinHalf * size_of(part.corners);
    for (int side = 0; side < 3; ++side) {
      Vector outward = cross_product(facet[side + 1] - facet[side], normal);
      outward = outward / length(outward);
      std::array<double, 3> beyond{};
      for (int i = 0; i < 3; ++i) beyond[i] = outward * (part.corners[i] - facet[side]);
      const auto [least, largest] = std::minmax_element(beyond.begin(), beyond.end());
      const double narrow = std::min(-*least, *largest);
      if (narrow > widest) widest = narrow, best = beyond;
    }
    if (best == std::array<double, 3>{}) return false;
    cut(part.corners, best);
    return true;
  }

  /// Cuts a triangle where a function that is linear on it is zero.
  void cut(const DistanceTriangle& t, const std::array<double, 3>& values) {
    // The corner that is alone on its side.
    int alone = 0;
    for (int i = 0; i < 3; ++i)
      if ((values[i] > 0) != (values[(i + 1) % 3] > 0) && (values[i] > 0) != (values[(i + 2) % 3] > 0)) alone = i;
    const int b = (alone + 1) % 3, c = (alone + 2) % 3;
    const auto crossing = [&](int i) {
      return t[alone] + values[alone] / (values[alone] - values[i]) * (t[i] - t[alone]);
    };
    const Point on_b = crossing(b), on_c = crossing(c);
    push({t[alone], on_b, on_c});
    push({on_b, t[b], t[c]});
    push({on_b, t[c], on_c});
  }

  void cut_in_the_middle(const DistanceTriangle& t) {
    int longest = 0;
    for (int i = 1; i < 3; ++i)
      if (squared_distance(t[i], t[i + 1]) > squared_distance(t[longest], t[longest + 1])) longest = i;
    const Point a = t[longest], b = t[longest + 1], c = t[longest + 2], middle = midpoint(a, b);
    push({a, middle, c});
    push({middle, b, c});
  }

  const Tree& tree_;
  std::priority_queue<Part> parts_;
  double lower_ = 0;
  std::size_t cuts_ = 0;
};

SurfaceDistance distance_from(const Triangles& from, const Triangles& to, double enough, double too_far) {
  Tree tree(to.begin(), to.end());
  tree.accelerate_distance_queries();
  return Search(tree).run(from, enough, too_far);
}

}  // namespace

SurfaceDistance distance_between(const Triangles& a, const Triangles& b, double enough, double too_far) {
  const Triangles first = with_area(a), second = with_area(b);
  const SurfaceDistance there = distance_from(first, second, enough, too_far);
  if (there.lower > too_far) return there;
  // Distances below that of the other direction do not count.
  const SurfaceDistance back = distance_from(second, first, std::max(enough, (1 + kAccuracy) * there.lower), too_far);
  return {std::max(there.lower, back.lower), std::max(there.upper, back.upper)};
}

}  // namespace remesh::bench
