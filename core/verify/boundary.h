/// The edges that bound patches: are they the input's, less vertices within tolerance?
///
/// The input's bounding edges form a graph. A vertex of it that the output uses is kept; one that it does not use may
/// be gone only if exactly two bounding edges meet there, with the same patches on the same sides. The kept vertices
/// cut the graph into chains. The output is right if its bounding edges are these chains, one for one: the same two
/// ends, the same patches on the same sides, all that lies between the ends within tolerance of the straight line. That
/// is conformity and the keeping of loops in one: nothing is left for a crack, a T-junction, a filled hole or a bridged
/// slot, nor for a sheet missing or added at an edge of several.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/edge_table.h"
#include "core/verify/findings.h"
#include "core/verify/model.h"

namespace remesh::verification {

struct Boundary {
  std::vector<double> deviation;  ///< of each patch: largest distance of a dropped boundary vertex to its chord
  std::vector<std::uint8_t> is_on_boundary;  ///< of each vertex: a bounding edge of the input ends there
  std::vector<double> slivers;  ///< of each patch: area between the boundary's chains and the edges that replace them
};

/// Reports kLostVertex, kLostLoop, kBoundary, kChord.
/// Input:  the bounding edges of both sides, from list_boundary.
/// Cost:   O(n log n).
Boundary check_boundary(const Model& model, const std::vector<Edge>& input, const std::vector<Edge>& output,
                        Findings& findings, RunControl& control);

}  // namespace remesh::verification
