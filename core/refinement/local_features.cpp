#include "core/refinement/local_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/predicates.h"

namespace remesh {
namespace {

double squared_distance(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 ab = b - a, ap = p - a;
  const double along = dot(ap, ab), length_squared = dot(ab, ab);
  if (along <= 0) return dot(ap, ap);
  if (along >= length_squared) return dot(p - b, p - b);
  const double across = cross(ab, ap);
  return across * across / length_squared;
}

class FeatureSearch {
 public:
  explicit FeatureSearch(const PatchMesh& patch) : patch_(patch), seen_(patch.mesh.triangle_count(), Mesh::kNone) {}

  /// Distance from the segment of h, over the triangles in front of it that come nearer than what was found.
  double distance(std::uint32_t h) {
    const Mesh& mesh = patch_.mesh;
    const std::uint32_t a = mesh.from(h), b = mesh.to(h);
    const Vec2 pa = patch_.uv[a], pb = patch_.uv[b];
    double best = dot(pb - pa, pb - pa);
    double nearest_before = best;
    std::size_t most = kMostIdle;
    queue_.assign(1, {h, kOwnEnd, kOwnEnd});
    seen_[h / 3] = h;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const Entry entry = queue_[i];
      if (best < nearest_before) {
        nearest_before = best;
        most = std::min(i + kMostIdle, kMostTriangles);
      }
      const std::uint32_t v = mesh.apex(entry.half_edge);
      const bool is_apex_own = v == a || v == b;
      const double apex_distance = is_apex_own ? kOwnEnd : squared_distance(pa, pb, patch_.uv[v]);
      if (!is_apex_own) best = std::min(best, apex_distance);
      for (const bool is_next : {true, false}) {
        const std::uint32_t e = is_next ? Mesh::next(entry.half_edge) : Mesh::previous(entry.half_edge);
        const double from_distance = is_next ? entry.to_distance : apex_distance;
        const double to_distance = is_next ? apex_distance : entry.from_distance;
        const Vec2 pc = patch_.uv[mesh.from(e)], pd = patch_.uv[mesh.to(e)];
        if (mesh.is_constrained(e)) {
          if (from_distance != kOwnEnd && to_distance != kOwnEnd)
            best = std::min({best, squared_distance(pc, pd, pa), squared_distance(pc, pd, pb)});
          continue;
        }
        const std::uint32_t g = mesh.twin(e);
        if (seen_[g / 3] == h || queue_.size() >= most) continue;
        // The nearest place of a triangle's side, where the two do not cross, is at an end of one of them.
        if (from_distance >= best && to_distance >= best && squared_distance(pc, pd, pa) >= best &&
            squared_distance(pc, pd, pb) >= best)
          continue;
        seen_[g / 3] = h;
        queue_.push_back({g, to_distance, from_distance});
      }
    }
    return std::sqrt(best);
  }

 private:
  using Mesh = Triangulation2d;
  static constexpr std::size_t kMostTriangles = 256;
  /// So many in a row that bring nothing nearer end a search: fans of long triangles, which all come near.
  static constexpr std::size_t kMostIdle = 64;
  static constexpr double kOwnEnd = -1;  ///< the distance of the segment's own ends: less than any
  /// A triangle, by the half-edge over which it is entered, and how far that one's ends are, squared.
  struct Entry {
    std::uint32_t half_edge;
    double from_distance, to_distance;
  };

  const PatchMesh& patch_;
  std::vector<std::uint32_t> seen_;  ///< the half-edge whose search has entered a triangle last
  std::vector<Entry> queue_;
};

}  // namespace

std::vector<LocalFeature> local_features(const PatchMesh& patch, std::span<const std::uint32_t> sides,
                                         RunControl& control) {
  std::vector<LocalFeature> features;
  features.reserve(sides.size());
  FeatureSearch search(patch);
  const Triangulation2d& mesh = patch.mesh;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i % 256 == 0) control.check();
    const std::uint32_t h = sides[i];
    // Around the start of h, from triangle to triangle, up to the next constrained edge.
    std::uint32_t g = h;
    const Vec2 corner = patch.uv[mesh.from(h)], first = patch.uv[mesh.to(h)];
    Vec2 last;
    bool is_beyond_half = false;
    while (true) {
      last = patch.uv[mesh.apex(g)];
      // Each triangle takes less than half a turn: what lies to the right of the first edge is beyond one.
      is_beyond_half = is_beyond_half || orient2d(corner, first, last) < 0;
      g = Triangulation2d::previous(g);
      if (mesh.is_constrained(g)) break;
      g = mesh.twin(g);
    }
    const Vec2 u = first - corner, v = last - corner;
    const double within_half = std::fabs(std::atan2(cross(u, v), dot(u, v)));
    const double angle = is_beyond_half ? 2 * std::numbers::pi - within_half : within_half;
    features.push_back({search.distance(h) * patch.frame.scale, g, angle});
  }
  return features;
}

}  // namespace remesh
