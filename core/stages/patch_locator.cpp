#include "core/stages/patch_locator.h"

#include <algorithm>
#include <cmath>

#include "core/stages/polygon_split.h"
#include "core/stages/projection.h"

namespace remesh {
namespace {

double distance_to_segment(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 ab = b - a;
  const double length_squared = dot(ab, ab);
  const double t = length_squared > 0 ? std::clamp(dot(p - a, ab) / length_squared, 0.0, 1.0) : 0.0;
  return norm(p - (a + t * ab));
}

/// 0 inside a triangle, of either orientation, else the distance to its rim.
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

void PatchLocator::Box2::add(Vec2 p) {
  min = {std::fmin(min.x, p.x), std::fmin(min.y, p.y)};
  max = {std::fmax(max.x, p.x), std::fmax(max.y, p.y)};
}

double PatchLocator::Box2::distance(Vec2 p) const {
  return std::hypot(std::max({min.x - p.x, p.x - max.x, 0.0}), std::max({min.y - p.y, p.y - max.y, 0.0}));
}

PatchLocator::PatchLocator(const Surface& surface, std::span<const FaceId> faces, const Frame& frame,
                           RunControl& control) {
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const auto loop = surface.face(faces[i]);
    const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      Place place{i, {loop[a], loop[b], loop[c]}, {}};
      for (int k = 0; k < 3; ++k) place.uv[k] = to_plane(frame, surface.positions[place.corners[k]]);
      add(place);
    };
    if (loop.size() == 3) {
      add_triangle(0, 1, 2);
      continue;
    }
    std::vector<Vec3> points;
    for (const VertexId v : loop) points.push_back(surface.local[v]);
    for (const auto& [a, b, c] : split_polygon(points, 0, control).triangles) add_triangle(a, b, c);
  }
  std::size_t leaves = 1;
  while (leaves * kLeafSize < items_.size()) leaves *= 2;
  first_leaf_ = leaves - 1;
  boxes_.resize(2 * leaves - 1);
  build();
}

PatchLocator::Place PatchLocator::nearest(Vec2 p) const {
  double best = HUGE_VAL;
  const Item* found = &items_.front();
  std::vector<std::size_t> stack{0};
  while (!stack.empty()) {
    const std::size_t node = stack.back();
    stack.pop_back();
    if (boxes_[node].distance(p) > best) continue;
    if (node < first_leaf_) {
      const std::size_t left = 2 * node + 1, right = left + 1;
      const bool left_first = boxes_[left].distance(p) <= boxes_[right].distance(p);
      stack.push_back(left_first ? right : left);
      stack.push_back(left_first ? left : right);
      continue;
    }
    const auto [from, to] = range(node);
    for (std::size_t i = from; i < to; ++i) {
      const Item& item = items_[i];
      if (item.box.distance(p) > best) continue;
      const double d = distance_to_triangle(item.place.uv, p);
      if (d < best || (d == best && item.place.face < found->place.face)) {
        best = d;
        found = &item;
      }
    }
  }
  return found->place;
}

void PatchLocator::add(const Place& place) {
  Item item{{}, place};
  for (const Vec2 p : place.uv) item.box.add(p);
  items_.push_back(item);
}

std::pair<std::size_t, std::size_t> PatchLocator::range(std::size_t node) const {
  std::size_t level_begin = 0, width = 1;
  while (node >= level_begin + width) {
    level_begin += width;
    width *= 2;
  }
  const std::size_t k = node - level_begin;
  return {items_.size() * k / width, items_.size() * (k + 1) / width};
}

void PatchLocator::build() {
  const auto centre = [](const Item& i, bool by_y) {
    return by_y ? i.box.min.y + i.box.max.y : i.box.min.x + i.box.max.x;
  };
  for (std::size_t node = 0; node < boxes_.size(); ++node) {
    const auto [from, to] = range(node);
    for (std::size_t i = from; i < to; ++i) {
      boxes_[node].add(items_[i].box.min);
      boxes_[node].add(items_[i].box.max);
    }
    if (node >= first_leaf_) continue;
    const bool by_y = boxes_[node].max.y - boxes_[node].min.y > boxes_[node].max.x - boxes_[node].min.x;
    const std::size_t middle = range(2 * node + 1).second;
    const auto less = [&](const Item& a, const Item& b) {
      return centre(a, by_y) != centre(b, by_y) ? centre(a, by_y) < centre(b, by_y) : a.place.face < b.place.face;
    };
    std::nth_element(items_.begin() + static_cast<std::ptrdiff_t>(from),
                     items_.begin() + static_cast<std::ptrdiff_t>(middle),
                     items_.begin() + static_cast<std::ptrdiff_t>(to), less);
  }
}

}  // namespace remesh
