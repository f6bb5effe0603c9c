/// Finds the parts of a surface that are closed by themselves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"

namespace remesh {

/// The labels of faces. Each number stands for a combination of object, group and material. A face of a mesh has one
/// label. A face that stands for several others has the labels of all of them.
struct BodyLabels {
  std::vector<std::uint32_t> set_of;    ///< the set of labels of each face; empty if all faces have the same labels
  std::vector<std::uint32_t> begin{0};  ///< set s is labels[begin[s] .. begin[s + 1]), ascending; no two sets are equal
  std::vector<std::uint32_t> labels;

  bool are_alike() const { return set_of.empty(); }
  friend bool operator==(const BodyLabels&, const BodyLabels&) = default;
};

struct Shell {
  FaceId first;  ///< the shell's smallest face
  bool is_closed = true;
  bool has_open_neighbours = false;  ///< the shell is closed, but faces of open shells stand on its edges
  /// The signed volume. Volume, area and box are only set for closed shells.
  double volume = 0;
  double area = 0;
  Box3 box;

  /// Returns whether the shell encloses more than rounding. A doubled sheet does not.
  bool is_solid() const;
};

struct Shells {
  std::vector<Shell> all;                                          ///< in the order of their first faces
  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> of_face;  ///< by face
};

/// Finds the shells of a surface. Faces are connected over edges with two faces. At an edge with more faces, two of
/// them are connected if they alone have their labels there and run in opposite directions. A shell is closed if at
/// each edge as many of its faces run one way as the other. Therefore a cavity that touches the outer shell along an
/// edge, or a fin on a body, does not open a closed shell.
/// Shells that are not closed then are connected over edges with more faces, too: at such an edge, each two faces that
/// have solid between them are connected (faces_around_edge.h). So two bodies with a wall each between them are two
/// closed shells, also without labels. If they have a single wall between them, it closes the body that is behind its
/// faces, and the other body is open.
/// Input:   three corners per face, their edges and labels; coordinates within [-2^250, 2^250].
/// Output:  areas and boxes are set if there are several closed shells, or one of negative volume.
/// Holds:   the result is the same for any number of threads.
/// Cost:    O(n), and O(k log k) for an edge with k faces.
Shells find_shells(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                   const BodyLabels& labels, RunControl& control);

}  // namespace remesh
