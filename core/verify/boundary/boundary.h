/// Checks the edges that bound patches: they must be the input's, without some vertices that are within the
/// tolerance, and with new ones on their lines.
///
/// The input's bounding edges form a graph. A vertex of the graph that the output uses stays. A vertex that the
/// output does not use may be dropped only if exactly two bounding edges meet there, with the same patches on the
/// same sides. The vertices that stay cut the graph into chains. They also cut the output's bounding edges into
/// chains. There, the vertices between them are new, and again exactly two edges with the same patches on the same
/// sides meet at each.
///
/// The output is right if its chains correspond one to one to the input's chains: they have the same two ends and the
/// same patches on the same sides. The input's vertices between the ends are within the tolerance of the straight
/// line; the output's are on it to rounding, in order.
///
/// A chain with a curved patch beside it may have been cut anew. There both chains are followed together from end to
/// end, and must never be further apart than the largest tolerance of these patches plus the plane tolerance. Planes
/// beside it are kept: along their normals the chains are within twice the plane tolerance of each other. Such a chain
/// may be a loop through a single vertex that stays, or one of several between the same ends. Then the patches on its
/// sides tell which chain is which, and in which direction it runs. If the patches do not tell, the nearest chain is
/// taken.
///
/// A vertex that stays may be claimed to have been moved, if it is on a curved patch. All chains that end at such a
/// vertex are followed in the same way, even if they have only planes beside them. Then the largest tolerance of a
/// curved patch at their ends is allowed.
///
/// A patch that is kept has the same edges on both sides. So edges between such patches are left out of both graphs,
/// and of its vertices those of the other patches there are tested.
///
/// This proves conformity and the preservation of loops together:
/// it excludes a crack, a T-junction, a filled hole or a bridged slot, and a sheet that is missing or added at an
/// edge with several.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The bounding edges of the input and the output.
struct Seams {
  BoundaryGraph input, output;
};

struct Boundary {
  std::int64_t input_vertices = 0;  ///< number of input vertices that faces use
  std::vector<double> deviation;    ///< largest distance of a dropped boundary vertex from its replaced span, by patch
  std::vector<double> slivers;      ///< area between the input's chains and the output's, by patch
  // By patch, for curved patches (see curved_chain.h). They are empty if all patches are planes.
  std::vector<double> on_surface;  ///< largest PatchGap::on_surface
  std::vector<double> near_pole;   ///< largest PatchGap::near_pole
  std::vector<double> allowed;     ///< largest distance that is allowed along the patch's chains
};

/// Reports kLostVertex, kLostLoop, kBoundary, kReplacedSpan, kForeignVertex, kNewVertex, kNewOffLine.
/// Cost:   O(n log n).
Boundary check_boundary(const NumberedClaim& numbered, const Seams& seams, FoundFaults& faults, RunControl& control);

}  // namespace remesh::verification
