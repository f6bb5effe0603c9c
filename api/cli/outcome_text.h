/// Describes the outcome of a remeshing to the person who has started it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "api/operations.h"
#include "core/output/report/report.h"

namespace remesh::cli {

/// Describes a result in one to three lines.
/// Input:  `given` has the options that the user has given. A remedy is not named if all its options are among them.
/// Output: the first line has the numbers of faces, the least angle and the proven distance. The second line says what
///         was given up or missed, if anything was. The third line is the one remedy that would help most, if there is
///         one, as flags. A defect that keeps a mesher from filling the surface goes before the number of faces.
std::vector<std::string> outcome_lines(const Report& report, const api::Fields& given);

/// Describes the result of a server by its summary (Remesh-Summary) in one line.
std::string outcome_of_summary(std::string_view summary);

}  // namespace remesh::cli
