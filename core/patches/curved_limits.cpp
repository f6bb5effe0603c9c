#include "core/patches/curved_limits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/surface_map.h"
#include "core/patches/boundary_curve.h"

namespace remesh {
namespace {

constexpr double kPi = std::numbers::pi;

/// Edges turn by at most this angle whatever is allowed, so that a small circle keeps its shape.
constexpr double kMaxTurn = kPi / 3;

/// At least this share of the tolerance is for the depth of edges.
constexpr double kDepthShare = 0.9;
/// This share of what is then left is for the way along the surface.
constexpr double kSidewaysShare = 0.9;
/// Rounding must not make one piece more than was asked for.
constexpr double kRounding = 1e-6;

/// Facets with sharp corners are few if they are no more than this part of a surface's facets.
constexpr double kFewSharp = 0.1;

/// A torus is not remeshed if what its tolerance leaves for the result is less than this part of the chord height of
/// the input's facets.
constexpr double kMinShare = 0.25;

/// Returns the largest distance of each surface's facets from its axis, as seen along the surface's normal: the radius
/// of the circles around the axis that bend least. For a sphere it is the radius.
std::vector<double> largest_radii(const Surface& surface, const PatchSet& facets, const RecognisedSurfaces& recognised,
                                  RunControl& control) {
  std::vector<double> radii(recognised.surfaces.size(), 0);
  StopCheck check(control);
  for (std::size_t i = 0; i < recognised.surfaces.size(); ++i) {
    const AnalyticSurface& shape = recognised.surfaces[SurfaceId(i)].shape;
    if (shape.kind == SurfaceKind::kCylinder || shape.kind == SurfaceKind::kSphere) radii[i] = shape.radius;
    if (shape.kind == SurfaceKind::kTorus) radii[i] = shape.radius + shape.minor_radius;
  }
  for (std::size_t p = 0; p < facets.count(); ++p) {
    const SurfaceId s = recognised.of_patch[PatchId(p)];
    const AnalyticSurface& shape = recognised.surfaces[s].shape;
    if (shape.kind != SurfaceKind::kCone) continue;
    for (const FaceId f : facets.faces_of(PatchId(p)))
      for (const VertexId v : surface.face(f)) {
        check();
        const Vec3 way = surface.positions[v] - shape.origin;
        const double distance = norm(way - dot(way, shape.axis) * shape.axis) * std::cos(shape.half_angle);
        radii[s.value] = std::max(radii[s.value], distance);
      }
  }
  return radii;
}

/// Returns how many facets each surface has, and in how many of them no refinement can meet the bound on angles.
struct FacetCount {
  std::uint32_t all = 0, sharp = 0;
};
std::vector<FacetCount> count_facets(const PatchSet& facets, const RecognisedSurfaces& recognised,
                                     const IdVector<PatchId, std::uint8_t>& is_sharp, StopCheck& check) {
  std::vector<FacetCount> counts(recognised.surfaces.size());
  for (std::size_t i = 0; i < facets.count(); ++i) {
    check();
    FacetCount& count = counts[recognised.of_patch[PatchId(i)].value];
    ++count.all;
    if (is_sharp[PatchId(i)] != 0) ++count.sharp;
  }
  return counts;
}

/// Returns how far the curve that ends each surface leaves the edges of the input's facets, within the surface. Where a
/// plane cuts a cylinder at an angle, the true curve lies beside the chords of the facets, not only above them.
std::vector<double> sideways_of_ends(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
                                     const RecognisedSurfaces& recognised, StopCheck& check) {
  std::vector<double> sideways(recognised.surfaces.size(), 0);
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    check();
    const auto around = adjacency.half_edges(EdgeId(e));
    if (around.size() != 2) continue;
    const SurfaceId s = recognised.of_patch[facets.of_face[adjacency.face_of(around[0])]];
    const SurfaceId t = recognised.of_patch[facets.of_face[adjacency.face_of(around[1])]];
    if (s == t) continue;
    const Vec3 &from = surface.positions[adjacency.from(around[0])], &to = surface.positions[adjacency.to(around[0])];
    for (const auto& [here, beyond] : {std::pair(s, t), std::pair(t, s)}) {
      const AnalyticSurface &shape = recognised.surfaces[here].shape, &other = recognised.surfaces[beyond].shape;
      if (!SurfaceMap::can_map(shape) || other.kind == SurfaceKind::kFree) continue;
      const auto trace = CurveTrace::choose(from, to, shape, other);
      if (!trace) continue;
      const Vec3 middle = 0.5 * (from + to), way = trace->place(middle, from, to) - middle;
      const Vec3 normal = shape.normal(middle);
      sideways[here.value] = std::max(sideways[here.value], norm(way - dot(way, normal) * normal));
    }
  }
  return sideways;
}

/// Returns limits with which the result is as near to a surface as the input's own facets. There are none if the curve
/// that ends the surface leaves the facets farther than they are deep. Then the facets were not made from it alone.
CurvedLimits limits_of_facets(const RecognisedSurface& s, double own, double sideways, double plane_tolerance) {
  if (sideways > own) return {};
  // The proof allows for this part of the chord height beside the ends of any piece.
  constexpr double kShareAtEnds = 0.5, kBeyondEnds = 1.1;
  const double beside = std::max(kBeyondEnds * sideways, kShareAtEnds * own);
  // On a torus, the facets and the result may be on different sides of the surface.
  const double apart = s.shape.kind == SurfaceKind::kTorus ? 2 * own : own;
  const double height = own * (1 + kRounding) + plane_tolerance;
  return {std::hypot(apart, beside), height, kMaxTurn, height, std::max(plane_tolerance, 0x1p-40 * own)};
}

}  // namespace

