/// Colours of the drawings in the plane, and numbers as text.
#pragma once

#include <cstddef>
#include <string>

#include "tests/figures/svg.h"

namespace remesh::figures {

inline const Colour kInk{0.10, 0.15, 0.22};
inline const Colour kFaint{0.72, 0.76, 0.81};
inline const Colour kPaper{0.93, 0.96, 0.99};
inline const Colour kOuter{0.09, 0.39, 0.67};
inline const Colour kHole{0.85, 0.37, 0.05};
inline const Colour kMissing{0.80, 0.10, 0.16};

/// Writes 4800 as "4,800".
inline std::string count(std::size_t n) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
  return text;
}

}  // namespace remesh::figures
