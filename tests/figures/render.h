/// A renderer that draws surfaces in space as flat pictures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/output/result/result.h"
#include "tests/figures/svg.h"

namespace remesh::figures {

/// A surface as the renderer takes it. The corners of a face are counter-clockwise, seen from outside.
struct Shape {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> patch;  ///< one per face; the edges between patches are drawn strongly
  // The following are for Paint::kSurfaces only.
  std::vector<std::uint32_t> surface;  ///< one per patch
  std::vector<Colour> colour;          ///< one per surface
};

/// Returns the faces and patches of a result.
Shape shape_of(const Result& result);

enum class Paint { kLight, kPatches, kSizes, kSurfaces };

/// Returns where a point is in a picture.
Vec2 in_picture(const Vec3& p);
/// Returns whether a face with this unit normal looks at the viewer.
bool looks_at_viewer(const Vec3& normal);

/// Draws the faces that look at the viewer in parallel projection, seen from the front right above. Far faces are drawn
/// first. They are shaded by a light from above, or they are coloured by patch, by size (small ones warm, large ones
/// cold) or by surface, and shaded a little. Coloured by surface, the edges between surfaces are drawn strongly, those
/// between patches weakly, and those inside patches not at all.
/// Input:  The faces do not pass through each other.
/// Cost:   O(n^2) box tests in the visible faces.
void draw(const Shape& shape, Paint paint, double mesh_line_width, Panel& panel);

}  // namespace remesh::figures
