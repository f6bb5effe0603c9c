#include "core/verify/boundary/curved_chain.h"

#include <algorithm>
#include <cmath>

#include "core/base/stoppable.h"
#include "core/verify/boundary/chain_coupling.h"

namespace remesh::verification {
namespace {

/// Measures the gap on a curved surface, piece by piece.
class SurfaceGap {
 public:
  SurfaceGap(const CurvedSurface& surface, double plane_tolerance, PatchGap& gap)
      : shape_(surface.shape),
        depth_(std::min(surface.tolerance + plane_tolerance, surface.shape.largest_depth())),
        gap_(gap) {}

  /// Adds the piece on which the input's point moves from x0 to x1 and the output's point from y0 to y1.
  void add(const Vec3& x0, const Vec3& y0, const Vec3& x1, const Vec3& y1) {
    if (x0 == y0 && x1 == y1) return;
    const Vec3 middle = 0.5 * (y0 + y1), before = x0 - y0, after = x1 - y1;
    const double widest = std::max(norm(before), norm(after));
    if (shape_.is_ruled()) {
      const double along_surface = ruled_gap({shape_.ruled(x0), shape_.ruled(y0), shape_.ruled(x1), shape_.ruled(y1)});
      // Both numbers are bounds. The first one enters the root of a sum of squares, and the second one counts twice.
      if (along_surface <= 2 * widest)
        gap_.on_surface = std::max(gap_.on_surface, along_surface);
      else
        gap_.near_pole = std::max(gap_.near_pole, widest);
      return;
    }
    const double half = shape_.turning_length(y1 - y0) / 2, extent = half + widest;
    const double depth = shape_.depth_between(y0, y1) + widest;
    const double rate = shape_.turn_rate(middle, extent);
    if (!(rate * depth <= kFastTurn)) {
      gap_.near_pole = std::max(gap_.near_pole, widest);
      return;
    }
    const Vec3 normal = shape_.normal(middle);
    const double at_ends = std::max(norm(cross(before, normal)), norm(cross(after, normal)));
    // On the way from y to x the normal turns only by the part of the way across it.
    const double change = rate * (half + at_ends) / (1 - rate * widest);
    const double across = at_ends + widest * change;
    // The last factor is that of the proof in curved_patch.h. On the surface, the normal may turn faster than here.
    const double rate_on_surface = rate / (1 - depth * rate);
    gap_.on_surface = std::max(gap_.on_surface, across * (1 + depth * rate) * (1 + depth_ * rate_on_surface));
  }

 private:
  static constexpr double kFastTurn = 0.5;

  /// The ends of a piece, where the two points are relative to the axis.
  struct RuledPiece {
    RuledPoint x0, y0, x1, y1;
  };

  /// Bounds the gap on a cylinder or a cone, as curved_chain.h describes. It is infinite if the axis is too near for a
  /// bound.
  double ruled_gap(const RuledPiece& p) const {
    const auto turn = [](const RuledPoint& a, const RuledPoint& b) {
      return std::fabs(std::atan2(cross(a.across, b.across), dot(a.across, b.across)));
    };
    const double at_ends = std::max(turn(p.x0, p.y0), turn(p.x1, p.y1));
    const double on_way = std::max(turn(p.x0, p.x1), turn(p.y0, p.y1));
    const auto [near, far] = std::minmax({p.x0.radius, p.y0.radius, p.x1.radius, p.y1.radius});
    const auto [low, high] = std::minmax({p.x0.along, p.y0.along, p.x1.along, p.y1.along});
    if (!(near > 0) || !(at_ends <= kFastTurn) || !(on_way <= kFastTurn)) return HUGE_VAL;
    // The max deviation of both points' angles from linear ones. Their distances from the axis deviate by this, times
    // `nearest`.
    const double nearest = near * std::cos(on_way / 2);
    const Vec2 way_x = p.x1.across - p.x0.across, way_y = p.y1.across - p.y0.across;
    const double bend = (dot(way_x, way_x) + dot(way_y, way_y)) / (8 * nearest * nearest);
    const double max_turn = at_ends + bend;
    if (!(max_turn <= 2 * kFastTurn)) return HUGE_VAL;
    // The distance from the axis between the two points is below its linear interpolation by at most this.
    const double closest = nearest * std::cos(max_turn / 2);
    const double dip = far * far * far * far * max_turn * max_turn / (8 * closest * closest * closest);
    const double deviation = shape_.sine() * (nearest * bend + dip);
    const double radius = shape_.ruled_radius(high);
    if (!(shape_.ruled_radius(low - deviation) > 0)) return HUGE_VAL;
    const double along = std::max(std::fabs(p.x0.along - p.y0.along), std::fabs(p.x1.along - p.y1.along)) + deviation;
    return std::hypot(along, max_turn * (radius + depth_ * shape_.cosine()));
  }

