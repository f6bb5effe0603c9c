#include "core/geometry/shells/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The largest distance of a point to any point of the box.
double reach(const Vec3& p, const Box3& box) {
  const auto along = [&](int axis) { return std::max(p[axis] - box.min[axis], box.max[axis] - p[axis]); };
  return norm(Vec3{along(0), along(1), along(2)});
}

}  // namespace

WindingNumber::WindingNumber(std::span<const Vec3> positions, std::span<const Triangle> triangles, RunControl& control)
    : positions_(positions), triangles_(triangles), control_(control), tree_(positions, triangles, control) {
  nodes_ = tree_.joined<Node>([&](std::size_t slot) { return node_of(slot); },
                              [](const Node& a, const Node& b) {
                                Node both = a;
                                both.box.add(b.box);
                                both.twice_area += b.twice_area;
                                both.moment += b.moment;
                                both.twice_sizes += b.twice_sizes;
                                return both;
                              },
                              control);
}

WindingNumber::Node WindingNumber::node_of(std::size_t slot) const {
  const Triangle& t = triangles_[tree_.face(slot).value];
  const Vec3 &a = positions_[t[0].value], &b = positions_[t[1].value], &c = positions_[t[2].value];
  const Vec3 twice_area = cross(b - a, c - a);
  const double size = norm(twice_area);
  constexpr double kThird = 1.0 / 3;
  return {tree_.box(slot), twice_area, size * (kThird * a + kThird * b + kThird * c), size};
}

double solid_angle(const Corners3& triangle, const Vec3& p) {
  const Vec3 a = normalized(triangle[0] - p), b = normalized(triangle[1] - p), c = normalized(triangle[2] - p);
  return 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

double WindingNumber::at(const Vec3& p, double far) const {
  StopCheck check(control_);
  double sum = 0;
  std::array<std::size_t, 2 * SlotTree::kMaxLevels> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    check();
    const std::size_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!(node.twice_sizes > 0)) continue;
    const Vec3 centre = (1 / node.twice_sizes) * node.moment, way = centre - p;
    const double distance = norm(way);
    if (distance > far * reach(centre, node.box)) {
      sum += dot((0.5 / distance) * node.twice_area, (1 / distance) * normalized(way));
      continue;
    }
    // Nodes are numbered as in a heap, so that the children of node i are 2i + 1 and 2i + 2.
    if (const std::size_t child = 2 * index + 1; child < nodes_.size()) {
      stack[depth++] = child + 1;
      stack[depth++] = child;
      continue;
    }
    const auto [begin, end] = tree_.slots(index);
    for (std::size_t slot = begin; slot < end; ++slot) {
      const Triangle& t = triangles_[tree_.face(slot).value];
      sum += solid_angle({positions_[t[0].value], positions_[t[1].value], positions_[t[2].value]}, p);
    }
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace remesh
