#include "tests/recognition/triangle_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace remesh::recognition {
namespace {

constexpr std::uint32_t kNoParent = 0xffffffff;

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return norm(p - (a + t * along));
}

double distance_to_box(const Vec3& low, const Vec3& high, const Vec3& p) {
  Vec3 d;
  for (int k = 0; k < 3; ++k) d[k] = std::max({low[k] - p[k], 0.0, p[k] - high[k]});
  return norm(d);
}

}  // namespace

double distance_to(const PlainTriangle& t, const Vec3& p) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double size = norm(normal);
  bool is_over = size > 0;
  double best = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = t[i], &b = t[(i + 1) % 3];
    is_over = is_over && dot(cross(normal, b - a), p - a) >= 0;
    best = std::min(best, distance_to_segment(p, a, b));
  }
  return is_over ? std::min(best, std::fabs(dot(p - t[0], normal)) / size) : best;
}

TriangleBoxes::TriangleBoxes(std::vector<PlainTriangle> triangles) : triangles_(std::move(triangles)) {
  constexpr std::uint32_t kLeaf = 4;
  if (triangles_.empty()) return;
  struct Open {
    std::uint32_t begin, end, parent;
  };
  std::vector<Open> open{{0, static_cast<std::uint32_t>(triangles_.size()), kNoParent}};
  while (!open.empty()) {
    const Open part = open.back();
    open.pop_back();
    if (part.parent != kNoParent) nodes_[part.parent].second = static_cast<std::uint32_t>(nodes_.size());
    Node node{triangles_[part.begin][0], triangles_[part.begin][0], part.begin, part.end, 0};
    for (std::uint32_t i = part.begin; i < part.end; ++i)
      for (const Vec3& p : triangles_[i])
        for (int k = 0; k < 3; ++k) {
          node.low[k] = std::min(node.low[k], p[k]);
          node.high[k] = std::max(node.high[k], p[k]);
        }
    const auto here = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (part.end - part.begin <= kLeaf) continue;
    const Vec3 size = node.high - node.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = part.begin + (part.end - part.begin) / 2;
    const auto at = [axis](const PlainTriangle& t) { return t[0][axis] + t[1][axis] + t[2][axis]; };
    std::nth_element(triangles_.begin() + part.begin, triangles_.begin() + middle, triangles_.begin() + part.end,
                     [&](const PlainTriangle& a, const PlainTriangle& b) { return at(a) < at(b); });
    open.push_back({middle, part.end, here});
    open.push_back({part.begin, middle, kNoParent});
  }
}

double TriangleBoxes::distance(const Vec3& p) const {
  double best = HUGE_VAL;
  std::vector<std::uint32_t> open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    const Node& node = nodes_[at];
    if (distance_to_box(node.low, node.high, p) >= best) continue;
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) best = std::min(best, distance_to(triangles_[i], p));
      continue;
    }
    const Node &a = nodes_[at + 1], &b = nodes_[node.second];
    const bool is_first = distance_to_box(a.low, a.high, p) <= distance_to_box(b.low, b.high, p);
    open.push_back(is_first ? node.second : at + 1);
    open.push_back(is_first ? at + 1 : node.second);
  }
  return best;
}

}  // namespace remesh::recognition
