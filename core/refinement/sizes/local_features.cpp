#include "core/refinement/sizes/local_features.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

using Mesh = Triangulation2d;

constexpr std::size_t kMaxTriangles = 256;
/// A search ends after this many triangles in a row without a smaller distance. This happens in fans of long triangles,
/// which all come near the segment.
constexpr std::size_t kMaxIdle = 64;
constexpr double kOwnEnd = -1;  ///< stands for the distance of the segment's own ends; less than any distance

double squared_distance(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 ab = b - a, ap = p - a;
  const double along = dot(ap, ab), length_squared = dot(ab, ab);
  if (along <= 0) return dot(ap, ap);
  if (along >= length_squared) return dot(p - b, p - b);
  const double across = cross(ab, ap);
  return across * across / length_squared;
}

/// Returns whether p is nearer to the segment a-b than the given distance (squared), at a place between its ends.
bool is_near_middle(Vec2 a, Vec2 b, Vec2 p, double squared) {
  const Vec2 ab = b - a, ap = p - a;
  const double along = dot(ap, ab), length_squared = dot(ab, ab), across = cross(ab, ap);
  return along > 0 && along < length_squared && across * across < squared * length_squared;
}

/// Walks around the start of h from triangle to triangle, up to the next constrained edge, which it returns. Calls
/// `visit` with the apex of each triangle.
template <class Visit>
std::uint32_t walk_around_start(const Triangulation2d& mesh, std::uint32_t h, const Visit& visit) {
  while (true) {
    visit(mesh.apex(h));
    h = Triangulation2d::previous(h);
    if (mesh.is_constrained(h)) return h;
    h = mesh.twin(h);
  }
}

std::uint32_t next_at_start(const Triangulation2d& mesh, std::uint32_t h) {
  return walk_around_start(mesh, h, [](std::uint32_t) {});
}

/// Returns the angle from h to `next`, which ends where h starts.
double angle_between(const PatchMesh& patch, std::uint32_t h, std::uint32_t next) {
  const Triangulation2d& mesh = patch.mesh;
  const Vec2 corner = patch.uv[mesh.from(h)], first = patch.uv[mesh.to(h)];
  const Vec2 u = first - corner, v = patch.uv[mesh.from(next)] - corner;
  const double cosine = dot(u, v);
  // Most angles are far from being small, and for these the cosine alone decides.
  constexpr double kSmallCosineSquared = 0.2;
  if (cosine <= 0 || cosine * cosine < kSmallCosineSquared * dot(u, u) * dot(v, v)) return LocalFeature::kWide;
  // Each triangle at the corner takes less than half a turn. So if an apex lies to the right of the first edge, the
  // angle is more than half a turn.
  bool is_beyond_half = false;
  walk_around_start(mesh, h, [&](std::uint32_t apex) {
    is_beyond_half = is_beyond_half || orient2d(corner, first, patch.uv[apex]) < 0;
  });
  return is_beyond_half ? LocalFeature::kWide : std::fabs(std::atan2(cross(u, v), cosine));
}

}  // namespace

/// Returns the distance from the segment of h to other features. The search goes through the triangles in front of the
/// segment, as long as they are nearer than the nearest feature so far.
double LocalFeatures::distance(const PatchMesh& patch, std::uint32_t h) {
  const Mesh& mesh = patch.mesh;
  const std::uint32_t a = mesh.from(h), b = mesh.to(h);
  const Vec2 pa = patch.uv[a], pb = patch.uv[b];
  double best = dot(pb - pa, pb - pa);
  double nearest_before = best;
  std::size_t most = kMaxIdle;
  queue_.assign(1, {h, kOwnEnd, kOwnEnd});
  seen_[h / 3] = h;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Entered entry = queue_[i];
    if (best < nearest_before) {
      nearest_before = best;
      most = std::min(i + kMaxIdle, kMaxTriangles);
    }
    const std::uint32_t v = mesh.apex(entry.half_edge);
    const bool is_apex_own = v == a || v == b;
    const double apex_distance = is_apex_own ? kOwnEnd : squared_distance(pa, pb, patch.uv[v]);
    if (!is_apex_own) best = std::min(best, apex_distance);
    for (const bool is_next : {true, false}) {
      const std::uint32_t e = is_next ? Mesh::next(entry.half_edge) : Mesh::previous(entry.half_edge);
      const double from_distance = is_next ? entry.to_distance : apex_distance;
      const double to_distance = is_next ? apex_distance : entry.from_distance;
      const Vec2 pc = patch.uv[mesh.from(e)], pd = patch.uv[mesh.to(e)];
      if (mesh.is_constrained(e)) {
        if (from_distance != kOwnEnd && to_distance != kOwnEnd)
          best = std::min({best, squared_distance(pc, pd, pa), squared_distance(pc, pd, pb)});
        continue;
      }
      const std::uint32_t g = mesh.twin(e);
      if (seen_[g / 3] == h || queue_.size() >= most) continue;
      // If a triangle's side and the segment do not cross, they are nearest at an end of one of them.
      if (from_distance >= best && to_distance >= best && !is_near_middle(pc, pd, pa, best) &&
          !is_near_middle(pc, pd, pb, best))
        continue;
      seen_[g / 3] = h;
      queue_.push_back({g, to_distance, from_distance});
    }
  }
  return std::sqrt(best);
}

std::span<const LocalFeature> LocalFeatures::of(const PatchMesh& patch, const PatchChart& chart,
                                                std::span<const std::uint32_t> sides, RunControl& control) {
  const Mesh& mesh = patch.mesh;
  features_.clear();
  seen_.assign(mesh.triangle_count(), Mesh::kNoHalfEdge);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i % 256 == 0) control.check_and_move();
    const std::uint32_t h = sides[i];
    const std::uint32_t next = next_at_start(mesh, h);
    features_.push_back(
        {distance(patch, h) * chart.scale(patch.uv[mesh.from(h)]), next, angle_between(patch, h, next)});
  }
  return features_;
}

}  // namespace remesh
