/// Seams: open edges whose partners run beside them, no further away than the coordinates are rounded.
#pragma once

#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mending/common/mend_mode.h"
#include "core/mending/edges/seam_partners.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The places, in local units, of vertices that have become one. A later join of the same vertices has to know them.
class JoinedPlaces {
 public:
  /// The box of the places that were joined in a vertex. If nothing was joined, it is the vertex's own place.
  Box3 box_of(const Surface& surface, VertexId v) const;
  void add(const Surface& surface, const std::vector<std::pair<VertexId, Box3>>& boxes, RunControl& control);

 private:
  std::vector<std::pair<VertexId, Box3>> boxes_;  ///< by `vertex_source`, ascending
};

/// Joins the two sides of seams. For example, a cylinder may have a seam because its last angle was computed as -6e-15
/// instead of 0.
/// `find_seam_partners` decides which open edges are partners: their ends lie within the tolerance of each other. Two
/// sheets that lie on each other within a few tolerances are no seam, because joining them would make a pocket without
/// a volume.
class Seams {
 public:
  explicit Seams(const SeamRules& rules) : rules_(rules) {}

  /// Joins all seams. It may be called again after the surface has changed, for example if the sides of a seam were
  /// subdivided differently and split_t_junctions has made them alike.
  /// Input:   a welded surface.
  /// Output:  with MendMode::kYes, the mended surface. The ends of partners have become one vertex, at the
  ///          lexicographically smallest of their places. Afterwards a polygon may have a corner twice in a row (see
  ///          mend_faces). If so many open edges lie beside each other that there are too many pairs to test, none is
  ///          joined.
  /// Holds:   the result is the same for any order of faces and vertices. Joins that would violate one of the following
  ///          are left out:
  ///          - No vertex moves by more than the tolerance, however often this is called.
  ///          - No two vertices further apart than the tolerance become one, so chains of near vertices do not
  ///            collapse.
  ///          - No face collapses.
  ///          - An edge that results from a join has as many faces one way as the other (or an even number, if
  ///            `takes_alike`). It has two faces, or more if several surfaces touch along it, as they would if
  ///            coordinates were exact.
  ///          - Vertices become one only if an edge between their faces closes, so that no vertex becomes pinched.
  /// Returns: whether the surface changed.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:    O(b log b) for b open edges; O(n) more if some are joined; nothing if no edge is open.
  bool close(Surface& surface, const Adjacency& edges, MendMode mend, RunControl& control);

  /// Reports the edges that all calls have joined, or with MendMode::kNo would join, as seam. Reports separately the
  /// edges that stay open although other open edges lie, or lay, beside them within the tolerance. Elements are one
  /// face of each edge.
  void report(std::vector<Diagnostic>& diagnostics) const;

 private:
  SeamRules rules_;
  JoinedPlaces places_;
  Diagnostic found_, left_;
  using Ends = std::pair<VertexId, VertexId>;
  std::vector<Ends> left_ends_;  ///< ends of the edges in left_, by `vertex_source`, ascending
  double width_ = 0;             ///< in model units
  bool is_mended_ = false;
  bool are_too_many_ = false;
};

}  // namespace remesh
