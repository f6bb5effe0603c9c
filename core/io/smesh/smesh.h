/// Writes TetGen's format of surfaces.
#pragma once

#include <string>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"

namespace remesh {

/// Writes `.smesh`: nodes and facets, counted from 1, and a point in each hole and in each region. Each boundary
/// (boundaries.h) has its number as the marker of its facets, from 1 on; a comment `# marker 1: NAME` has its name. A
/// hole is the inside of a cavity, and a region that of any other closed shell. The attribute of a region, which TetGen
/// uses with -A, is its number from 1 on; the volume of its tetrahedra has no bound. `comments` are comments.
/// Holds:  every number is the shortest text that reads back to the same double; no name can end its line.
/// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - through `control`.
/// Cost:   O(n log n); see enclosed_volumes.
std::string write_smesh(const WriterInput& input, RunControl& control);

}  // namespace remesh
