/// The size of a set of points. Points are scaled by it before anything can overflow.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// The largest absolute value of a point's coordinates.
inline double largest_coordinate(const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

/// The largest absolute value of all points' coordinates; 0 if there are no points.
/// Cost:   O(n), on the caller's TBB arena.
inline double largest_coordinate(std::span<const Vec3> points, RunControl& control) {
  constexpr std::size_t kBlock = 1 << 14;
  const auto largest = map_blocks<double>(points.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    // Each axis has a maximum of its own. So three chains of comparisons run at once, and none waits for another.
    Vec3 m;
    for (std::size_t i = begin; i < end; ++i) {
      m.x = std::max(m.x, std::fabs(points[i].x));
      m.y = std::max(m.y, std::fabs(points[i].y));
      m.z = std::max(m.z, std::fabs(points[i].z));
    }
    return largest_coordinate(m);
  });
  return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

}  // namespace remesh
