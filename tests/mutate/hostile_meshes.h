/// Makes large meshes that keep some stage busy for a long time, so that a stop arrives in the middle of it.
#pragma once

#include <string_view>

#include "tests/mutate/case_source.h"
#include "tests/support/random.h"

namespace remesh::mutate {

/// Makes a random one of these meshes, in a random format and with options that let its stage work.
/// Input:  `size` - 1 for meshes of up to a million faces; a smaller number for a part of that.
///         `word` - only kinds with this word in their names are made.
/// Errors: std::invalid_argument - there is no such kind.
Case make_hostile_case(double size, std::string_view word, Random& random);

}  // namespace remesh::mutate
