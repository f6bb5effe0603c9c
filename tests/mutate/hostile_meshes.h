/// Large meshes made to keep some stage busy for long: what a stop has to get through.
#pragma once

#include <string>

#include "tests/mutate/case_source.h"
#include "tests/support/random.h"

namespace remesh::mutate {

/// Makes one of them, in a random format and with options that let its stage work.
/// Input:  `size`: 1 for meshes of up to a million faces; less for a part of that.
Case make_hostile_case(double size, Random& random);

}  // namespace remesh::mutate
