/// Finds specks: parts of a surface that are as small as details and connected with nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/triangles/distances.h"
#include "core/mending/details/rules.h"

namespace remesh {

/// The specks of a surface.
struct Specks {
  std::vector<std::vector<VertexId>> vertices;  ///< the vertices of each speck, ascending
  /// Each face has the number of the speck to which it belongs, or kNone. It is empty if there are no specks.
  std::vector<std::uint32_t> of_face;

  std::size_t count() const { return vertices.size(); }
  bool has(FaceId f) const { return !of_face.empty() && of_face[f.value] != kNone; }
};

/// Finds the parts that may be removed as a whole: faces connected over vertices, open or closed, whose bounding box
/// has a diagonal of at most the size. At least one part must be no speck. A part is no speck if it has a fixed vertex,
/// or a label that no larger part has.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
Specks find_specks(const DetailRules& rules, RunControl& control);

/// A point of a triangle: the sum of the corners, each times its weight.
struct PointOfTriangle {
  std::size_t triangle;
  std::array<double, 3> weights;  ///< each is at least 0, and their sum is 1, up to rounding
};

/// For each speck, finds a point that is near all of the speck.
/// Input:  `kept` - the triangles that are left; `positions` - of the specks' vertices.
/// Output: for each speck, the point of these triangles that is nearest to the middle of the speck's bounding box, if
///         no point of the speck is farther from it than `allowed`.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) for n triangles, and O(log n) for each speck.
std::vector<std::optional<PointOfTriangle>> points_near_specks(const Specks& specks, std::span<const Vec3> positions,
                                                               std::span<const Corners3> kept, double allowed,
                                                               RunControl& control);

}  // namespace remesh
