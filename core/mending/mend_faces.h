/// Makes every face of the working surface one that has a plane: splits polygons that have none, drops zero-area faces.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Mends the faces of a welded surface.
/// Input:   the plane tolerance, in local units; `as_it_is`, per input face or empty: 1 forbids to make a polygon of it
///          or to hand it a vertex. Later stages ask for it where a polygon turned out to have no triangulation of its
///          own. `possible_rounding` says in local units how far the corners may have been moved by a rounding that is
///          not proven. A polygon that crosses itself is searched again for spikes within this distance, before it is
///          cut into a fan.
/// Output:  a surface that holds all that Surface promises. A polygon comes as triangles in its place if it is not
///          planar within the tolerance, crosses itself in its plane, touches itself, or is to stay as it is; no cut is
///          an edge of another face (see PolygonCuts), which may take new vertices. A corner that repeats the one
///          before it is dropped. Counts nonplanar_polygon, zero_area_face, and as duplicate_vertex the other faces
///          that lost a corner so.
/// Holds:   closed stays closed: a zero-area face is dropped by handing the vertices on its longest edges to the faces
///          beyond them, so that each of its edges meets its counterpart. It is kept where such a face is `as_it_is`,
///          and with Mend::kNo for `degenerate`, if it has three corners left.
/// Returns: whether anything had to be mended; if not, faces, corners and vertices are as they were.
/// Errors:  kEmptyMesh - no face has an area; kInvalidMesh - zero-area faces nest so deeply that mending them would
///          multiply the mesh.
/// Cost:    O(n log n).
/// Source:  rules.md, Faces without area; rules.md, Ladder.
bool mend_faces(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& as_it_is, Mend degenerate,
                std::vector<Diagnostic>& diagnostics, RunControl& control, double possible_rounding = 0);

/// Whether a face is a triangle with exactly collinear corners; mend_faces leaves few of them, or none.
bool is_without_area(const Surface& surface, FaceId f);
std::vector<FaceId> faces_without_area(const Surface& surface, RunControl& control);

/// Whether three points are exactly on one line (or coincide).
bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh
