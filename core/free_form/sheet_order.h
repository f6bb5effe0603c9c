/// Renumbers a sheet.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/free_form/sheet_operators.h"

namespace remesh {

/// Numbers the vertices of a sheet in this order, and its faces and witnesses along with them. What was removed is no
/// longer in the arrays.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
void rearrange(FreeSheet& free, const std::vector<VertexId>& order, RunControl& control);

}  // namespace remesh
