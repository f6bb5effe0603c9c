/// Closes holes by flat faces, and describes the holes that stay open.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/common/mend_mode.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The holes that are closed. Lengths are in model units.
struct HoleRules {
  MendMode mend = MendMode::kNo;           ///< kNo: holes are only reported
  std::optional<std::uint64_t> max_edges;  ///< holes whose rims have at most this many edges are closed
  double size = 0;                         ///< holes whose rims are smaller than this are closed; 0: not given
  double diagonal = 0;                     ///< of the bounding box
  double plane_tolerance = 0;              ///< how far the vertices of a rim may be from its plane
};

/// Closes openings that are flat, each by one polygon of existing vertices, and describes the others. A hole is closed
/// if all its rims are selected: by the number of their edges or by their size. Without either option, holes are
/// selected that are small by themselves, with at most 12 edges or under 5 % of the diagonal. A hole stays open if its
/// face would meet another face anywhere but in the rim, or if a bridge to an inner rim would be an edge of other
/// faces. The new face gets the labels that the faces along the largest part of the rims have, and the source of the
/// face with these labels at the longest edge. It stands behind the last face of that source, and in Surface::caps.
/// Input:   `labels` are those of the input's faces.
/// Output:  whether the surface changed. `diagnostics` gets closed_hole, whose elements are the sources of the new
///          faces. `left` continues the message of open_boundary. It names the holes that stay open, with place, size
///          and the option that closes them, if they are small by themselves or were selected.
/// Holds:   what is closed does not depend on the order of the faces, nor on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(b log b) for b open edges, and O(n + k log n) for k triangles of closed holes.
bool close_holes(Surface& surface, const Adjacency& edges, const FaceLabels& labels, const HoleRules& rules,
                 std::vector<Diagnostic>& diagnostics, Advice& left, RunControl& control);

}  // namespace remesh
