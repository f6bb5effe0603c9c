/// Draws options from the API's table, so that new options are drawn automatically.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "api/options.h"
#include "tests/support/random.h"

namespace remesh::mutate {

using OptionTexts = std::vector<std::pair<std::string, std::string>>;

/// Draws some options, none of which excludes another.
/// Input: `diagonal` - the diagonal of the mesh's bounding box, for values that may be lengths.
OptionTexts draw_options(Random& random, double diagonal);

/// Formats options as flags of the command line: `--min-angle-deg 30 --format obj`.
std::string as_flags(const OptionTexts& options);

}  // namespace remesh::mutate
