#include "tests/support/random.h"

#include <cstdlib>
#include <iostream>

namespace remesh {

std::uint64_t base_seed(std::uint64_t usual) {
  const char* text = std::getenv("REMESH_SEED");
  const std::uint64_t seed = text != nullptr ? std::strtoull(text, nullptr, 10) : usual;
  std::cout << "REMESH_SEED=" << seed << std::endl;
  return seed;
}

}  // namespace remesh
