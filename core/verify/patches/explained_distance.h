/// Computes independently which distance of a result from a curved patch the faces of its input explain.
#pragma once

#include "core/base/run_control.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Returns whether the input of a curved patch explains this distance from its result. A facet, which is a set of
/// faces in one plane, explains its own chord height. Along each of two directions of the surface, this is the chord
/// height of an arc over which the surface turns as far as over the facet, but no farther than the facet turns against
/// the facets before and behind it, or than twice as far if there is only one of these. A direction in which no
/// neighbour turns explains nothing. So two circles of corners explain a cylinder, but no sphere: between the circles,
/// no facet turns along the axis. The facet with the largest explained distance counts.
/// Input:  neighbours that turn by more than `max_turn`, in radians, or that are not the only ones do not count.
///         `distance` is in the units of the model.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n), and usually much less, because few facets have to be tested.
bool explains_distance(const NumberedClaim& numbered, const EdgeTable& input_edges, PatchId patch, double max_turn,
                       double distance, RunControl& control);

}  // namespace remesh::verification
