/// How far two triangulated surfaces are apart, both ways, as a proven bound. Nothing is known of how one surface was
/// made from the other one: noise, folds, steps, cracks, and faces without area are all right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh::verification {

/// A surface as a set of triangles. How the triangles are connected does not matter.
struct TriangleSet {
  std::span<const Vec3> positions;
  std::span<const Triangle> faces;
};

/// A face that is farther from the other surface than the tolerance, or could not be proven to be within it.
struct FarFace {
  FaceId face;
  double bound = 0;  ///< no point of the face is farther from the other surface than this
};

/// How far the points of one surface are from another one. Lengths are in model units.
struct OneWayDistance {
  double bound = 0;     ///< proven: no point of the surface is farther from the other one than this
  double distance = 0;  ///< the largest distance of a point that was measured, up to rounding
  Vec3 at;              ///< this point
  FaceId face;          ///< the face on which the point is
  FaceId other_face;    ///< the face of the other surface to which the distance was measured
  /// True if the bound on work was reached, so that `bound` may be much larger than the true distance.
  bool is_coarse = false;
  std::uint64_t pieces = 0;  ///< the number of pieces into which the faces were cut

  // These are for a question with a tolerance.
  std::uint64_t far_count = 0;     ///< the number of faces that are beyond the tolerance
  std::vector<FarFace> far_faces;  ///< the first kMaxFarFaces of them, those with the largest bounds first
};

struct TwoWayDistance {
  OneWayDistance a_to_b, b_to_a;
  double diagonal = 0;  ///< the diagonal of the box around both surfaces
};

inline constexpr std::size_t kMaxFarFaces = 100'000;

/// A bound is at most this much larger than the measured distance, as a share of it, unless it is coarse.
inline constexpr double kBoundExcess = 0x1p-8;

/// Bounds how far the points of each surface are from the other surface.
/// Input:   both surfaces have faces, and all coordinates are finite. Unused vertices do not count. With a `tolerance`,
///          in model units, the question is only whether all points are within it, which costs less: then a bound up to
///          the tolerance need not be tight.
/// Output:  both distances. Without a tolerance, a bound that is not coarse is at most (1 + kBoundExcess) times the
///          measured distance plus 2^-40 of the larger extent of both surfaces. With a tolerance, the same
///          holds for a bound above the tolerance. A direction is within the tolerance exactly if its bound is, and
///          exactly then it has no far faces.
/// Holds:   `bound` is never below the true distance, whatever the surfaces are, and however rounding falls out. The
///          results are the same for any number of workers, and scale with powers of two.
/// Errors:  kEmptyMesh - a surface has no face; kCoordinateRange - the two surfaces together are wider than 2^1022;
///          kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for surfaces whose faces are near each other, in parallel. The number of pieces is bounded by a
///          multiple of the number of all faces.
/// Source:  rules.md, Near faces.
TwoWayDistance distance_between(const TriangleSet& a, const TriangleSet& b, std::optional<double> tolerance,
                                RunControl& control);

/// Bounds how far the points of one surface are from another one. The rest is as above.
OneWayDistance distance_from(const TriangleSet& from, const TriangleSet& to, std::optional<double> tolerance,
                             RunControl& control);

}  // namespace remesh::verification
