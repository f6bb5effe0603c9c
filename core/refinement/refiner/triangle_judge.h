/// Judges the triangles of a patch that is refined.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "core/refinement/goals/triangle_measures.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/working_patch.h"

namespace remesh {

/// Finds out which goals a triangle misses, and whether it has an excuse: a reason why it may have a small angle. The
/// judge changes nothing.
/// Source: G. Miller, S. Pav, N. Walkington, When and why Ruppert's algorithm works, 2003 (the exemption at input
///         angles).
class TriangleJudge {
 public:
  struct Shape {
    std::uint32_t shortest;  ///< the half-edge of the shortest edge
    TriangleMeasures measures;
    bool is_sharp;      ///< the triangle has an angle below the bound
    bool is_too_large;  ///< the triangle exceeds the allowed size, or one of its edges does
  };

  /// Both objects must outlive this one.
  TriangleJudge(const PatchSizes& sizes, const WorkingPatch& patch) : sizes_(sizes), patch_(patch) {}

  /// Measures the triangle as it is now.
  /// Input: The triangles beside it that count as good are good.
  Shape shape_of(std::uint32_t t) const {
    const DelaunayMesh& mesh = patch_.mesh;
    if (!patch_.in_space.empty()) return shape_in_space(t);
    const std::uint32_t h = 3 * t;
    const Vec2 a = mesh.point(mesh.from(h)), b = mesh.point(mesh.from(h + 1)), c = mesh.point(mesh.from(h + 2));
    return shape_of(h, a, {dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)}, cross(b - a, c - a));
  }

  /// Returns the reason why a triangle with this shortest edge may have a small angle, if there is one.
  std::optional<UnrefinedReason> excuse(std::uint32_t shortest) const;

  /// Returns whether a half-edge is a side that is longer than allowed.
  bool is_too_long_side(std::uint32_t h) const {
    const DelaunayMesh& mesh = patch_.mesh;
    return mesh.is_constrained(h) && sizes_.is_too_long(mesh.point(mesh.from(h)), mesh.point(mesh.to(h)));
  }
  std::uint32_t longest_edge(std::uint32_t t) const;
  /// Returns the reason why a triangle stays too large whatever point is inserted, if there is one. Either its longest
  /// edge is a side that cannot be cut, or all of its edges that are too long are such sides.
  std::optional<UnrefinedReason> why_it_stays_large(std::uint32_t t) const;

 private:
  /// Judges the triangle of a half-edge at a place by the squared lengths of its sides and twice its area.
  Shape shape_of(std::uint32_t h, Vec2 at, const std::array<double, 3>& squared, double twice_area) const {
    Shape shape;
    std::uint32_t k = squared[1] < squared[0] ? 1 : 0;
    if (squared[2] < squared[k]) k = 2;
    shape.shortest = h + k;
    shape.measures = {squared[0] + squared[1] + squared[2], squared[k], std::max({squared[0], squared[1], squared[2]}),
                      twice_area};
    shape.is_sharp = sizes_.criteria().is_sharp(shape.measures);
    shape.is_too_large = sizes_.is_too_large_anywhere(at, shape.measures) ||
                         (sizes_.do_vary() && (is_too_long(h) || is_too_long(h + 1) || is_too_long(h + 2)));
    return shape;
  }
  Shape shape_in_space(std::uint32_t t) const;
  bool is_bent(std::uint32_t h) const {
    const DelaunayMesh& mesh = patch_.mesh;
    // The boundary was cut before, and an edge of a good triangle is not bent. So these edges need no test.
    if (mesh.is_constrained(h) || patch_.states[mesh.twin(h) / 3].is_good()) return false;
    return is_too_bent(h) && !is_beside_bent_side(h) && !is_beside_bent_side(mesh.twin(h));
  }
  bool is_too_bent(std::uint32_t h) const {
    return sizes_.chart().curved()->is_bent(patch_.in_space[patch_.mesh.from(h)], patch_.in_space[patch_.mesh.to(h)]);
  }
  bool is_beside_bent_side(std::uint32_t h) const;
  /// Returns whether angles have no bound. A triangle may then be much deeper in its middle than at its edges.
  bool is_blunt_allowed() const { return sizes_.criteria().min_angle_deg == 0; }
  bool is_too_long(std::uint32_t h) const {
    const DelaunayMesh& mesh = patch_.mesh;
    // An edge of a good triangle is no longer than allowed, so it need not be measured again.
    if (!mesh.is_constrained(h) && patch_.states[mesh.twin(h) / 3].is_good()) return false;
    return sizes_.is_too_long(mesh.point(mesh.from(h)), mesh.point(mesh.to(h)));
  }
  bool is_at_input_angle(std::uint32_t shortest) const;
  bool is_across_input_angle(std::uint32_t a, std::uint32_t b) const;
  std::optional<UnrefinedReason> why_side_stays(std::uint32_t h) const;

  const PatchSizes& sizes_;
  const WorkingPatch& patch_;
};

}  // namespace remesh
