#include "core/patches/curved/curved_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/geometry/surfaces/surface_map.h"

namespace remesh {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

/// Edges turn by at most this angle whatever is allowed, so that a small circle keeps its shape.
constexpr double kMaxTurn = kHalfTurn / 3;

/// At least this share of the tolerance is for the depth of edges.
constexpr double kDepthShare = 0.9;
/// This share of the rest is for the way along the surface.
constexpr double kSidewaysShare = 0.9;
/// Rounding must not make one piece more than the goals require.
constexpr double kRounding = 1e-6;

/// A torus is not remeshed if the tolerance that remains for the result is less than this part of the chord height of
/// the input's facets.
constexpr double kMinShare = 0.25;

/// The depth of edges at a torus is at most this part of the tube's radius, even if the distance from the axis allows
/// more. Otherwise a thin tube would vanish, and its normals would turn too far between old and new places.
constexpr double kMaxPartOfTube = 0.25;

/// Returns the largest distance of each surface's facets from its axis. For a sphere it is the radius.
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
        radii[s.value] = std::max(radii[s.value], norm(way - dot(way, shape.axis) * shape.axis));
      }
  }
  return radii;
}

/// Limits how far boundaries of a torus move. Where the chord of a circle around the axis moves along the tube, the
/// tube's normal turns, and the proven bound grows with this turn. A fillet far from its axis has such circles at one
/// end and deep chords at the other, so that the tolerance has to serve for both.
void limit_on_tube(const AnalyticSurface& torus, double own, CurvedLimits& limits) {
  const double tube = torus.minor_radius, share = limits.tolerance / tube;
  limits.boundary_tolerance = std::min(limits.boundary_tolerance, kMaxPartOfTube * tube);
  constexpr double kFarFromAxis = 3, kFewTurns = 0.1, kDepth = 0.6, kAlong = 0.7;
  if (torus.radius < kFarFromAxis * tube || share < kFewTurns) return;
  limits.max_height = std::min(limits.max_height, std::max(kDepth * limits.tolerance - own, own));
  limits.boundary_tolerance =
      std::min(limits.boundary_tolerance, kAlong * limits.tolerance / ((1 + share) * (1 + share)));
}

}  // namespace

std::vector<CurvedLimits> curved_limits(const Surface& surface, const PatchSet& facets,
                                        const RecognisedSurfaces& recognised, const CurvedGoals& goals,
                                        double plane_tolerance, RunControl& control) {
  std::vector<CurvedLimits> limits(recognised.surfaces.size());
  if (!goals.is_any()) return limits;
  const std::optional<double> asked = goals.tolerance;
  const std::vector<double> radii = largest_radii(surface, facets, recognised, control);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const RecognisedSurface& s = recognised.surfaces[SurfaceId(i)];
    if (!SurfaceMap::can_map(s.shape)) continue;
    const std::optional<double> elements = goals.elements_of(s);
    if (!asked && !elements) continue;
    // The distance of facets that hardly leave their surface is known only up to the plane tolerance.
    const double own = std::max(s.input_chord_height, plane_tolerance);
    const double excused = std::max(s.explained_height, plane_tolerance);
    const double turn = elements ? 2 * kHalfTurn / *elements : kMaxTurn;
    // A chord of the number of edges that is asked for. Its ends may be corners of the input that are off the surface.
    const double chord = elements ? radii[i] * (1 - std::cos(turn / 2)) : 0;
    double tolerance = asked.value_or(excused) + chord;
    if (tolerance < own) continue;
    CurvedLimits& of_surface = limits[i];
    of_surface.tolerance = tolerance;
    // The corners of the facets may be off their surface by more than rounding explains. The result is on the surface,
    // so this is a part of its distance from the input.
    const double off = std::max(0.0, s.deviation - kRecognitionTolerance * plane_tolerance);
    tolerance -= off;
    if (!(tolerance > 0)) {
      of_surface = {};
      continue;
    }
    // Rounding moves the input's vertices off their surface. Edges between them are deeper by this distance, and the
    // surface's normals at them turn more.
    of_surface.max_height = tolerance + plane_tolerance;
    if (s.shape.kind == SurfaceKind::kTorus) {
      // On the inner half of a torus, edges around the axis lie outside of the tube and other edges inside. So the
      // facets and the result may be on different sides, and their distances from the surface add up.
      of_surface.max_height = std::min(tolerance + plane_tolerance - own, kMaxPartOfTube * s.shape.minor_radius);
      if (of_surface.max_height < kMinShare * own) {
        of_surface = {};
        continue;
      }
    }
    // A chord of a circle around the axis of a cone lies below the surface by a part of its distance from the circle.
    // The rest of that distance is along the surface.
    const bool is_cone = s.shape.kind == SurfaceKind::kCone;
    const double below = is_cone ? std::cos(s.shape.half_angle) : 1, along = is_cone ? std::sin(s.shape.half_angle) : 0;
    // Where a boundary is cut anew, the result may leave the input both in depth and along the surface. The proven
    // bound is the root of the sum of their squares. Boundaries that stay are as deep as the input's facets.
    // Pieces that are finer than the facets are as far from them as the facets are deep.
    const double of_circles =
        std::max({kDepthShare * tolerance, std::min(chord + off, tolerance), std::min(own, tolerance)});
    const double depth = std::max(below * of_circles, std::min(own, kDepthShare * tolerance));
    const double sideways = std::sqrt(tolerance * tolerance - depth * depth);
    of_surface.max_height = std::min(of_surface.max_height, depth + plane_tolerance);
    of_surface.boundary_tolerance = std::min(tolerance, of_circles * (1 + kRounding) + plane_tolerance);
    if (along > 0) of_surface.boundary_tolerance = std::min(of_surface.boundary_tolerance, sideways / along);
    if (s.shape.kind == SurfaceKind::kTorus) limit_on_tube(s.shape, own, of_surface);
    of_surface.boundary_sideways =
        kSidewaysShare * std::min(sideways, below * std::sqrt(tolerance * tolerance - of_circles * of_circles));
    of_surface.max_turn = std::min(turn, kMaxTurn);
    const double smallest = s.shape.kind == SurfaceKind::kTorus ? s.shape.minor_radius : radii[i];
    of_surface.max_turn += 4 * plane_tolerance / smallest;
  }
  return limits;
}

}  // namespace remesh
