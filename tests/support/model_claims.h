/// Holds what recognition claims of a model against the truth about the model.
#pragma once

#include <string>
#include <vector>

#include "tests/support/claims.h"
#include "tests/support/primitives.h"

namespace remesh::test {

/// Returns what is wrong about the claims, as sentences. It is empty if all of this holds:
/// - Every face has the kind of its surface.
/// - The claimed surface lies within 3 steps of the true one over the claimed faces. For a surface of revolution this
///   is asked at the corners only, because nobody knows it between them.
/// - Radii are within 3 steps if the faces cover an arc of at least 90 degrees.
/// - All faces of one curved surface belong to one record, and the record counts no others.
/// - The record tells the sweep, the side, the chord height and the tolerance as they are.
/// Input: `step` - the step to which the model's coordinates were rounded.
std::vector<std::string> faults_of(const primitives::Model& model, const Claims& claims, double step);

}  // namespace remesh::test
