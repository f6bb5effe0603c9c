#include "core/patches/charts/patch_locator.h"

#include <algorithm>
#include <cmath>

#include "core/base/blocks.h"
#include "core/mending/polygons/polygon_split.h"

namespace remesh {
namespace {

/// An upper bound on the error of distances. Boxes count as nearer by this error, so that the search passes over no
/// triangle as near as the best one, and the answer does not depend on the order of the search.
constexpr double kRoundingInSpace = 0x1p-48;

Vec3 in_space(Vec2 p) { return {p.x, p.y, 0}; }

double distance_to_segment(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 ab = b - a;
  const double length_squared = dot(ab, ab);
  const double t = length_squared > 0 ? std::clamp(dot(p - a, ab) / length_squared, 0.0, 1.0) : 0.0;
  return norm(p - (a + t * ab));
}

/// The distance of a point from the rim of a triangle, or 0 inside it. The triangle may have either orientation.
double distance_to_triangle(const std::array<Vec2, 3>& t, Vec2 p) {
  int left = 0, right = 0;
  double distance = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    const Vec2 a = t[i], b = t[(i + 1) % 3];
    const double side = cross(b - a, p - a);
    left += side >= 0;
    right += side <= 0;
    distance = std::min(distance, distance_to_segment(a, b, p));
  }
  return left == 3 || right == 3 ? 0 : distance;
}

}  // namespace

PatchLocator::PatchLocator(const Surface& surface, std::span<const FaceId> faces, const PatchChart& chart,
                           RunControl& control)
    : surface_(surface), chart_(chart) {
  parts_ = concatenate<Part>(
      map_blocks<std::vector<Part>>(faces.size(), kItemsPerBlock, control,
                                    [&](std::size_t begin, std::size_t end) {
                                      std::vector<Part> parts;
                                      parts.reserve(end - begin);
                                      for (std::size_t i = begin; i < end; ++i)
                                        visit_triangles(surface, faces[i], control, [&](const Triangle& t) {
                                          parts.push_back({static_cast<std::uint32_t>(i), t});
                                        });
                                      return parts;
                                    }),
      control);
  const auto entries = BoxTree<NoTag>::make_entries(parts_.size(), control, [&](std::size_t i, auto& entry) {
    for (const Vec2 p : uv_of(parts_[i])) entry.box.add(in_space(p));
  });
  tree_ = BoxTree<NoTag>(entries, control);
}

PatchLocator::Place PatchLocator::nearest(Vec2 p) const {
  double best = HUGE_VAL;
  std::uint32_t found = 0;
  tree_.search(
      best,
      [&](const BoxTree<NoTag>::Entry& e) {
        return std::sqrt(squared_distance(e.box, in_space(p))) - kRoundingInSpace;
      },
      [&](std::size_t slot) {
        const std::uint32_t i = tree_.number(slot);
        const double d = distance_to_triangle(uv_of(parts_[i]), p);
        if (d > best || (d == best && i > found)) return;
        best = d;
        found = i;
      });
  return {parts_[found].face, parts_[found].corners, uv_of(parts_[found])};
}

std::array<Vec2, 3> PatchLocator::uv_of(const Part& part) const {
  std::array<Vec2, 3> uv;
  for (int k = 0; k < 3; ++k) uv[k] = chart_.to_plane(surface_.positions[part.corners[k]]);
  return uv;
}

}  // namespace remesh
