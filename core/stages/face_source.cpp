#include "core/stages/face_source.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/stages/polygon_split.h"
#include "core/stages/projection.h"

namespace remesh {
namespace {

struct Box2 {
  Vec2 min{HUGE_VAL, HUGE_VAL}, max{-HUGE_VAL, -HUGE_VAL};

  void add(Vec2 p) {
    min = {std::fmin(min.x, p.x), std::fmin(min.y, p.y)};
    max = {std::fmax(max.x, p.x), std::fmax(max.y, p.y)};
  }
  double distance(Vec2 p) const {
    return std::hypot(std::max({min.x - p.x, p.x - max.x, 0.0}), std::max({min.y - p.y, p.y - max.y, 0.0}));
  }
};

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

/// The faces of one patch in its plane, as triangles under a binary tree of boxes: node k has the children 2k + 1 and
/// 2k + 2.
class PatchLocator {
 public:
  PatchLocator(const Surface& surface, std::span<const FaceId> faces, const Frame& frame, RunControl& control) {
    for (std::uint32_t i = 0; i < faces.size(); ++i) {
      const auto loop = surface.face(faces[i]);
      const auto uv = [&](std::uint32_t k) { return to_plane(frame, surface.positions[loop[k]]); };
      if (loop.size() == 3) {
        add({uv(0), uv(1), uv(2)}, i);
        continue;
      }
      std::vector<Vec3> points;
      for (const VertexId v : loop) points.push_back(surface.local[v]);
      for (const auto& [a, b, c] : split_polygon(points, 0, control).triangles) add({uv(a), uv(b), uv(c)}, i);
    }
    std::size_t leaves = 1;
    while (leaves * kLeafSize < items_.size()) leaves *= 2;
    first_leaf_ = leaves - 1;
    boxes_.resize(2 * leaves - 1);
    build();
  }

  /// The position in `faces` of the one nearest to p; of equally near ones the first.
  std::uint32_t nearest(Vec2 p) const {
    double best = HUGE_VAL;
    std::uint32_t found = 0;
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
        if (items_[i].box.distance(p) > best) continue;
        const std::uint32_t f = items_[i].face;
        const double d = distance_to_triangle(items_[i].corners, p);
        if (d < best || (d == best && f < found)) {
          best = d;
          found = f;
        }
      }
    }
    return found;
  }

 private:
  static constexpr std::size_t kLeafSize = 4;

  struct Item {
    Box2 box;
    std::array<Vec2, 3> corners;
    std::uint32_t face;
  };

  void add(const std::array<Vec2, 3>& corners, std::uint32_t face) {
    Item item{{}, corners, face};
    for (const Vec2 p : corners) item.box.add(p);
    items_.push_back(item);
  }

  /// The items under a node: its share of all, by its place in its level.
  std::pair<std::size_t, std::size_t> range(std::size_t node) const {
    std::size_t level_begin = 0, width = 1;
    while (node >= level_begin + width) {
      level_begin += width;
      width *= 2;
    }
    const std::size_t k = node - level_begin;
    return {items_.size() * k / width, items_.size() * (k + 1) / width};
  }

  void build() {
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
        return centre(a, by_y) != centre(b, by_y) ? centre(a, by_y) < centre(b, by_y) : a.face < b.face;
      };
      std::nth_element(items_.begin() + static_cast<std::ptrdiff_t>(from),
                       items_.begin() + static_cast<std::ptrdiff_t>(middle),
                       items_.begin() + static_cast<std::ptrdiff_t>(to), less);
    }
  }

  std::vector<Item> items_;
  std::vector<Box2> boxes_;
  std::size_t first_leaf_ = 0;
};

}  // namespace

IdVector<FaceId, FaceId> face_source(const Surface& surface, const PatchSet& patches,
                                     const std::vector<PatchMesh>& meshes, RunControl& control) {
  std::vector<std::size_t> begin{0};
  for (const PatchMesh& patch : meshes) begin.push_back(begin.back() + patch.mesh.triangle_count());
  IdVector<FaceId, FaceId> source(begin.back());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, meshes.size(), 64), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      control.check();
      const auto faces = patches.faces_of(PatchId(p));
      const PatchMesh& patch = meshes[p];
      if (faces.size() == 1) {
        std::fill(source.begin() + static_cast<std::ptrdiff_t>(begin[p]),
                  source.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]), surface.face_source[faces[0]]);
        continue;
      }
      const PatchLocator locator(surface, faces, patch.frame, control);
      for (std::uint32_t t = 0; t < patch.mesh.triangle_count(); ++t) {
        if (t % 4096 == 0) control.check();
        const auto uv = [&](std::uint32_t k) { return patch.uv[patch.mesh.from(3 * t + k)]; };
        const Vec2 centroid = (1.0 / 3.0) * (uv(0) + uv(1) + uv(2));
        source[FaceId(begin[p] + t)] = surface.face_source[faces[locator.nearest(centroid)]];
      }
    }
  });
  return source;
}

}  // namespace remesh
