/// Parallel loops whose results do not depend on the number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/run_control.h"

namespace remesh {

/// Splits [0, n) into blocks of `size`, calls `body(begin, end)` on each in parallel and returns the results in the
/// order of the blocks. The blocks depend on n alone: whoever combines the results in order gets the same bits from any
/// number of threads. A point of cancellation before each block.
template <class Result, class Body>
std::vector<Result> map_blocks(std::size_t n, std::size_t size, RunControl& control, const Body& body) {
  std::vector<Result> results((n + size - 1) / size);
  tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t block) {
    control.check();
    results[block] = body(block * size, std::min(n, (block + 1) * size));
  });
  return results;
}

/// The same for a body that keeps its results itself, by index.
template <class Body>
void for_blocks(std::size_t n, std::size_t size, RunControl& control, const Body& body) {
  tbb::parallel_for(std::size_t{0}, (n + size - 1) / size, [&](std::size_t block) {
    control.check();
    body(block * size, std::min(n, (block + 1) * size));
  });
}

}  // namespace remesh
