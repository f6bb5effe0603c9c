/// Marks of input faces, which outlast all surfaces that are made of the input.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/stoppable.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Has one entry per input face, or is empty as long as no face is marked.
using FaceMarks = std::vector<std::uint8_t>;

/// Marks input faces.
/// Input: `count` is the number of all input faces.
inline void mark(FaceMarks& marks, std::span<const FaceId> faces, std::size_t count) {
  if (faces.empty()) return;
  marks.resize(count, 0);
  for (const FaceId f : faces) marks[f.value] = 1;
}

/// Returns whether all input faces that a face of a surface covers are marked.
inline bool are_marked(const FaceMarks& marks, std::span<const FaceId> covered) {
  return !marks.empty() && std::all_of(covered.begin(), covered.end(), [&](FaceId f) { return marks[f.value] != 0; });
}

/// Returns the input faces that faces of a surface cover, ascending and each of them once.
inline std::vector<FaceId> covered_by(const Surface& surface, std::span<const FaceId> faces) {
  std::vector<FaceId> found;
  for (const FaceId f : faces) {
    const std::span<const FaceId> covered = surface.covered(f);
    found.insert(found.end(), covered.begin(), covered.end());
  }
  sort_unique(found);
  return found;
}

}  // namespace remesh
