/// Finds the rulings along which a patch of a cylinder or cone is divided into strips.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/patches/charts/curved_chart.h"

namespace remesh {

/// The outline of a curved patch in its plane. All spans but `sides` have one entry per vertex.
struct CurvedOutline {
  std::span<const Vec3> positions;
  std::span<const Vec2> places;                         ///< in the plane of the patch's chart
  std::span<const std::array<std::uint32_t, 2>> sides;  ///< pairs of vertices
};

/// Returns pairs of vertices that lie on one ruling of a cylinder or cone. A ruling is a straight line of the surface.
/// So triangles in strips between rulings may be several times as long as they are wide, just like the facets of a
/// prism.
/// Output: the two vertices of a pair are neighbours on their ruling. The pairs are ordered by the angle around the
///         axis and then by their place along it. They may cross sides or lie outside of the patch. On other surfaces
///         and in squeezed maps there are none.
/// Holds:   no pair makes an angle of less than 60 degrees with a side at one of its ends.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::vector<std::array<std::uint32_t, 2>> find_rulings(const CurvedChart& chart, const CurvedOutline& outline,
                                                       RunControl& control);

}  // namespace remesh
