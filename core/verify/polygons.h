/// What became of the input's polygons, before anything was remeshed: the surface that the other tests take for the
/// input is one that was mended, and mending may be wrong.
#pragma once

#include "core/base/run_control.h"
#include "core/verify/model.h"
#include "core/verify/verification_faults.h"
#include "core/verify/verify.h"

namespace remesh::verification {

/// Measures each polygon of more than three corners by its outline, as it was read, and holds against it the faces of
/// the surface that came of it. Together they must have the polygon's area vector; and if the polygon is flat, they
/// must cover no more than its area, or some of them lie on each other. Both hold up to what the tolerances move along
/// the outline. Only an outline that is clearly simple in its plane, once its spikes are cut off, says what triangles
/// are right. One that crosses or touches itself, as along a bridge to a hole, is left out. So is one of very many
/// corners, whose crossings would take too long to look for.
/// Input:   a claim with an input, or without one, and then nothing is tested. Reports kPolygon.
/// Cost:    O(corners of polygons); for one that fails, the square of its corners up to some thousand.
void check_polygons(const Claim& claim, const Model& model, Findings& findings, RunControl& control);

}  // namespace remesh::verification
