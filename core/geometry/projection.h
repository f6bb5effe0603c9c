/// From space to the plane of a patch and back.
#pragma once

#include <span>
#include <vector>

#include "core/base/options.h"
#include "core/base/vec.h"
#include "core/geometry/frame.h"

namespace remesh {

/// An edge of a patch boundary, by position.
struct Edge3 {
  Vec3 from, to;
};

/// A frame for points near the plane through `origin` with that unit normal.
/// `edges` serve kDominantEdge: the longest one gives the x axis; among those within 1e-9 of the longest it is the one
/// with the smallest end in space, directed away from it. An axis that is (nearly) parallel to the normal gives way to
/// the next: x, y, z.
/// `grid` is 2^-40 or 2^-100, see Frame.
/// Holds:  all points are within [-1, 1] in the frame; scaling by powers of two changes only `scale` and `origin`.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 5.1; rules.md, Patch frames.
Frame make_frame(const Vec3& normal, const Vec3& origin, std::span<const Vec3> points, std::span<const Edge3> edges,
                 ReferenceAxis axis, const Vec3& direction, double grid);

/// Plane coordinates of a point, rounded to the frame's grid.
Vec2 to_plane(const Frame& frame, const Vec3& point);

/// The point of the frame's plane with these coordinates.
Vec3 to_space(const Frame& frame, Vec2 uv);

/// Newell's area vector of a closed polygon: its direction is the normal, its length twice the area.
Vec3 newell_normal(std::span<const Vec3> loop);

inline constexpr double kFineGrid = 0x1p-100;
inline constexpr double kPatchGrid = 0x1p-40;

}  // namespace remesh
