/// Which coordinates a result can be proven for.
#pragma once

namespace remesh {

/// The limits that `coordinate_range` is about. Scale alone is none, short of the ends of what a double can hold: all
/// stages compute in the mesh's own units. What cannot be told apart in these units cannot be proven.
struct CoordinateRange {
  /// A vertex is nearer to the middle of the mesh than this: frames are up to twice as large, and stay numbers.
  static constexpr double kFarthest = 0x1p1022;
  /// Some vertex is at least as far from the middle of the mesh as this: below it, doubles have ever fewer digits.
  static constexpr double kSmallest = 0x1p-1022;
  /// The mesh's bounding box is at least so wide, as a part of its length, in a second direction. Coordinates that are
  /// smaller than this beside its length count as 0, so that predicates never underflow, and a mesh that is narrower is
  /// a line, whose faces lie in no plane.
  static constexpr double kNarrowest = 0x1p-100;
};

}  // namespace remesh
