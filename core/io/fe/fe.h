/// Reads the surfaces of models for finite elements.
#pragma once

#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Returns whether a text looks like an input file of Abaqus: it begins with an asterisk, and has nodes.
bool is_abaqus(std::string_view text);
/// Returns whether a text looks like a bulk data file of Nastran: near its beginning there are grid points.
bool is_nastran(std::string_view text);

/// Reads the input files of Abaqus and CalculiX (`.inp`).
/// Input:   keyword lines `*NODE`, `*ELEMENT` and `*ELSET`, also within parts that are placed as they are.
/// Output:  triangles and quadrilaterals of shells, membranes and plane elements in the order of the file, those of
///          higher order by their corners. The groups are the sets of `*ELSET`, and for faces in none of them the set
///          that `*ELEMENT` names; a face in several sets is in the first one. Other elements are counted as
///          attribute_dropped.
/// Errors:  with the line: kInvalidMesh - not such a file, other files that it includes, nodes in other systems of
///          coordinates or made by rules, parts that are moved or placed twice, a number that two nodes or elements
///          have; kIndexOutOfRange - with the face, a node that there is not; kNonfiniteCoordinate; kMeshTooLarge -
///          more than `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
ReadResult read_abaqus(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Reads bulk data of Nastran (`.bdf`, `.nas`), with fields of 8 or 16 columns or divided by commas.
/// Output:  CTRIA3, CTRIAR, CTRIA6, CQUAD4, CQUADR and CQUAD8 in the order of the file, by their corners. The numbers
///          of their properties are groups. Other elements are counted as attribute_dropped.
/// Errors:  as read_abaqus.
/// Cost:    O(n log n).
ReadResult read_nastran(std::string_view content, const ReadLimits& limits, RunControl& control);

}  // namespace remesh
