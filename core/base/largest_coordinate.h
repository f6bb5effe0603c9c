/// The size of a set of points. Points are scaled by it before anything can overflow.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// The largest absolute value of a point's coordinates.
inline double largest_coordinate(const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

/// The largest absolute value along each axis; 0 if there are no points.
/// Cost:   O(n), on the caller's TBB arena.
inline Vec3 largest_of_each_axis(std::span<const Vec3> points, RunControl& control) {
  constexpr std::size_t kBlock = 1 << 14;
  // Each axis has a maximum of its own. So three chains of comparisons run at once, and none waits for another.
  const auto add = [](Vec3& m, const Vec3& p) {
    m.x = std::max(m.x, std::fabs(p.x));
    m.y = std::max(m.y, std::fabs(p.y));
    m.z = std::max(m.z, std::fabs(p.z));
  };
  const auto largest = map_blocks<Vec3>(points.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    Vec3 m;
    for (std::size_t i = begin; i < end; ++i) add(m, points[i]);
    return m;
  });
  Vec3 all;
  for (const Vec3& m : largest) add(all, m);
  return all;
}

/// The largest absolute value of all points' coordinates; 0 if there are no points.
/// Cost:   O(n), on the caller's TBB arena.
inline double largest_coordinate(std::span<const Vec3> points, RunControl& control) {
  return largest_coordinate(largest_of_each_axis(points, control));
}

}  // namespace remesh
