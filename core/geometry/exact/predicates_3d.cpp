#include "core/geometry/exact/predicates_3d.h"

#include <algorithm>
#include <array>

#include "core/base/blocks.h"
#include "core/base/largest_coordinate.h"
#include "core/base/prefault_pages.h"
#include "core/geometry/exact/expansion.h"
#include "core/geometry/exact/twofold.h"

namespace remesh {
namespace {

constexpr std::size_t kPredicateBlock = 1 << 14;

/// An axis along which coordinates are smaller by more than this power of two is stretched until they are not.
constexpr int kMaxNarrower = 10;

using exact::Twofold;

/// The sign of orient3d if numbers of twice the usual precision are sure of it, otherwise 0. Nearly all points that lie
/// within the rounding of one plane are told apart by it, in a sixth of the time of expansions.
int twofold_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  using Vector = std::array<Twofold, 3>;
  const auto from_a = [&](const Vec3& p) {
    return Vector{exact::two_sum(p.x, -a.x), exact::two_sum(p.y, -a.y), exact::two_sum(p.z, -a.z)};
  };
  const Vector ab = from_a(b), ac = from_a(c), ad = from_a(d);
  double magnitude = 0;
  const auto term = [&](const Vector& p, const Vector& q, const Vector& r) {
    const Twofold left = product(p[0], q[1]), right = product(q[0], p[1]);
    magnitude += std::fabs(r[2].value) * (std::fabs(left.value) + std::fabs(right.value));
    return product(sum(left, negative(right)), r[2]);
  };
  const Twofold determinant = sum(sum(term(ab, ac, ad), term(ac, ad, ab)), term(ad, ab, ac));
  // A term goes through two products and three sums at most, which is less than 24 u^2, and the magnitude is rounded.
  constexpr double kErrorBound = 32 * 0x1p-106;
  return determinant.value > kErrorBound * magnitude ? 1 : determinant.value < -kErrorBound * magnitude ? -1 : 0;
}

}  // namespace

namespace exact {

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Points in one plane at right angles to an axis are frequent, and expansions would take a hundred times as long.
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
  const int sign = twofold_orient3d(a, b, c, d);
  if (sign != 0) return sign;
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
  std::vector<Vec3> scaled;
  reserve_pages(scaled, positions.size(), control);
  scaled.assign(positions.begin(), positions.end());
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
