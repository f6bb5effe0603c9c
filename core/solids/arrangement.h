/// Makes triangles that cross or touch each other one conforming surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "core/solids/soup.h"

namespace remesh {

/// A thin triangle that the arrangement has dropped, because it covers as much from one side as from the other, and has
/// an edge of its own.
struct Flap {
  Triangle corners;  ///< vertices of the arrangement, and behind these the flaps' own
  std::vector<Cover> covers;
};

/// A surface whose triangles meet in common vertices and edges only, as far as `left` is empty.
struct Arrangement {
  std::vector<Vec3> positions;   ///< in the unit of the input; those of input vertices are unchanged, bit for bit
  std::vector<VertexId> vertex;  ///< by vertex: the vertex of the input; invalid for new ones
  std::vector<Triangle> faces;
  std::vector<std::uint32_t> cover_begin{0};
  std::vector<Cover> covers;  ///< the input's triangles of which each triangle is a piece, as in a Soup
  std::vector<Flap> flaps;
  std::vector<Vec3> flap_positions;   ///< those of the flaps' own vertices
  std::vector<std::uint8_t> was_cut;  ///< by triangle of the input
  std::size_t curves = 0;             ///< the pairs of triangles that crossed each other
  std::size_t shared = 0;             ///< the triangles that are pieces of several ones of the input
  std::size_t rounds = 0;  ///< how often points were joined again, since their rounding had made new crossings
  double moved = 0;        ///< how far points of the input may have moved, in the unit of the input
  std::vector<std::pair<FaceId, FaceId>> left;  ///< triangles that still intersect; the first ones, if there are many
  bool is_given_up = false;                     ///< too much crosses or touches too much else; the rest is empty
  bool is_changed = false;  ///< false: nothing crosses or touches anything, and the triangles are those of the input

  std::span<const Cover> covers_of(std::size_t f) const {
    return std::span(covers).subspan(cover_begin[f], cover_begin[f + 1] - cover_begin[f]);
  }
};

/// Cuts triangles along their intersections. First, whatever lies within a share of `distance` of each other becomes
/// shared, see find_contacts. What crosses then crosses at an angle, see find_crossings. Where the rounding of new
/// points makes triangles cross again, features that are a few rounding steps apart are joined, and the triangles are
/// cut again; how far apart they may be grows from round to round. At last, triangles thinner than half of `distance`
/// are taken away where that makes no others intersect, but for the smallest share.
/// Input:   triangles with an area; no two vertices with equal coordinates; the share, above 0 and at most 1.
/// Output:  points may have moved by more than `distance`, and triangles may still intersect, see fault_of.
/// Holds:   the result is the same for any number of threads. It does not depend on the order of vertices and
///          triangles, except for its own order.
/// Errors:  kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for n triangles and points, and the pairs that cross.
Arrangement arrange(std::span<const Vec3> positions, std::span<const Triangle> faces, double distance,
                    RunControl& control, double share = 1);

/// The reason why an arrangement is not good enough.
enum class ArrangementFault : std::uint8_t {
  kNone,
  kMovesTooFar,  ///< joins that follow on each other have moved a point by more than the distance
  kFails,        ///< triangles still intersect, or the arrangement has failed a check
  kTooMuch       ///< it was given up
};

ArrangementFault fault_of(const Arrangement& arranged, double distance);

/// Says with which share of the distance triangles are arranged anew.
/// Input:  the last share and the fault of its arrangement.
/// Output: nothing if nothing else is worth trying.
std::optional<double> next_share(double share, ArrangementFault fault);

}  // namespace remesh
