/// The pieces of a surface that close by themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"

namespace remesh {

/// The labels of faces: each number stands for an object, a group and a material together. A face of a mesh has one. A
/// face that stands for several others has those of all of them.
struct BodyLabels {
  std::vector<std::uint32_t> set_of;    ///< the set of labels that each has; empty: all are labelled alike
  std::vector<std::uint32_t> begin{0};  ///< set s has labels[begin[s] .. begin[s + 1]), ascending; no two are equal
  std::vector<std::uint32_t> labels;

  bool are_alike() const { return set_of.empty(); }
  friend bool operator==(const BodyLabels&, const BodyLabels&) = default;
};

struct Shell {
  FaceId first;  ///< its smallest face
  bool is_closed = true;
  bool has_open_neighbours = false;  ///< closed, but faces of shells that are not stand on its edges
  double volume = 0;                 ///< signed; this and the rest of closed ones only
  double area = 0;
  Box3 box;

  /// A doubled sheet encloses nothing but rounding.
  bool is_solid() const;
};

struct Shells {
  std::vector<Shell> all;                                        ///< in the order of their first faces
  std::vector<std::uint32_t, LeftUnset<std::uint32_t>> of_face;  ///< by face
};

/// Finds the shells: faces are connected over edges of two faces, and at an edge of more over the two that alone have
/// their labels there and run in opposite directions. A shell is closed if at each edge as many of its faces run one
/// way as the other. So a cavity that touches the outer shell along an edge, and a fin on a body, leave closed what is.
/// Those that are not closed then are connected over edges of more faces, too, over each two of them that have solid
/// between them (around_edge.h). So two bodies with a wall each between them are two closed shells, also without
/// labels. Where they have one wall between them, it closes the body that it looks out of, and the other one is open.
/// Input:   three corners a face, their edges and labels; coordinates within [-2^250, 2^250].
/// Output:  areas and boxes are there where there are several closed shells, or one of negative volume.
/// Holds:   the same for any number of threads.
/// Cost:    O(n), and O(k log k) for an edge of k faces.
Shells find_shells(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                   const BodyLabels& labels, RunControl& control);

}  // namespace remesh
