#include "core/patches/planar/coplanarity.h"

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// The largest error of a coordinate that was printed in decimal, in units of its last digit: half a unit, and a little
/// more for the rounding of earlier computations.
constexpr double kPrinted = 0.51;

}  // namespace

double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor) {
  if (rung == 0) return tolerance;
  const double tighter = kLadderFactor * tolerance;
  return rung == 1 ? tighter : std::min(kLadderFactor * tighter, floor);
}

Coplanarity::Coplanarity(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                         const CoplanarityRule& rule, RunControl& control)
    : surface_(surface), adjacency_(adjacency), geometry_(geometry), rule_(rule) {
  // Corners lie within [-1, 1]. The floor is relative to the diagonal.
  const auto box_of = [&](std::size_t begin, std::size_t end) {
    Box3 box;
    for (std::size_t v = begin; v < end; ++v) box.add(surface.local[VertexId(v)]);
    return box;
  };
  Box3 box;
  for (const Box3& part : map_blocks<Box3>(surface.vertex_count(), kItemsPerBlock, control, box_of)) box.add(part);
  const double floor = kToleranceFloor * box.diagonal();
  for (std::size_t rung = 0; rung < tolerance_at_.size(); ++rung)
    tolerance_at_[rung] = tolerance_at_rung(rule.plane_tolerance, static_cast<std::uint8_t>(rung), floor);
}

bool Coplanarity::is_bend(std::uint32_t h) const {
  if (rule_.printed_steps == Vec3{}) return false;
  const FaceId f = adjacency_.face_of(h), g = adjacency_.face_of(adjacency_.twin(h));
  if (surface_.face(f).size() != 3 || surface_.face(g).size() != 3 || is_thin(f) || is_thin(g)) return false;
  if (is_unquestioned(dot(geometry_[f].normal, geometry_[g].normal))) return false;
  const VertexId from = adjacency_.from(h), to = adjacency_.to(h);
  const Vec3 a = surface_.local[from];
  const auto apex = [&](FaceId face) {
    const auto corners = surface_.face(face);
    const auto other = std::find_if(corners.begin(), corners.end(), [&](VertexId v) { return v != from && v != to; });
    return surface_.local[*other] - a;
  };
  const Vec3 b = surface_.local[to] - a, c = apex(f), d = apex(g);
  const Vec3& step = rule_.printed_steps;
  double explained = 0;
  for (const Vec3& n : {cross(b, c), cross(b, d), cross(c, d), cross(c - b, d - b)})
    explained += step.x * std::fabs(n.x) + step.y * std::fabs(n.y) + step.z * std::fabs(n.z);
  return std::fabs(dot(cross(b, c), d)) > kPrinted * explained;
}

bool Coplanarity::are_apart(FaceId f, FaceId g) const {
  const double cosine = dot(geometry_[f].normal, geometry_[g].normal);
  if (cosine > kNearlyFlat || is_thin(f) || is_thin(g)) return false;
  const double a = squared_sine(f, tolerance(f)), b = squared_sine(g, tolerance(g));
  // The right side is the cosine of the sum of the two angles. The small constant covers rounding.
  return a < 1 && b < 1 && cosine + 1e-12 < std::sqrt((1 - a) * (1 - b)) - std::sqrt(a * b);
}

}  // namespace remesh
