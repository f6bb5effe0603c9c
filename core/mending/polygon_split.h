/// Triangulates a single polygon in space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mending/polygon_spikes.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

enum class PolygonKind {
  kPlanar,        ///< flat within the tolerance and simple (it may touch itself, as along a bridge to a hole)
  kNotPlanar,     ///< simple in its best plane, but not flat
  kSelfCrossing,  ///< crosses itself in its best plane, or has no area there
};

struct PolygonSplit {
  PolygonKind kind = PolygonKind::kPlanar;
  bool has_two_ways = false;  ///< a convex quadrilateral: its other diagonal cuts it as well
  /// Corner numbers of each triangle.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// The spikes that were cut off first, as cut_spikes has them; the corners of `outline` ascend. Without a spike both
  /// are empty. `kind` and `triangles` are those of the outline.
  Spikes spikes;
  double spike_tolerance = 0;  ///< within which they were looked for; 0: they are exact

  bool has_spikes() const { return !spikes.needles.empty(); }
};

/// Both are in the points' units.
struct PolygonTolerances {
  double plane = 0;   ///< how far from its plane the corners of a flat polygon may be
  double spikes = 0;  ///< how far a spike's way back may be from its way out; 0: only exact ones go
};

/// Looks at a polygon and triangulates it: by its constrained Delaunay triangulation in the plane of its Newell normal;
/// one that crosses itself there by a fan from its lexicographically smallest corner, since no triangulation of it is
/// right. Spikes are cut off before. Those that come back a part of the way or within the tolerance always go. Exact
/// reversals go if they leave the polygon's plane (see cut_spikes_out_of_plane), or if the polygon would cross itself
/// with them, as it does if they run outwards. A polygon that is hardly higher than the tolerance has exact spikes
/// only.
/// Input:  4 or more points, no two consecutive ones equal.
/// Output: no triangles if nothing but spikes is there.
/// Holds:  the polygon gets the same triangles wherever it begins and whichever way it runs, ties included.
PolygonSplit split_polygon(std::span<const Vec3> points, const PolygonTolerances& tolerances, RunControl& control);
inline PolygonSplit split_polygon(std::span<const Vec3> points, double tolerance, RunControl& control) {
  return split_polygon(points, {tolerance, tolerance}, control);
}

/// Calls visit(triangle) with a face, if it is one, else with those that split_polygon makes of it. The tolerance is in
/// local units.
/// Returns: what kind of polygon it is.
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
