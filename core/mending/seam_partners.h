/// Which open edges are the two sides of a seam.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/mending/open_edges.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// When open edges are the two sides of a seam.
struct SeamRules {
  double tolerance = 0;      ///< local units: what the rounding of the coordinates explains
  bool takes_alike = false;  ///< also edges that run the same way, as faces will be turned over where that is needed
};

/// Two open edges, by their numbers, and how they lie beside each other.
struct SeamPair {
  std::uint32_t i = 0, j = 0;
  Fit fit;
};

struct SeamPartners {
  std::vector<SeamPair> pairs;          ///< an edge is in two only where all become one
  std::vector<std::uint8_t> is_beside;  ///< of each edge, whether another one could be its partner
  bool is_complete = true;              ///< false: there were too many edges beside each other to look at
};

/// Pairs off the edges that lie beside each other within the tolerance.
/// Edges no longer than twice the tolerance, or of faces so thin (kThinFace), have no partners. Where more than two
/// edges lie beside each other, as where two bodies touch along a seam, that way is chosen which
/// 1. leaves the fewest without a partner,
/// 2. has the fewest faces turned over,
/// 3. joins what is connected already (over edges, or over partners where nothing else was beside these), then what has
///    one label,
/// 4. has the least angles behind the faces, that is through the bodies: so bodies that touch stay two,
/// 5. bends least.
/// Where several ways are as good, as where a surface is there twice, all these edges become one, as they would if
/// coordinates were exact; or if some have no partner, all stay open. An edge that runs the same way as its partner has
/// none if that would make a piece one-sided.
/// Cost:    O(b log b) in edges; O(n) more if it takes more than positions to decide.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
SeamPartners find_seam_partners(const Surface& surface, const Adjacency& edges, const OpenEdges& open,
                                const SeamRules& rules, RunControl& control);

}  // namespace remesh
