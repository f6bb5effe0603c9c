#include "tests/support/hausdorff.h"

#include <algorithm>
#include <cmath>

namespace remesh::test {

double hausdorff_one_way(const std::vector<Corners3>& from, const std::vector<Corners3>& to, double accuracy) {
  struct Ball {
    Vec3 centre;
    double radius;
  };
  const auto ball_of = [](const Corners3& t) {
    const Vec3 centre = (1.0 / 3) * (t[0] + t[1] + t[2]);
    return Ball{centre, std::max({norm(t[0] - centre), norm(t[1] - centre), norm(t[2] - centre)})};
  };
  std::vector<Ball> balls;
  for (const Corners3& t : to) balls.push_back(ball_of(t));
  const auto distance = [](const Vec3& p, const Corners3& t) { return norm(nearest_on_triangle(p, t) - p); };
  struct Piece {
    double upper;
    Corners3 corners;
    bool operator<(const Piece& other) const { return upper < other.upper; }
  };
  double lower = 0;
  std::vector<Piece> heap;
  const auto push = [&](const Corners3& t) {
    const Ball ball = ball_of(t);
    double upper = HUGE_VAL, here = HUGE_VAL;
    for (std::size_t s = 0; s < to.size(); ++s) {
      if (norm(balls[s].centre - ball.centre) - balls[s].radius - ball.radius > std::min(here, upper)) continue;
      here = std::min(here, distance(ball.centre, to[s]));
      double largest = 0;
      for (const Vec3& p : t) largest = std::max(largest, largest < upper ? distance(p, to[s]) : 0);
      upper = std::min(upper, largest);
    }
    lower = std::max(lower, here);
    heap.push_back({upper, t});
    std::push_heap(heap.begin(), heap.end());
  };
  for (const Corners3& t : from) push(t);
  while (heap.front().upper > lower + accuracy) {
    std::pop_heap(heap.begin(), heap.end());
    const auto [a, b, c] = heap.back().corners;
    heap.pop_back();
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    for (const Corners3& part : {Corners3{a, ab, ca}, Corners3{ab, b, bc}, Corners3{ca, bc, c}, Corners3{ab, bc, ca}})
      push(part);
  }
  return lower;
}

double hausdorff(const std::vector<Corners3>& a, const std::vector<Corners3>& b, double accuracy) {
  return std::max(hausdorff_one_way(a, b, accuracy), hausdorff_one_way(b, a, accuracy));
}

}  // namespace remesh::test
