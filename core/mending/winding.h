/// Which way faces look: the same way over each edge, and closed shells the way they should.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Turns faces over so that neighbours look the same way, piece by piece; pieces are connected over edges with two
/// faces. In each the faces of less area turn. A piece for which there is no such way (a Moebius strip) stays as it is.
/// Output:  counts inconsistent_winding: with Mend::kYes the faces turned, and the pieces that stay (one face of each);
///          else the edges whose two faces look opposite ways (their first faces).
/// Returns: whether the surface changed.
/// Cost:    O(n).
bool unify_winding(Surface& surface, const Adjacency& edges, Mend mend, std::vector<Diagnostic>& diagnostics,
                   RunControl& control);

/// The faces of the closed shells that look the wrong way.
struct InsideOutFaces {
  std::vector<std::uint8_t> is_inside_out;  ///< by face; empty if none is
  std::vector<FaceId> first;                ///< a face of each such shell
};

/// Finds the closed shells that look the wrong way (geometry/inside_out.h). Polygons are judged as what they cover.
/// Input:   `labels`: those of the input that the surface came from.
InsideOutFaces find_inside_out_faces(const Surface& surface, const Adjacency& edges, const FaceLabels& labels,
                                     RunControl& control);

/// Finds them, and turns them over.
/// Input:   `labels`: those of the input that the surface came from.
/// Output:  counts inside_out, the shells; elements are the first face of each.
/// Returns: whether the surface changed.
bool turn_inside_out(Surface& surface, const Adjacency& edges, const FaceLabels& labels, Mend mend,
                     std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