std::vector<CurvedLimits> limits_where_facets_are_sharp(const Surface& surface, const Adjacency& adjacency,
                                                        const PatchSet& facets, const RecognisedSurfaces& recognised,
                                                        const IdVector<PatchId, std::uint8_t>& is_sharp,
                                                        double plane_tolerance, RunControl& control) {
  std::vector<CurvedLimits> limits(recognised.surfaces.size());
  StopCheck check(control);
  const std::vector<FacetCount> counts = count_facets(facets, recognised, is_sharp, check);
  const auto is_wanted = [&](std::size_t i) {
    return counts[i].sharp > kFewSharp * counts[i].all && SurfaceMap::can_map(recognised.surfaces[SurfaceId(i)].shape);
  };
  bool is_any_wanted = false;
  for (std::size_t i = 0; i < limits.size(); ++i) is_any_wanted = is_any_wanted || is_wanted(i);
  if (!is_any_wanted) return limits;
  const std::vector<double> sideways = sideways_of_ends(surface, adjacency, facets, recognised, check);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (!is_wanted(i)) continue;
    const RecognisedSurface& s = recognised.surfaces[SurfaceId(i)];
    limits[i] = limits_of_facets(s, std::max(s.input_chord_height, plane_tolerance), sideways[i], plane_tolerance);
  }
  return limits;
}

std::vector<CurvedLimits> curved_limits(const Surface& surface, const PatchSet& facets,
                                        const RecognisedSurfaces& recognised, const Options& options,
                                        double plane_tolerance, double diagonal, RunControl& control) {
  std::vector<CurvedLimits> limits(recognised.surfaces.size());
  std::optional<double> asked = options.surface_tolerance;
  if (options.surface_tolerance_fraction) asked = *options.surface_tolerance_fraction * diagonal;
  if (asked ? *asked == 0 : !options.elements_per_circle) return limits;
  const std::vector<double> radii = largest_radii(surface, facets, recognised, control);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const RecognisedSurface& s = recognised.surfaces[SurfaceId(i)];
    if (!SurfaceMap::can_map(s.shape)) continue;
    // Facets that are hardly off their surface are known to the plane tolerance only.
    const double own = std::max(s.input_chord_height, plane_tolerance);
    const double turn = options.elements_per_circle ? 2 * kPi / *options.elements_per_circle : kMaxTurn;
    double tolerance = asked.value_or(own);
    if (options.elements_per_circle) tolerance += radii[i] * (1 - std::cos(turn / 2));
    if (tolerance < own) continue;
    CurvedLimits& of_surface = limits[i];
    of_surface.tolerance = tolerance;
    // Vertices of the input are off their surface by rounding. Edges between them are that much deeper, and the
    // surface's normals at them turn that much more.
    of_surface.max_height = tolerance + plane_tolerance;
    if (s.shape.kind == SurfaceKind::kTorus) {
      // On the inner half of a torus, edges around the axis lie outside of the tube and others inside. So the facets
      // and the result may be on different sides, and their distances from the surface add up.
      of_surface.max_height = tolerance + plane_tolerance - own;
      if (of_surface.max_height < kMinShare * own) {
        of_surface = {};
        continue;
      }
    }
    // Where a boundary is cut anew, the result may leave the input both in depth and along the surface. The proven
    // bound is the root of the sum of their squares.
    const double depth = std::max(kDepthShare * tolerance, tolerance - asked.value_or(own));
    of_surface.max_height = std::min(of_surface.max_height, depth + plane_tolerance);
    of_surface.boundary_tolerance = std::min(tolerance, depth * (1 + kRounding) + plane_tolerance);
    of_surface.boundary_sideways = kSidewaysShare * std::sqrt(tolerance * tolerance - depth * depth);
    of_surface.max_turn = std::min(turn, kMaxTurn);
    const double smallest = s.shape.kind == SurfaceKind::kTorus ? s.shape.minor_radius : radii[i];
    of_surface.max_turn += 4 * plane_tolerance / smallest;
  }
  return limits;
}

}  // namespace remesh
