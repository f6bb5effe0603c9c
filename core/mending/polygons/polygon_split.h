/// Triangulates a single polygon in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mending/polygons/polygon_spikes.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

enum class PolygonKind {
  kPlanar,        ///< flat within the tolerance, and simple; it may touch itself, as along a bridge to a hole
  kNotPlanar,     ///< simple in its best plane, but not flat
  kSelfCrossing,  ///< crosses itself in its best plane, or has no area there
};

struct PolygonSplit {
  PolygonKind kind = PolygonKind::kPlanar;
  bool has_two_ways = false;  ///< a convex quadrilateral; its other diagonal cuts it as well
  /// The corner numbers of each triangle.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// The spikes that were cut off first, as in cut_spikes; the corners of `outline` are ascending. Both lists are empty
  /// if there is no spike. `kind` and `triangles` are those of the outline.
  Spikes spikes;
  double spike_tolerance = 0;  ///< the tolerance with which spikes were looked for; 0: they are exact

  bool has_spikes() const { return !spikes.needles.empty(); }
};

/// Tolerances, in the units of the points.
struct PolygonTolerances {
  double plane = 0;   ///< how far from its plane the corners of a flat polygon may be
  double spikes = 0;  ///< how far a spike's way back may be from its way out; 0: only exact spikes are cut off
};

/// Classifies a polygon and triangulates it. The triangulation is constrained Delaunay in the plane of the polygon's
/// Newell normal. If the polygon crosses itself there, it is a fan from the lexicographically smallest corner, because
/// no triangulation would be right. If that fan covers over twice as much as another fan, the fan with the smallest
/// area is taken.
/// Spikes are cut off before:
/// - Spikes that come back part of the way, or within the tolerance, are always cut off.
/// - Exact reversals are cut off if they leave the polygon's plane (see cut_spikes_out_of_plane), or if the polygon
///   would cross itself with them, as it does if they run outwards.
/// - If the polygon is hardly higher than the tolerance, only exact spikes are cut off.
/// Input:  4 or more points, no two consecutive ones equal.
/// Output: no triangles if there is nothing but spikes.
/// Holds:  the polygon gets the same triangles wherever its loop begins and whichever way it runs, also if there are
///         ties.
PolygonSplit split_polygon(std::span<const Vec3> points, const PolygonTolerances& tolerances, RunControl& control);
inline PolygonSplit split_polygon(std::span<const Vec3> points, double tolerance, RunControl& control) {
  return split_polygon(points, {tolerance, tolerance}, control);
}

/// Calls visit(triangle) with a face that is a triangle, or with each of the triangles that split_polygon makes of
/// another face. The tolerance is in local units.
/// Returns: the kind of the polygon.
template <class Visit>
PolygonKind visit_triangles(const Surface& surface, FaceId f, RunControl& control, const Visit& visit,
                            double tolerance = 0) {
  const auto loop = surface.face(f);
  if (loop.size() == 3) {
    visit(Triangle{loop[0], loop[1], loop[2]});
    return PolygonKind::kPlanar;
  }
  std::vector<Vec3> points;
  points.reserve(loop.size());
  for (const VertexId v : loop) points.push_back(surface.local[v]);
  const PolygonSplit split = split_polygon(points, tolerance, control);
  for (const auto& [a, b, c] : split.triangles) visit(Triangle{loop[a], loop[b], loop[c]});
  return split.kind;
}

}  // namespace remesh
