/// A renderer that draws surfaces in space as flat pictures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "tests/figures/svg.h"

namespace remesh::figures {

/// A surface as the renderer wants it. Corners are counter-clockwise from outside.
struct Shape {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> patch;  ///< one per face; the edges between patches are drawn strongly
};

enum class Paint { kLight, kPatches, kSizes };

/// Draws the faces that look at the viewer, seen from the front right above in parallel projection, the far ones first:
/// shaded by a light from above, or coloured by patch or by size (small ones warm, large ones cold) and shaded a
/// little.
/// Input:  faces that do not pass through each other.
/// Cost:   O(n^2) box tests in the visible faces.
void draw(const Shape& shape, Paint paint, double mesh_line_width, Panel& panel);

}  // namespace remesh::figures
