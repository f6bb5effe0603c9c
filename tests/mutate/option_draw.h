/// Options drawn from the contract's table, so that a new one is drawn by itself.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "api/options.h"
#include "tests/support/random.h"

namespace remesh::mutate {

using OptionTexts = std::vector<std::pair<std::string, std::string>>;

/// Draws some options, none of which excludes another.
/// Input: `diagonal` of the mesh's bounding box, for what may be a length.
OptionTexts draw_options(Random& random, double diagonal);

/// `--min-angle-deg 30 --format obj`: as the command line takes them.
std::string as_flags(const OptionTexts& options);

}  // namespace remesh::mutate
