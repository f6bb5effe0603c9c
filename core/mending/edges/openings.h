/// The openings of a surface, which its open edges bound.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A closed loop of open edges.
struct Rim {
  /// The vertices in the order of a face that would close the opening, so against the faces at the rim. The order
  /// begins at the vertex with the lexicographically smallest coordinates.
  std::vector<VertexId> vertices;
  Vec3 middle;        ///< the mean of all points of its edges, in local units
  double length = 0;  ///< in local units
  double size = 0;    ///< twice the distance of the farthest vertex from `middle`, in local units
};

/// The kind of an opening: whether a flat face closes it, or why none does.
enum class OpeningKind : std::uint8_t {
  kFlat,         ///< `outline` closes it
  kNotFlat,      ///< no plane has all vertices of its rim within the tolerance
  kWithoutArea,  ///< its rim encloses no area, as at a vertex that lies on an open edge
  kTangled,      ///< its rim crosses or touches itself or another one
  kMixed,        ///< the faces at its rims do not all look the same way, seen from it
  kNoBridge,     ///< each edge that could join its rims is an edge of other faces
};

/// A part of a plane between rims, or a single rim that lies in no plane.
struct Opening {
  OpeningKind kind = OpeningKind::kNotFlat;
  /// The min number of edges that a way from outside of all rims of the plane to this part crosses. Two openings that
  /// share an edge differ in this number. Either of them could be closed, but not both.
  std::uint32_t depth = 1;
  std::vector<Rim> rims;  ///< the outer one first; the others are holes of the face that closes the opening
  /// The polygon that closes a flat opening. It has the same orientation as the faces around. A bridge, which is an
  /// edge in both directions, leads to each further rim.
  std::vector<VertexId> outline;
};

/// Finds the openings of a surface.
/// Connected open edges are taken apart where they lie in different planes. The open edges of one plane divide it into
/// parts, and each bounded part is an opening that a face may close, if the faces at its edges all have the same
/// orientation. So a ring between two rims is one opening, an island in it has an opening of its own, and openings that
/// touch each other in a vertex are two.
/// Input:   a surface whose faces have consistent orientations; `tolerance` is how far vertices may be from their
///          plane, in local units.
/// Output:  the openings by the coordinates of their rims. Open edges that form no loop are in none of them.
/// Holds:   the result does not depend on the order of the faces, nor on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(b log b) for b open edges, and O(log n) for each bridge.
/// Source:  rules.md, Holes.
std::vector<Opening> find_openings(const Surface& surface, const Adjacency& edges, double tolerance,
                                   RunControl& control);

}  // namespace remesh
