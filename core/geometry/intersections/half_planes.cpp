#include "core/geometry/intersections/half_planes.h"

#include <algorithm>
#include <optional>

#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"

namespace remesh {
namespace {

/// The number of comparisons between two checks for cancellation.
constexpr std::uint32_t kComparisonsBetweenChecks = 1 << 16;

/// The sign of the area of abc, seen along an axis.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return orient2d({a[u], a[v]}, {b[u], b[v]}, {c[u], c[v]});
}

/// The half-planes about a line, in their order around it, from that of the first point on.
class HalfPlanes {
 public:
  HalfPlanes(const Vec3& from, const Vec3& to) : from_(from), to_(to) {}

  /// Parts of space, ascending: three parts of the line, and four parts around it. Of the latter, kFirstHalfPlane and
  /// kOppositeHalfPlane are one half-plane each.
  enum Part { kBefore, kBetween, kBeyond, kFirstHalfPlane, kUpper, kOppositeHalfPlane, kLower };

  Part part_of(const Vec3& p) {
    int axis = 0;
    while (axis < 3 && orientation(from_, to_, p, axis) == 0) ++axis;
    if (axis == 3) {
      const auto [low, high] = std::minmax(from_, to_);
      return p < low ? kBefore : p > high ? kBeyond : kBetween;
    }
    if (!first_) {
      first_ = p;
      axis_ = axis;
      turn_ = orientation(from_, to_, p, axis);
    }
    const int side = orient3d(from_, to_, *first_, p);
    if (side != 0) return side > 0 ? kUpper : kLower;
    return orientation(from_, to_, p, axis_) == turn_ ? kFirstHalfPlane : kOppositeHalfPlane;
  }
  /// Compares two points in kUpper, or two in kLower: > 0 if the half-plane of `a` comes before that of `b`, 0 if they
  /// are in the same one.
  int order(const Vec3& a, const Vec3& b) const { return orient3d(from_, to_, a, b); }

 private:
  Vec3 from_, to_;
  std::optional<Vec3> first_;
  /// The axis along which the first half-plane is seen, and its orientation as seen along it.
  int axis_ = 0, turn_ = 0;
};

}  // namespace

std::vector<std::uint32_t> group_by_half_plane(const Vec3& from, const Vec3& to, std::span<const Vec3> positions,
                                               std::vector<Page>& pages, RunControl& control) {
  struct Placed {
    Page page;
    HalfPlanes::Part part;
  };
  HalfPlanes half_planes(from, to);
  std::vector<Placed> placed;
  placed.reserve(pages.size());
  for (const Page& page : pages) placed.push_back({page, half_planes.part_of(positions[page.apex.value])});
  std::uint32_t comparisons = 0;
  const auto order = [&](const Placed& a, const Placed& b) {
    if (++comparisons % kComparisonsBetweenChecks == 0) control.check_and_move();
    if (a.part != b.part) return a.part < b.part ? 1 : -1;
    const bool is_one_half_plane = a.part != HalfPlanes::kUpper && a.part != HalfPlanes::kLower;
    return is_one_half_plane ? 0 : half_planes.order(positions[a.page.apex.value], positions[b.page.apex.value]);
  };
  std::sort(placed.begin(), placed.end(), [&](const Placed& a, const Placed& b) {
    const int sign = order(a, b);
    return sign != 0 ? sign > 0 : a.page.face < b.page.face;
  });
  std::vector<std::uint32_t> ends;
  for (std::uint32_t i = 0; i < placed.size(); ++i) {
    pages[i] = placed[i].page;
    const bool is_last = i + 1 == placed.size() || order(placed[i], placed[i + 1]) != 0;
    if (is_last || placed[i].part == HalfPlanes::kBetween) ends.push_back(i + 1);
  }
  return ends;
}

}  // namespace remesh
