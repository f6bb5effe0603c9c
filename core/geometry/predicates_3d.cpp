#include "core/geometry/predicates_3d.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/geometry/expansion.h"

namespace remesh {
namespace {

constexpr std::size_t kPredicateBlock = 1 << 14;

/// An axis along which coordinates are smaller by more than this power of two is stretched until they are not.
constexpr int kMaxNarrower = 10;

}  // namespace

namespace exact {

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Points in one plane at right angles to an axis are frequent, and expansions would take a hundred times as long.
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
  const auto ab_x = difference(b.x, a.x), ab_y = difference(b.y, a.y), ab_z = difference(b.z, a.z);
  const auto ac_x = difference(c.x, a.x), ac_y = difference(c.y, a.y), ac_z = difference(c.z, a.z);
  const auto ad_x = difference(d.x, a.x), ad_y = difference(d.y, a.y), ad_z = difference(d.z, a.z);
  const auto bc = ab_x * ac_y - ac_x * ab_y;
  const auto cd = ac_x * ad_y - ad_x * ac_y;
  const auto db = ad_x * ab_y - ab_x * ad_y;
  return (bc * ad_z + cd * ab_z + db * ac_z).sign();
}

}  // namespace exact

std::vector<Vec3> scaled_for_predicates(std::span<const Vec3> positions, RunControl& control) {
  const Vec3 largest = largest_of_each_axis(positions, control);
  const double largest_of_all = largest_coordinate(largest);
  std::vector<Vec3> scaled(positions.begin(), positions.end());
  if (largest_of_all == 0) return scaled;
  // The factor itself may be out of range, so the positions are multiplied in two steps. For a large coordinate, the
  // first step is exact.
  Vec3 first{1, 1, 1}, second{1, 1, 1};
  const int shift_of_all = 249 - std::ilogb(largest_of_all);
  for (int axis = 0; axis < 3; ++axis) {
    if (largest[axis] == 0) continue;
    const int narrower = std::ilogb(largest_of_all) - std::ilogb(largest[axis]);
    const int shift = shift_of_all + std::max(0, narrower - kMaxNarrower);
    first[axis] = std::ldexp(1, shift / 2);
    second[axis] = std::ldexp(1, shift - shift / 2);
  }
  for_blocks(scaled.size(), kPredicateBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (int axis = 0; axis < 3; ++axis) scaled[v][axis] = second[axis] * (first[axis] * scaled[v][axis]);
  });
  return scaled;
}

}  // namespace remesh
