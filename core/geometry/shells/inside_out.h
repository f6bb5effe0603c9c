/// Finds the closed shells of a surface that have the wrong orientation.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/adjacency.h"

namespace remesh {

struct InsideOut {
  std::vector<std::uint8_t> is_inside_out;  ///< per face; empty if none is
  std::vector<FaceId> first_faces;          ///< the first face of each shell that is inside out, ascending
};

/// Finds the closed shells (shells.h) that have the wrong orientation. It judges them from outside in:
/// - A shell that lies in no other shell, or in a cavity, has to face outwards.
/// - A shell that lies in the solid inside another one, and shares a label with it, is a cavity of the same body and
///   has to face inwards.
/// - If such a shell has labels of its own, it may be a solid of its own, or a cavity with a name, so either way is
///   right. The exception is that both face inwards and the outer one is wrong: then a body was mirrored together with
///   its contents, and the inner shell is wrong, too.
/// A shell is judged as if the shells around it had the right orientation. So if all shells that are found are turned
/// over, all orientations are right. Two shells share a label if a face of one and a face of the other belong to the
/// same object, group and material.
/// Input:   triangles, three corners each, and their labels; coordinates within [-2^250, 2^250].
/// Holds:   in case of doubt, a shell is not called wrong:
///          - A shell is not judged if open pieces stand on its edges, because they may belong to a body that it lies
///            in. It is not judged either if the winding number of the open pieces around it differs from that around
///            the shell that it lies in (winding_number.h).
///          - A shell that crosses the one around it is no cavity of that one. The same goes for a shell that crosses
///            another one and has half of its box in the other one's box, such as a pin in its hole that has different
///            facets.
///          - If shells coincide, those with the right orientation count as the outer ones. Another shell with the same
///            orientation and one of their labels is a copy.
///          Everything else is as in ShellNesting.
/// Cost:    O(n) for separate bodies; see ShellNesting.
InsideOut find_inside_out(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                          const BodyLabels& labels, RunControl& control);

}  // namespace remesh
