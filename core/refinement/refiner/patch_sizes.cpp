#include "core/refinement/refiner/patch_sizes.h"

#include <algorithm>
#include <vector>

#include "core/refinement/refiner/patch_boundary.h"

namespace remesh {

PatchSizes::PatchSizes(const PatchToRefine& patch, const Criteria& criteria, RunControl& control)
    : chart_(patch.chart), criteria_(criteria), kind_(kind_of(criteria.size_goal)) {
  if (criteria.has_sizes()) find_fixed_sides(patch, control);
  if (fixed_ != nullptr) kind_ = Kind::kBesideFixedSides;
}

PatchSizes::Kind PatchSizes::kind_of(SizeGoal goal) {
  switch (goal) {
    case SizeGoal::kNone: break;
    case SizeGoal::kUniform: return Kind::kUniform;
    case SizeGoal::kVarying: return Kind::kVarying;
  }
  return Kind::kNone;
}

/// Finds the sides that are longer than sizes allow and that stay.
void PatchSizes::find_fixed_sides(const PatchToRefine& patch, RunControl& control) {
  std::vector<FixedSide> fixed;
  for (const std::uint32_t i : patch.segments.sides_of_patch(patch.id)) {
    const SegmentSide& side = patch.segments.all_sides()[i];
    const BoundarySegment& segment = patch.segments[side.segment];
    if (!segment.is_locked()) continue;
    const Vec2 a = patch.mesh.uv[patch.mesh.mesh.from(side.half_edge)];
    const Vec2 b = patch.mesh.uv[patch.mesh.mesh.to(side.half_edge)];
    const Vec2 middle = 0.5 * (a + b);
    const double size =
        std::min(criteria_.sizes.at(chart_.to_space(middle)), criteria_.area_edge) / chart_.scale(middle);
    if (!(norm(b - a) > size * kRoundingFactor)) continue;
    fixed.push_back({a, b, size});
    const UnrefinedReason why = why_locked(segment.lock);
    why_fixed_ = fixed.size() == 1 ? why : stronger(why_fixed_, why);
  }
  if (!fixed.empty()) fixed_ = std::make_unique<const FixedSideSizes>(fixed, criteria_.min_angle_deg, control);
}

/// Returns the longest edge that is allowed at a place. The bound on areas limits this edge only beside fixed sides.
/// Elsewhere, the areas of triangles are compared with the bound directly.
double PatchSizes::at(Vec2 p) const {
  const double size = criteria_.sizes.at(chart_.to_space(p)), scale = chart_.scale(p);
  return fixed_ != nullptr ? std::max(std::min(size, criteria_.area_edge) / scale, fixed_->at(p)) : size / scale;
}

bool PatchSizes::is_larger_than_asked(Vec2 corner, const TriangleMeasures& m) const {
  const double scale = chart_.scale(corner);
  return m.twice_area / 2 * scale * scale > criteria_.max_area ||
         std::sqrt(m.longest_squared) * scale > criteria_.sizes.largest();
}

double PatchSizes::for_new_triangle(Vec2 corner, Vec2 place) const {
  if (kind_ == Kind::kBesideFixedSides) return at(place);
  const double largest =
      std::min(criteria_.sizes.largest(), 1.5 * std::sqrt(criteria_.max_area)) / chart_.scale(corner);
  return kind_ == Kind::kVarying ? std::min(largest, at(place)) : largest;
}

bool PatchSizes::allows_when_thinned(double length, Vec2 p) const {
  if (kind_ == Kind::kBesideFixedSides) return allows(length, p);
  const double in_space = length * chart_.scale(p);
  if (!(in_space <= criteria_.even_size)) return false;
  return kind_ != Kind::kVarying || criteria_.sizes.allows(in_space, chart_.to_space(p));
}

PatchSizes::LimitWhenThinned::LimitWhenThinned(const PatchSizes& sizes, Vec2 place)
    : sizes_(sizes),
      place_(place),
      scale_(sizes.chart_.scale(place)),
      is_beside_fixed_(sizes.kind_ == Kind::kBesideFixedSides),
      does_vary_(sizes.kind_ == Kind::kVarying) {
  if (does_vary_) there_ = sizes.criteria_.sizes.limit_at(sizes.chart_.to_space(place));
}

PatchSizes::LimitWhenThinned::Around PatchSizes::LimitWhenThinned::around(double distance) const {
  // The scale of a curved patch differs from place to place.
  if (is_beside_fixed_ || sizes_.chart_.curved() != nullptr) return {-1, HUGE_VAL};
  constexpr double kRounding = 1e-9;
  const double even = sizes_.criteria_.even_size;
  if (!does_vary_) return {even / scale_ * (1 - kRounding), even / scale_ * (1 + kRounding)};
  const double here = there_.size * there_.unit, change = sizes_.criteria_.sizes.slope() * distance * scale_;
  return {(std::min(even, here) - change) / scale_ * (1 - kRounding) - change / scale_ * kRounding,
          std::min(even, here + change) / scale_ * (1 + kRounding)};
}

PatchSizes::LimitWhenThinned PatchSizes::limit_when_thinned(Vec2 p) const { return {*this, p}; }

PlaneSizes PatchSizes::of_lattices() const {
  // Lattices ignore the shortest edge that is allowed. Their edges may be half as long as the size.
  switch (kind_) {
    case Kind::kBesideFixedSides:
      return {[this](Vec2 p) { return at(p); },
              [this](double length, Vec2 p, double radius) { return allows(length, p, radius); }, false,
              SizeField::kNoise, criteria_.sizes.look_up_cost()};
    case Kind::kVarying:
      return {[this](Vec2 p) {
                return std::min(criteria_.sizes.at(chart_.to_space(p)), criteria_.even_size) / chart_.scale(p);
              },
              [this](double length, Vec2 p, double radius) {
                const double scale = chart_.scale(p);
                return length * scale <= criteria_.even_size &&
                       criteria_.sizes.allows(length * scale, chart_.to_space(p), radius * scale);
              },
              false, SizeField::kNoise, criteria_.sizes.look_up_cost()};
    case Kind::kUniform:
    case Kind::kNone: break;
  }
  const auto size = [this](Vec2 p) { return criteria_.even_size / chart_.scale(p); };
  return {size, [size](double length, Vec2 p, double) { return length <= size(p); }};
}

}  // namespace remesh
