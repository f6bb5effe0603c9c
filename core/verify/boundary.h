/// The edges that bound patches: are they the input's, less vertices within tolerance, plus new ones on their lines?
///
/// The input's bounding edges form a graph. A vertex of it that the output uses is kept; one that it does not use may
/// be gone only if exactly two bounding edges meet there, with the same patches on the same sides. The kept vertices
/// cut the graph into chains. So they do with the output's bounding edges, where the vertices between them are new, and
/// again inside one run of two edges each. The output is right if its chains are the input's, one for one: the same two
/// ends, the same patches on the same sides; what lies between the ends in the input within tolerance of the straight
/// line, what lies there in the output on it to rounding, in order. That is conformity and the keeping of loops in one:
/// nothing is left for a crack, a T-junction, a filled hole or a bridged slot, nor for a sheet missing or added at an
/// edge of several.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/boundary_graph.h"
#include "core/verify/model.h"
#include "core/verify/verification_faults.h"

namespace remesh::verification {

/// The bounding edges of both sides.
struct Seams {
  BoundaryGraph input, output;
};

struct Boundary {
  std::int64_t input_vertices = 0;  ///< that faces use
  std::vector<double> deviation;    ///< of each patch: largest distance of a dropped boundary vertex to its chord
  std::vector<double> slivers;      ///< of each patch: area between the input's chains and the output's
};

/// Reports kLostVertex, kLostLoop, kBoundary, kChord, kForeignVertex, kNewVertex, kNewOffLine.
/// Cost:   O(n log n).
Boundary check_boundary(const Model& model, const Seams& seams, Findings& findings, RunControl& control);

}  // namespace remesh::verification
