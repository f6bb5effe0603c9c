/// Decides which open edges are the two sides of a seam.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/mending/edges/open_edges.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The conditions under which open edges are the two sides of a seam.
struct SeamRules {
  double tolerance = 0;  ///< in local units; the distance that the rounding of the coordinates explains
  /// Edges that run the same way may also be partners, because faces will be turned over if necessary.
  bool takes_alike = false;
};

/// Two open edges, by their numbers, and how they lie relative to each other.
struct SeamPair {
  std::uint32_t i = 0, j = 0;
  Fit fit;
};

struct SeamPartners {
  std::vector<SeamPair> pairs;          ///< an edge is in two pairs only if all edges there become one
  std::vector<std::uint8_t> is_beside;  ///< one per edge: whether another edge could be its partner
  bool is_complete = true;              ///< false: too many edges lie beside each other to test them all
};

/// Pairs the edges that lie beside each other within the tolerance. Edges no longer than twice the tolerance, and edges
/// of faces that are as thin as that (kThinFace), have no partners. More than two edges may lie beside each other, for
/// example where two bodies touch along a seam. Then the function chooses the pairing that
/// 1. leaves the fewest edges without a partner,
/// 2. turns over the fewest faces,
/// 3. joins faces that are connected already (over edges, or over partners that had no alternative), and then faces
///    with the same label,
/// 4. has the smallest angles behind the faces, that is, through the bodies, so that two bodies that touch stay two,
/// 5. bends the surface by the smallest angles.
/// Several pairings may be equally good, for example if a surface occurs twice in the same place. Then all these edges
/// become one, as they would if coordinates were exact; or if some have no partner, all stay open. An edge that runs
/// the same way as its partner gets none if that would make a piece one-sided.
/// Cost:    O(b log b) for b edges; O(n) more if positions alone do not decide.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
SeamPartners find_seam_partners(const Surface& surface, const Adjacency& edges, const OpenEdges& open,
                                const SeamRules& rules, RunControl& control);

}  // namespace remesh
