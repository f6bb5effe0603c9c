/// Maps between space and the plane of a patch.
#pragma once

#include <span>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/planes/frame.h"

namespace remesh {

/// An edge of a patch boundary, given by the positions of its ends.
struct Edge3 {
  Vec3 from, to;
};

/// Makes a frame for points near the plane through `origin` with the given unit normal.
/// `edges` serve kDominantEdge: the longest edge gives the x axis. If several are within 1e-9 of the longest, the one
/// with the smallest end in space gives it, directed away from that end. If an axis is (nearly) parallel to the normal,
/// the next one takes its place, in the order x, y, z.
/// `grid` is 2^-40 or 2^-100, see Frame.
/// Holds:  all points are within [-1, 1] in the frame. A scaling by powers of two changes only `scale` and `origin`.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 5.1; rules.md, Patch frames.
Frame make_frame(const Vec3& normal, const Vec3& origin, std::span<const Vec3> points, std::span<const Edge3> edges,
                 ReferenceAxis axis, const Vec3& direction, double grid);

/// The plane coordinates of a point, rounded to the frame's grid.
Vec2 to_plane(const Frame& frame, const Vec3& point);

/// The point of the frame's plane with these coordinates.
Vec3 to_space(const Frame& frame, Vec2 uv);

/// Lays a closed polygon into the plane through `centre` with the given unit normal. Its longest edge gives the x axis.
/// Output: the corners' places, on the grid of 2^-100 in a unit of about the polygon's size.
std::vector<Vec2> lay_out_polygon(std::span<const Vec3> points, const Vec3& centre, const Vec3& normal,
                                  RunControl& control);

/// Newell's area vector of a closed polygon. Its direction is the polygon's normal, and its length is twice the
/// polygon's area.
Vec3 newell_normal(std::span<const Vec3> loop);

inline constexpr double kFineGrid = 0x1p-100;
inline constexpr double kPatchGrid = 0x1p-40;

}  // namespace remesh
