/// Gives faces the right orientation: the same as their neighbours', and outwards or inwards as closed shells should
/// have it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/common/mend_mode.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Turns faces over so that neighbours have the same orientation. It works piece by piece, where pieces are connected
/// over edges with two faces. If a piece is closed, those faces turn with which it would enclose a negative volume, or
/// a positive one if it is a cavity (inside_out.h). Otherwise the faces of smaller total area turn. A piece
/// that has one orientation already keeps it, and so does a piece that cannot be wound consistently (a Moebius strip).
/// Input:   `labels` are those of the input from which the surface came.
/// Output:  counts inconsistent_winding. With MendMode::kYes, counts the faces that turned, and the pieces that stay
///          (one face of each); otherwise the edges whose two faces have opposite orientations (the first face of
///          each).
/// Returns: whether the surface changed.
/// Cost:    O(n); see find_inside_out for closed pieces.
bool unify_winding(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                   std::vector<Diagnostic>& diagnostics, RunControl& control);

/// The faces of the closed shells that have the wrong orientation.
struct InsideOutFaces {
  std::vector<std::uint8_t> is_inside_out;  ///< by face; empty if none is
  std::vector<FaceId> first;                ///< one face of each such shell
};

/// Finds the closed shells that have the wrong orientation (inside_out.h). Polygons are judged by the
/// triangles that cover them.
/// Input:   `labels` are those of the input from which the surface came.
InsideOutFaces find_inside_out_faces(const Surface& surface, const Adjacency& edges, const FaceLabels& labels,
                                     RunControl& control);

/// Finds the closed shells that have the wrong orientation, and turns them over.
/// Input:   `labels` are those of the input from which the surface came.
/// Output:  counts the shells as inside_out; elements are the first face of each.
/// Returns: whether the surface changed.
bool turn_inside_out(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                     std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
