/// Changes the bytes of a file, whatever they mean.
#pragma once

#include <string>

#include "tests/support/random.h"

namespace remesh::mutate {

/// True if the bytes are text. Numbers and lines of text are changed; otherwise bytes and floats are.
bool is_text(const std::string& bytes);

/// Returns a number as text that programs easily forget: 0, -0, huge, tiny, not a number, with many digits.
std::string odd_number(Random& random);

/// Makes one change.
/// Output: a description of the change.
std::string mutate_bytes(std::string& bytes, Random& random);

}  // namespace remesh::mutate
