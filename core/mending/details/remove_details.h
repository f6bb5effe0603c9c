/// Removes details of a triangulated surface that are smaller than a size: short edges, narrow faces, flaps, narrow
/// notches and tiny components.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/base/work_bound.h"
#include "core/mending/details/detail_map.h"
#include "core/mending/details/rules.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A surface without details.
struct WithoutDetails {
  std::vector<Vec3> positions;       ///< by node, in the unit of the input
  std::vector<VertexId> vertex;      ///< by node: the vertex of the input that has this place, or invalid if none does
  std::vector<Triangle> faces;       ///< ascending by source
  std::vector<FaceId> source;        ///< the input's face of which each face is the image
  DetailMap map;                     ///< its images are nodes
  std::vector<FaceId> removed;       ///< the faces of the input without an image of their own, ascending
  std::uint64_t joined_edges = 0;    ///< the number of edges whose ends were joined
  std::uint64_t closed_slivers = 0;  ///< the number of narrow faces whose long side and opposite corner were joined
  std::uint64_t removed_tiny_components = 0;  ///< the number of parts that were removed as a whole
  std::uint64_t closed_narrow_notches = 0;    ///< the number of gaps whose two sides were joined
  std::vector<FaceId> at_narrow_notches;      ///< for each of these gaps, a face of the input where it began
  bool is_effort_spent = false;               ///< the bound on work was reached, so some details may be left

  bool is_changed() const {
    return joined_edges + closed_slivers + removed_tiny_components + closed_narrow_notches > 0;
  }
};

/// The removal of details. A step is one test of a face at a vertex. Good surfaces take fewer than 40 steps for each
/// face that is removed.
inline constexpr StageWork kWorkOfDetails{4, 0, 1 << 18};

/// Joins the ends of short edges, and the corner of a narrow face to the crease over which it stands, the smallest
/// first. Ties are broken by places. This goes on until no more detail can be removed. A detail stays in these cases:
/// - A point would be moved by more than is allowed, or a vertex that is fixed.
/// - The surface would no longer be homeomorphic to the input, with the borders on it: edges of one face or of more
///   than two, and edges between labels. (The link condition.) Flaps that hang on one edge are an exception.
/// - A face that is not noise would be turned by more than 60 degrees, or turned over if it is narrow itself, or become
///   narrower than the details that are removed.
/// - Two faces that are no details would lie on each other, as the walls of a slot would.
/// - It is one end of a strip whose other end cannot be removed: between two such faces, or between two borders.
/// Where a corner can take either of two places, it takes the one that bends planes and creases by less.
///
/// A part that is connected with nothing else and is no larger than a detail (TinyComponents) is removed as a whole, if
/// the remaining surface has a point within the allowed distance of all points of the part. Otherwise it stays as it
/// is. A narrow notch is a gap between two chains of open edges that meet at one end, its tip. If all of it is narrower
/// than a detail, up to another tip or to its mouth, its sides are joined to each other (NarrowNotches). So a hole may
/// be closed.
/// Input:   faces and vertices as above. Equal vertices of two faces have equal ids.
/// Output:  a surface with the input's vertices, but for those that had to go to an edge.
/// Holds:   the result depends on geometry, not on the order of faces, except for faces with equal corners.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n), and O(k) for each change at a vertex with k faces; the work is bounded by kWorkOfDetails.
/// Source:  the link condition: T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, Topology preserving edge
///          contraction, 1999.
WithoutDetails remove_details(const DetailRules& rules, RunControl& control);

}  // namespace remesh
