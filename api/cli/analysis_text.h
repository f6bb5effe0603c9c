/// Describes an analysis in a few lines for the terminal.
#pragma once

#include <string>

#include "core/output/report/report.h"

namespace remesh::cli {

/// Describes what a mesh contains: its size, a table of its surfaces from the largest area to the smallest, the
/// diagnostics, and the number of faces that a remeshing would make: with these options, and if something is curved,
/// with other numbers of elements per circle.
/// Input:  the report of an analysis, and the name of the mesh.
/// Output: lines of text; each ends with a line end.
std::string analysis_text(const Report& report, const std::string& name);

}  // namespace remesh::cli
