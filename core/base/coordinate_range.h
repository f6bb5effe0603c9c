/// The coordinates for which a result can be proven.
#pragma once

namespace remesh {

/// The limits behind the error `coordinate_range`. All stages compute in the mesh's own units, so scale alone is no
/// limit, except at the ends of the range of doubles. Nothing can be proven of points whose coordinates become equal in
/// these units.
struct CoordinateRange {
  /// Every vertex must be nearer to the middle of the mesh than this. Coordinates in the frame of a patch may be
  /// twice as large, and must not overflow either.
  static constexpr double kFarthest = 0x1p1022;
  /// Some vertex must be at least this far from the middle of the mesh. Smaller doubles are subnormal and have fewer
  /// digits.
  static constexpr double kSmallest = 0x1p-1022;
  /// The mesh's bounding box must be at least this wide in a second direction, relative to its length. Coordinates that
  /// are smaller than this, relative to the length, count as 0, so that predicates never underflow. A narrower mesh is
  /// a line, and its faces lie in no plane.
  static constexpr double kNarrowest = 0x1p-100;
};

}  // namespace remesh
