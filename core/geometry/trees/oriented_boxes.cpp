#include "core/geometry/trees/oriented_boxes.h"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/loop_progress.h"
#include "core/geometry/planes/plane_fit.h"

namespace remesh {
namespace {

/// The slack of all tests, relative to the largest coordinate. It is far more than the rounding error of products with
/// unit vectors, and of the axes themselves.
constexpr double kTurnRounding = 0x1p-40;

/// If there are more triangles, the axes are computed from this many of them.
constexpr std::size_t kSamples = 16;

constexpr int kRounds = 2;

/// The number of slots between two checks for cancellation.
constexpr std::size_t kSlotsBetweenChecks = 1 << 16;

/// Reduces `points` to the corners of their convex hull, counter-clockwise, up to rounding.
void reduce_to_hull(std::vector<Vec2>& points) {
  std::sort(points.begin(), points.end());
  std::vector<Vec2> hull;
  hull.reserve(2 * points.size());
  const auto add = [&](std::size_t first, Vec2 p) {
    while (hull.size() >= first + 2 && !(cross(hull.back() - hull.end()[-2], p - hull.back()) > 0)) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2& p : points) add(0, p);
  const std::size_t upper = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(upper, points[i]);
  hull.pop_back();
  points = std::move(hull);
}

/// Turns the other two axes about this one so that the rectangle along them that holds the points is as small as
/// possible. One of its sides lies on a side of the convex hull. The size takes both area and perimeter into account,
/// because for a triangle all three candidates have the same area.
void turn_about(std::size_t axis, std::span<const Vec3> points, std::vector<Vec2>& flat, std::array<Vec3, 3>& axes) {
  const Vec3 u = axes[(axis + 1) % 3], v = axes[(axis + 2) % 3];
  flat.clear();
  for (const Vec3& p : points) flat.push_back({dot(u, p), dot(v, p)});
  reduce_to_hull(flat);
  double least_size = HUGE_VAL;
  Vec2 best{1, 0};
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const Vec2 side = flat[(i + 1) % flat.size()] - flat[i];
    const double length = norm(side);
    if (!(length > 0)) continue;
    const Vec2 along{side.x / length, side.y / length};
    double least = HUGE_VAL, most = -HUGE_VAL, height = 0;
    for (const Vec2& p : flat) {
      const Vec2 way = p - flat[i];
      least = std::min(least, dot(along, way));
      most = std::max(most, dot(along, way));
      height = std::max(height, cross(along, way));
    }
    const double width = most - least, size = width * height * (width + height);
    if (size >= least_size) continue;
    least_size = size;
    best = along;
  }
  axes[(axis + 1) % 3] = best.x * u + best.y * v;
  axes[(axis + 2) % 3] = best.x * v - best.y * u;
}

}  // namespace

OrientedBoxes::OrientedBoxes(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces,
                             double margin, RunControl& control)
    : positions_(positions),
      margin_(margin + kTurnRounding * largest_coordinate(positions, control)),
      boxes_(tree.node_count()) {
  // The nodes of one level are computed in parallel. Many small nodes share a task, and each large node has one of its
  // own.
  constexpr std::size_t kBlock = 4096;
  LoopProgress progress(control, boxes_.size());
  for (std::size_t begin = 0, nodes = 1; begin < boxes_.size(); begin += nodes, nodes *= 2)
    for_blocks(nodes, std::max<std::size_t>(1, nodes * kBlock / (tree.size() + 1)), control,
               [&](std::size_t j, std::size_t end) {
                 const std::size_t first = j;
                 for (; j < end; ++j) boxes_[begin + j] = box_of(tree, begin + j, faces, control);
                 progress.add(end - first);
               });
}

OrientedBoxes::Box OrientedBoxes::box_of(const TriangleTree& tree, std::size_t node, std::span<const Triangle> faces,
                                         RunControl& control) const {
  const auto [first, last] = tree.slots(node);
  Box box;
  if (first == last) return box;
  const auto corners = [&](std::size_t slot) {
    const Triangle& face = faces[tree.face(slot).value];
    return std::array{positions_[face[0].value], positions_[face[1].value], positions_[face[2].value]};
  };
  const Vec3 origin = positions_[faces[tree.face(first).value][0].value];
  PointMoments moments;
  const std::size_t step = std::max<std::size_t>(1, (last - first) / kSamples);
  std::vector<Vec3> samples;
  for (std::size_t slot = first; slot < last; slot += step)
    for (const Vec3& p : corners(slot)) samples.push_back(p - origin);
  for (const Vec3& p : samples) moments.add(p);
  box.axes = principal_axes(moments).axes;
  // These axes follow what is flat or long in the points. A square cross-section leaves two axes undetermined, so these
  // are turned.
  std::vector<Vec2> flat;
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t axis = 0; axis < 3; ++axis) turn_about(axis, samples, flat, box.axes);

  std::array<double, 3> least, most;
  least.fill(HUGE_VAL);
  most.fill(-HUGE_VAL);
  for (std::size_t slot = first; slot < last; ++slot) {
    if ((slot - first) % kSlotsBetweenChecks == 0) control.check_and_move();
    for (const Vec3& p : corners(slot))
      for (std::size_t i = 0; i < 3; ++i) {
        const double along = dot(box.axes[i], p - origin);
        least[i] = std::min(least[i], along);
        most[i] = std::max(most[i], along);
      }
  }
  box.centre = origin;
  for (std::size_t i = 0; i < 3; ++i) {
    box.centre += 0.5 * (least[i] + most[i]) * box.axes[i];
    box.extents[i] = 0.5 * (most[i] - least[i]);
  }
  return box;
}

OrientedBoxes::Query OrientedBoxes::query(const Triangle& face) const {
  Query triangle;
  for (std::size_t i = 0; i < 3; ++i) triangle.corners[i] = positions_[face[i].value];
  for (std::size_t i = 0; i < 3; ++i) triangle.edges[i] = triangle.corners[(i + 1) % 3] - triangle.corners[i];
  triangle.normal = cross(triangle.edges[0], triangle.edges[1]);
  return triangle;
}

bool OrientedBoxes::are_apart(const Query& triangle, std::size_t node) const {
  const Box& box = boxes_[node];
  const std::array<Vec3, 3> p{triangle.corners[0] - box.centre, triangle.corners[1] - box.centre,
                              triangle.corners[2] - box.centre};
  // Any direction may serve as a separating axis, so rounding in its computation does no harm.
  const auto is_apart_along = [&](const Vec3& way, double reach) {
    const auto [least, most] = std::minmax({dot(way, p[0]), dot(way, p[1]), dot(way, p[2])});
    const double doubt = margin_ * (std::fabs(way.x) + std::fabs(way.y) + std::fabs(way.z));
    return least > reach + doubt || -most > reach + doubt;
  };
  const auto reach = [&](const Vec3& way) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += box.extents[i] * std::fabs(dot(box.axes[i], way));
    return sum;
  };
  for (std::size_t i = 0; i < 3; ++i)
    if (is_apart_along(box.axes[i], box.extents[i])) return true;
  if (is_apart_along(triangle.normal, reach(triangle.normal))) return true;
  for (const Vec3& edge : triangle.edges)
    for (const Vec3& axis : box.axes) {
      const Vec3 way = cross(edge, axis);
      if (is_apart_along(way, reach(way))) return true;
    }
  return false;
}

}  // namespace remesh
