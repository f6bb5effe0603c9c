/// Finds tiny components: parts of a surface that are as small as details and connected with nothing else.
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

/// The tiny components of a surface.
struct TinyComponents {
  std::vector<std::vector<VertexId>> vertices;  ///< the vertices of each tiny component, ascending
  /// Each face has the number of the tiny component to which it belongs, or kNone. It is empty if there are no tiny
  /// components.
  std::vector<std::uint32_t> of_face;

  std::size_t count() const { return vertices.size(); }
  bool has(FaceId f) const { return !of_face.empty() && of_face[f.value] != kNone; }
};

/// Finds the parts that may be removed as a whole: faces connected over vertices, open or closed, whose bounding box
/// has a diagonal of at most the size. At least one part must be no tiny component. A part is no tiny component if it
/// has a fixed vertex, or a label that no larger part has.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
TinyComponents find_tiny_components(const DetailRules& rules, RunControl& control);

/// A point of a triangle: the sum of the corners, each times its weight.
struct PointOfTriangle {
  std::size_t triangle;
  std::array<double, 3> weights;  ///< each is at least 0, and their sum is 1, up to rounding
};

/// For each tiny component, finds a point that is near all of the tiny component.
/// Input:  `kept` - the triangles that are left; `positions` - of the tiny components' vertices.
/// Output: for each tiny component, the point of these triangles that is nearest to the middle of the tiny component's
///         bounding box, if no point of the tiny component is farther from it than `allowed`.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) for n triangles, and O(log n) for each tiny component.
std::vector<std::optional<PointOfTriangle>> points_near_tiny_components(const TinyComponents& components,
                                                                        std::span<const Vec3> positions,
                                                                        std::span<const Corners3> kept, double allowed,
                                                                        RunControl& control);

}  // namespace remesh
