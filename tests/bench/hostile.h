/// Measures how the time of whole runs grows with the size of hostile surfaces.
#pragma once

#include <vector>

#include "tests/bench/rows.h"

namespace remesh::bench {

/// Remeshes a member of each hostile family (tests/support/hostile_families.h) in each size, once, with default
/// options, and unites a member of each family of solids and sheets that meet (tests/support/hostile_solids.h). Prints
/// seconds of the processor, their growth in a decade, the peak of memory, and what was cut short, as one line for each
/// family. Growth is told twice: with the size of the input, and with the faces of input and output
/// together, since bounds on work are for both.
void measure_hostile(const std::vector<int>& sizes, int workers, Rows& rows);

}  // namespace remesh::bench
