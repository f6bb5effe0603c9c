#include "core/patches/recognition/surface_gauge.h"

#include <algorithm>

namespace remesh {
namespace {

/// The first slack is this part of the facets' distance from the surface, and at least some tolerances.
constexpr double kSlackOfHeight = 0.15, kMinFirstSlack = 2;

/// In each corner of a facet, the cosine of the angle between its normal and that of its surface is at least this.
/// The normals of facets that meet smoothly differ from the surface's normals by up to about half the feature angle.
constexpr double kMinFacing = 0.8;

}  // namespace

double first_slack(double chord_height, double tolerance) {
  return std::clamp(kSlackOfHeight * chord_height / tolerance, kMinFirstSlack, kFirstSlack);
}

bool is_on(const FacetGraph& graph, const SurfaceGauge& gauge, PatchId p, double allowed, double tolerance, int side) {
  const Vec3 outside = side * graph.normal(p);
  for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s) {
    if (!graph.is_corner(s)) continue;
    // Two circles lie on a cylinder, but also on a sphere. The facets between them are not tangential to the sphere.
    const auto [distance, facing] = gauge.measure(graph.position(graph.vertex(s)), outside, tolerance);
    if (!(std::fabs(distance) <= allowed) || !(facing >= kMinFacing)) return false;
  }
  return true;
}

int side_of(const FacetGraph& graph, const SurfaceGauge& gauge, std::span<const PatchId> facets) {
  double facing = 0;
  for (const PatchId p : facets) facing += dot(gauge.normal(graph.mean_corner(p), 0), graph.normal(p));
  return facing >= 0 ? 1 : -1;
}

double chord_height(const FacetGraph& graph, const SurfaceGauge& gauge, PatchId p) {
  Vec3 sum, first, last;
  int count = 0;
  double height = 0;
  if (!graph.may_be_seed(p)) {
    graph.for_each_side(p, [&](const Vec3& a, const Vec3& b, bool) {
      height = std::max(height, std::fabs(gauge.distance(0.5 * (a + b))));
    });
    return height;
  }
  graph.for_each_corner(p, [&](const Vec3& q) {
    if (count == 0)
      first = q;
    else
      height = std::max(height, std::fabs(gauge.distance(0.5 * (last + q))));
    last = q;
    sum += q;
    ++count;
  });
  height = std::max(height, std::fabs(gauge.distance(0.5 * (last + first))));
  return std::max(height, std::fabs(gauge.distance((1.0 / count) * sum)));
}

}  // namespace remesh
