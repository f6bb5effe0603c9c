/// Makes sure that every face of the working surface has a plane: splits polygons that have none, and drops faces
/// without area.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/common/mend_mode.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Drops repeated corners and faces without area from a welded surface, as mend_faces does. Polygons with an area stay
/// polygons. Faces without area hide duplicates, turned copies and seams, because the edges that they lie on have one
/// face too many. So this function runs before duplicates, turned copies and seams are searched.
/// Returns: whether the surface changed.
/// Errors, cost, source: those of mend_faces.
bool clean_faces(Surface& surface, const std::vector<std::uint8_t>& keep_verbatim, MendMode degenerate,
                 std::vector<Diagnostic>& diagnostics, RunControl& control);

/// Mends the faces of a welded surface.
/// Input:   `plane_tolerance` is in local units. `keep_verbatim` has one entry per input face, or is empty. A face with
///          1 there must not become a polygon and must not get another vertex; later stages ask for this if a polygon
///          turned out to have no triangulation of its own. `possible_rounding` is, in local units, how far a rounding
///          that is not proven may have moved the corners. A polygon that crosses itself is searched again for spikes
///          within this distance before it is cut into a fan.
/// Output:  a surface that satisfies all that Surface promises. A polygon is replaced by triangles if it is not planar
///          within the tolerance, crosses itself in its plane, touches itself, or is marked in `keep_verbatim`. No cut
///          is an edge of another face (see PolygonCuts), which may take new vertices. A corner that repeats the one
///          before it is dropped. Counts nonplanar_polygon and zero_area_face. Other faces that lost a repeated corner
///          are counted as duplicate_vertex.
/// Holds:   a closed surface stays closed. When a zero-area face is dropped, the vertices on its longest edges are
///          handed to the faces beyond these edges, so that each edge still meets its counterpart. A zero-area face is
///          not dropped if one of the faces that would get its vertices is marked in `keep_verbatim`, or if
///          `degenerate` is MendMode::kNo and it has three corners left.
/// Returns: whether anything had to be mended. If not, faces, corners and vertices are unchanged.
/// Errors:  kEmptyMesh - no face has an area; kInvalidMesh - zero-area faces nest so deeply that mending them would
///          multiply the mesh.
/// Cost:    O(n log n).
/// Source:  rules.md, Faces without area; rules.md, Ladder.
bool mend_faces(Surface& surface, double plane_tolerance, const std::vector<std::uint8_t>& keep_verbatim,
                MendMode degenerate, std::vector<Diagnostic>& diagnostics, RunControl& control,
                double possible_rounding = 0);

}  // namespace remesh
