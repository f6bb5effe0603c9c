#include "core/refinement/refiner/triangle_judge.h"

#include <array>

namespace remesh {

/// Measures a triangle of a curved patch in space. Its lengths are converted to those in the plane.
TriangleJudge::Shape TriangleJudge::shape_in_space(std::uint32_t t) const {
  const DelaunayMesh& mesh = patch_.mesh;
  const std::uint32_t h = 3 * t;
  const Vec2 at = mesh.point(mesh.from(h));
  const Vec3 a = patch_.in_space[mesh.from(h)].position, b = patch_.in_space[mesh.from(h + 1)].position,
             c = patch_.in_space[mesh.from(h + 2)].position;
  const double inverse = 1 / sizes_.chart().scale(at);
  const Vec3 side[3] = {inverse * (b - a), inverse * (c - b), inverse * (a - c)};
  Shape shape = shape_of(h, at, {norm_squared(side[0]), norm_squared(side[1]), norm_squared(side[2])},
                         norm(cross(side[0], side[1])));
  shape.is_too_large = shape.is_too_large || is_bent(h) || is_bent(h + 1) || is_bent(h + 2) ||
                       (is_blunt_allowed() && sizes_.chart().curved()->is_deep(a, b, c));
  return shape;
}

/// Returns whether the triangle of a half-edge has a side that was not cut although the surface turns too far along it,
/// and at least as far as along the half-edge. Whatever point is inserted, the triangle at that side has such edges.
bool TriangleJudge::is_beside_bent_side(std::uint32_t h) const {
  const DelaunayMesh& mesh = patch_.mesh;
  const auto turn = [&](std::uint32_t e) {
    return norm_squared(patch_.in_space[mesh.from(e)].normal - patch_.in_space[mesh.to(e)].normal);
  };
  const std::uint32_t left = DelaunayMesh::next(h), right = DelaunayMesh::previous(h);
  return (mesh.is_constrained(left) && turn(left) >= turn(h) && is_too_bent(left)) ||
         (mesh.is_constrained(right) && turn(right) >= turn(h) && is_too_bent(right));
}

bool TriangleJudge::is_at_input_angle(std::uint32_t shortest) const {
  const DelaunayMesh& mesh = patch_.mesh;
  const std::uint32_t left = DelaunayMesh::next(shortest), right = DelaunayMesh::previous(shortest);
  if (!mesh.is_constrained(left) || !mesh.is_constrained(right)) return false;
  if (!patch_.places[mesh.apex(shortest)].is_original()) return false;
  // The two other angles must meet the bound.
  for (const std::uint32_t h : {shortest, left}) {
    const Vec2 at = mesh.point(mesh.from(h));
    const Vec2 u = mesh.point(mesh.to(h)) - at, v = mesh.point(mesh.apex(h)) - at;
    if (cross(u, v) < sizes_.criteria().tangent * dot(u, v)) return false;
  }
  return true;
}

bool TriangleJudge::is_across_input_angle(std::uint32_t a, std::uint32_t b) const {
  if (patch_.is_free(a) || patch_.is_free(b)) return false;
  const Vec2 at = patch_.mesh.point(a);
  const double distance = patch_.in_space.empty() ? norm(at - patch_.mesh.point(b)) * sizes_.chart().scale(at)
                                                  : norm(patch_.in_space[a].position - patch_.in_space[b].position);
  return patch_.boundary.is_across_input_angle({a, patch_.places[a]}, {b, patch_.places[b]}, distance);
}

std::optional<UnrefinedReason> TriangleJudge::excuse(std::uint32_t shortest) const {
  if (is_at_input_angle(shortest)) return UnrefinedReason::kInputAngle;
  if (is_across_input_angle(patch_.mesh.from(shortest), patch_.mesh.to(shortest)))
    return UnrefinedReason::kAcrossInputAngle;
  return std::nullopt;
}

std::uint32_t TriangleJudge::longest_edge(std::uint32_t t) const {
  const DelaunayMesh& mesh = patch_.mesh;
  const auto squared = [&](std::uint32_t h) {
    const Vec2 way = mesh.point(mesh.to(h)) - mesh.point(mesh.from(h));
    return dot(way, way);
  };
  std::uint32_t longest = 3 * t;
  for (const std::uint32_t h : {3 * t + 1, 3 * t + 2})
    if (squared(h) > squared(longest)) longest = h;
  return longest;
}

std::optional<UnrefinedReason> TriangleJudge::why_it_stays_large(std::uint32_t t) const {
  const DelaunayMesh& mesh = patch_.mesh;
  const std::uint32_t longest = longest_edge(t);
  if (mesh.is_constrained(longest) && (is_too_long_side(longest) || sizes_.is_area_bounded()))
    return why_side_stays(longest);
  std::optional<UnrefinedReason> why;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    if (!sizes_.is_too_long(mesh.point(mesh.from(h)), mesh.point(mesh.to(h)))) continue;
    const std::optional<UnrefinedReason> here = mesh.is_constrained(h) ? why_side_stays(h) : std::nullopt;
    if (!here) return std::nullopt;
    why = why ? stronger(*why, *here) : *here;
  }
  return why;
}

/// Returns the reason why a side cannot be cut, or nothing if it can be.
std::optional<UnrefinedReason> TriangleJudge::why_side_stays(std::uint32_t h) const {
  const std::uint32_t side = patch_.mesh.side(h);
  if (patch_.boundary.cut_of(side)) return std::nullopt;
  return patch_.boundary.why_uncut(std::array{side}, why_near(patch_.boundary.spacing_of(side)));
}

}  // namespace remesh
