/// Seams: open edges whose partners run beside them, no further off than the coordinates are rounded.
#pragma once

#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mending/mend.h"
#include "core/mending/seam_partners.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Where the vertices were that have become one, in local units. Who joins them again has to know.
class JoinedPlaces {
 public:
  /// Of a vertex that nothing was joined with, its place.
  Box3 box_of(const Surface& surface, VertexId v) const;
  void add(const Surface& surface, const std::vector<std::pair<VertexId, Box3>>& boxes, RunControl& control);

 private:
  std::vector<std::pair<VertexId, Box3>> boxes_;  ///< by `vertex_source`, ascending
};

/// Joins the two sides of seams, as where the last angle around a cylinder gave -6e-15 instead of 0.
/// `find_seam_partners` tells which open edges are partners: their ends lie within the tolerance of each other. Two
/// sheets that lie on each other within a few tolerances are no seam: joined, they would be a pocket without a volume.
class Seams {
 public:
  explicit Seams(const SeamRules& rules) : rules_(rules) {}

  /// Joins those that there are. It may be called again after the surface has changed, as where the sides of a seam are
  /// subdivided differently and split_t_junctions has made them alike.
  /// Input:   a welded surface.
  /// Output:  the surface so mended, with Mend::kYes: the ends of partners have become one vertex, at the least place
  ///          of theirs in lexicographic order. A polygon may have a corner twice in a row after it (see mend_faces).
  ///          Where so many open edges lie beside each other that all pairs are too many, none is joined.
  /// Holds:   no vertex moves by more than the tolerance, however often this is called, and no two vertices further
  ///          apart than it become one: chains of near ones do not collapse. No face collapses. An edge that was not
  ///          one before has as many faces one way as the other (or an even number, if `takes_alike`): two, or more
  ///          where several surfaces touch along it, as they would if coordinates were exact. Joins that would spoil
  ///          this are left out. Vertices become one only where an edge between their faces closes, so that none is
  ///          pinched. The same whatever the order of faces and vertices.
  /// Returns: whether the surface changed.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:    O(b log b) in open edges; if some are joined, O(n) more. Nothing where none is open.
  bool close(Surface& surface, const Adjacency& edges, Mend mend, RunControl& control);

  /// Counts as seam the edges joined by all calls, or with Mend::kNo those that would be; and apart the open edges
  /// that are left although others lie, or lay, beside them within the tolerance. Elements are a face of each.
  void tell(std::vector<Diagnostic>& diagnostics) const;

 private:
  SeamRules rules_;
  JoinedPlaces places_;
  Diagnostic found_, left_;
  using Ends = std::pair<VertexId, VertexId>;
  std::vector<Ends> left_ends_;  ///< of the edges in left_, by `vertex_source`, ascending
  double width_ = 0;             ///< model units
  bool is_mended_ = false;
  bool are_too_many_ = false;
};

}  // namespace remesh
