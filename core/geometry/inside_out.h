/// Closed shells of a surface that look the wrong way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells.h"
#include "core/mesh/adjacency.h"

namespace remesh {

struct InsideOut {
  std::vector<std::uint8_t> is_inside_out;  ///< per face; empty if none is
  std::vector<FaceId> first_faces;          ///< the first face of each such shell, ascending
};

/// Finds the closed shells (shells.h) that look the wrong way, from outside in:
/// - A shell that lies in none looks outwards, as does one that lies in a cavity.
/// - A shell that lies in the solid inside another one, and has a label of that one, is a cavity of the same body and
///   looks inwards.
/// - If it has labels of its own, it may be a solid of its own, or a cavity with a name. It is right as it is, unless
///   both look inwards and the outer one is wrong: then a body was mirrored with what is in it.
/// A shell is judged as if those around it looked the right way, so turning over what is found leaves none. Two shells
/// share a label where a face of one and a face of the other belong to the same object, group and material.
/// Input:   triangles, three corners each, and their labels; coordinates within [-2^250, 2^250].
/// Holds:   where it is in doubt, a shell is not called wrong:
///          - A shell on whose edges open pieces stand is not judged: they may be of a body that it lies in. Nor is one
///            around which the open pieces wind otherwise than around the shell that it lies in (winding_number.h).
///          - A shell that crosses the one around it is no cavity of that one. Nor is one that crosses another and has
///            half its box in the box of that one: a pin in its hole, with other facets.
///          - Of shells that coincide, those that look the right way count as the outer ones. One that looks as they do
///            and has a label of theirs is the same once more.
///          For nothing else see ShellNesting.
/// Cost:    O(n) for separate bodies; see ShellNesting.
InsideOut find_inside_out(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                          const BodyLabels& labels, RunControl& control);

}  // namespace remesh
