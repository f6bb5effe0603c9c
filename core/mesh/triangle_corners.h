/// Views triangles as a flat array of corners, the form in which polygons are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The corners of triangles, three each, without a copy.
inline std::span<const VertexId> corners_of(std::span<const Triangle> faces) {
  static_assert(sizeof(Triangle) == 3 * sizeof(VertexId));
  if (faces.empty()) return {};
  return {faces.front().data(), 3 * faces.size()};
}

/// Makes the `face_begin` of this many triangles: the index of the first corner of each.
inline std::vector<std::uint32_t> triangle_begins(std::size_t face_count, RunControl& control) {
  constexpr std::size_t kBlock = 1 << 16;
  std::vector<std::uint32_t> begins(face_count + 1);
  for_blocks(begins.size(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) begins[f] = static_cast<std::uint32_t>(3 * f);
  });
  return begins;
}

}  // namespace remesh
