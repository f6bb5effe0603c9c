#include "core/free_form/input_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace remesh {
namespace {

/// Returns the square of the distance of p from a triangle. Walks and searches spend most of their time here.
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, way = p - a;
  const Vec3 normal = cross(ab, ac);
  const double squared = norm_squared(normal);
  const double of_b = dot(cross(way, ac), normal), of_c = dot(cross(ab, way), normal), of_a = squared - of_b - of_c;
  if (squared > 0 && of_a >= 0 && of_b >= 0 && of_c >= 0) {
    const double height = dot(way, normal);
    return height * height / squared;
  }
  double least = HUGE_VAL;
  // Only the sides count that p is beyond. A needle has none for which that is known.
  if (!(of_b > 0)) least = std::min(least, norm_squared(nearest_on_segment(p, a, c) - p));
  if (!(of_c > 0)) least = std::min(least, norm_squared(nearest_on_segment(p, a, b) - p));
  if (!(of_a > 0)) least = std::min(least, norm_squared(nearest_on_segment(p, b, c) - p));
  return least;
}

}  // namespace

double InputSurface::squared_distance_to(FaceId f, const Vec3& p) const {
  const Triangle& t = faces_[f];
  return squared_distance(p, positions_[t[0]], positions_[t[1]], positions_[t[2]]);
}

InputSurface::InputSurface(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces,
                           std::span<const std::uint32_t> twins, std::span<const float> shares, RunControl& control)
    : positions_(positions), faces_(faces), twins_(twins), shares_(shares) {
  control.memory().ask_for<BoxTree<NoTag>::Entry>(3 * faces.size());
  const auto entries = BoxTree<NoTag>::make_entries(faces.size(), control, [&](std::size_t i, auto& entry) {
    for (const Vec3& p : corners(FaceId(i))) entry.box.add(p);
  });
  tree_ = BoxTree<NoTag>(entries, control);
}

/// Walks to neighbours with a smaller measure until it is at most `enough`, or no neighbour has a smaller one.
template <class Measure>
FaceId InputSurface::walk(FaceId start, double enough, const Measure& measure) const {
  constexpr int kMaxSteps = 32;
  double best = measure(start);
  FaceId at = start, from = start;
  for (int step = 0; step < kMaxSteps && best > enough; ++step) {
    FaceId better;
    for (std::uint32_t h = 3 * at.value; h < 3 * at.value + 3; ++h) {
      if (twins_[h] == kNone) continue;
      const FaceId g(twins_[h] / 3);
      if (g == from) continue;
      const double here = measure(g);
      if (here < best) {
        best = here;
        better = g;
      }
    }
    if (!better.is_valid()) break;
    from = std::exchange(at, better);
  }
  return at;
}

FaceId InputSurface::near_face(const Vec3& p, FaceId start, double tolerance) const {
  const double near = tolerance * tolerance;
  const auto measure = [&](FaceId f) { return squared_multiple(f, p); };
  const FaceId at = walk(start, near, measure);
  return measure(at) <= near ? at : search(p, std::nextafter(near, HUGE_VAL), FaceId(), measure);
}

Vec3 InputSurface::near_place(const Vec3& p, FaceId start) const {
  const FaceId at = walk(start, 0, [&](FaceId f) { return squared_distance_to(f, p); });
  return nearest_on_triangle(p, corners(at));
}

FaceId InputSurface::nearest_face(const Vec3& p, FaceId start) const {
  return search(p, squared_distance_to(start, p), start, [&](FaceId f) { return squared_distance_to(f, p); });
}

/// Returns the face with the smallest measure, which is at least its squared distance, if that is below `squared`.
template <class Measure>
FaceId InputSurface::search(const Vec3& p, double squared, FaceId otherwise, const Measure& measure) const {
  FaceId found = otherwise;
  tree_.search(
      squared, [&](const BoxTree<NoTag>::Entry& entry) { return remesh::squared_distance(entry.box, p); },
      [&](std::size_t slot) {
        const FaceId f(tree_.number(slot));
        const double d = measure(f);
        if (d < squared) {
          squared = d;
          found = f;
        }
      });
  return found;
}

}  // namespace remesh