  const CurvedShape& shape_;
  const double depth_;
  PatchGap& gap_;
};

/// Cuts the edges of a polyline where the surface's normal turns along them. Then points that move linearly along two
/// such lines stay opposite each other.
std::vector<Vec3> cut_finely(std::span<const Vec3> line, const CurvedShape& shape) {
  constexpr double kPartsPerTurn = 128, kMaxParts = 64;
  std::vector<Vec3> fine;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vec3 way = line[i + 1] - line[i];
    const double turn = shape.turn_rate(line[i] + 0.5 * way, 0) * shape.turning_length(way);
    const double parts = std::min(kMaxParts, std::floor(1 + kPartsPerTurn * turn));
    for (double k = 0; k < parts; ++k) fine.push_back(line[i] + (k / parts) * way);
  }
  fine.push_back(line.back());
  return fine;
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) { return norm(cross(b - a, c - a)) / 2; }

}  // namespace

ChainGap measure_gap(const NumberedClaim& numbered, std::span<const Vec3> input, std::span<const Vec3> output,
                     std::span<const Use> uses, RunControl& control) {
  ChainGap gap;
  for (const Use& use : uses)
    if (gap.patches.empty() || gap.patches.back().patch != use.patch()) gap.patches.push_back({use.patch()});
  StopCheck check(control);
  // A place between two vertices is rounded, so it may be off its line.
  double reach = 0;
  for (const std::span<const Vec3> chain : {input, output})
    for (const Vec3& p : chain) reach = std::max(reach, largest_coordinate(p));
  const double rounding = NumberedClaim::rounding(reach);
  // One coupling serves all measures that need no surface.
  couple(
      input, output, [](const Vec3&) { return Vec3{}; },
      [&](const Vec3& x0, const Vec3& y0, const Vec3& x1, const Vec3& y1) {
        const Vec3 between = x1 - y1;
        gap.distance = std::max(gap.distance, norm(between));
        gap.sliver +=
            triangle_area(x0, x1, y0) + triangle_area(x1, y1, y0) + rounding * (norm(x1 - x0) + norm(y1 - y0));
        for (PatchGap& of : gap.patches)
          if (numbered.curved_surface(of.patch) == nullptr)
            of.off_plane = std::max(of.off_plane, std::fabs(dot(between, numbered.normal(of.patch))));
      },
      check);
  for (PatchGap& of : gap.patches) {
    const CurvedSurface* const surface = numbered.curved_surface(of.patch);
    if (surface == nullptr) continue;
    SurfaceGap on_surface(*surface, numbered.tolerance, of);
    couple(
        cut_finely(input, surface->shape), output, [&](const Vec3& p) { return surface->shape.normal(p); },
        [&](const Vec3& x0, const Vec3& y0, const Vec3& x1, const Vec3& y1) { on_surface.add(x0, y0, x1, y1); }, check);
  }
  return gap;
}

}  // namespace remesh::verification
