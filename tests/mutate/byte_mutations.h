/// Changes to the bytes of a file, whatever they mean.
#pragma once

#include <string>

#include "tests/support/random.h"

namespace remesh::mutate {

/// Whether the bytes are text: numbers and lines are changed then, else bytes and floats.
bool is_text(const std::string& bytes);

/// A number as text that is likely to be forgotten: 0, -0, huge, tiny, not a number, with many digits.
std::string odd_number(Random& random);

/// Changes something, once.
/// Output: the words for what was done.
std::string mutate_bytes(std::string& bytes, Random& random);

}  // namespace remesh::mutate
