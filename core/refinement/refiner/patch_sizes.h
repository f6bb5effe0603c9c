/// The max sizes of the triangles of one patch at each place.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/goals/triangle_measures.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/refiner/lattice_fill.h"
#include "core/refinement/refiner/patch_to_refine.h"
#include "core/refinement/sizes/criteria.h"
#include "core/refinement/sizes/fixed_side_sizes.h"

namespace remesh {

/// The sizes that triangles of one patch may have. All lengths and places are in the patch's plane. If sides that are
/// longer than allowed stay as they are, triangles beside them are allowed to be larger than elsewhere.
class PatchSizes {
 public:
  /// Edges may be longer than their size by this factor, because of rounding.
  static constexpr double kRoundingFactor = 1 + 1e-10;

  /// Input: `criteria` must outlive this object.
  PatchSizes(const PatchToRefine& patch, const Criteria& criteria, RunControl& control);

  const Criteria& criteria() const { return criteria_; }
  const PatchChart& chart() const { return chart_; }

  /// Returns whether the size may differ from place to place.
  bool do_vary() const { return kind_ == Kind::kVarying || kind_ == Kind::kBesideFixedSides; }
  /// Returns whether the bound on areas holds for triangles at every place.
  bool is_area_bounded() const { return fixed_ == nullptr && std::isfinite(criteria_.max_area); }
  /// Returns whether there are fixed sides: sides that stay although they are longer than allowed.
  bool has_fixed_sides() const { return fixed_ != nullptr; }
  /// Returns the strongest of the reasons why the fixed sides stay. There must be such sides.
  UnrefinedReason why_fixed() const { return why_fixed_; }

  /// Returns whether an edge of that length is short enough at every place within that radius of the place.
  bool allows(double length, Vec2 p, double radius = 0) const {
    const double scale = chart_.scale(p);
    const bool is_small = fixed_ == nullptr || length * scale <= criteria_.area_edge;
    return (is_small && criteria_.sizes.allows(length * scale, chart_.to_space(p), radius * scale)) ||
           (fixed_ != nullptr && fixed_->allow(length, p, radius));
  }
  /// Returns whether an edge is longer than allowed. It is compared with the size in its middle, as the pieces of
  /// segments are.
  bool is_too_long(Vec2 a, Vec2 b) const { return !allows(norm(b - a) / kRoundingFactor, 0.5 * (a + b)); }
  /// Returns whether a triangle is larger than the max size at any place.
  /// Input: `corner` is one of its corners.
  bool is_too_large_anywhere(Vec2 corner, const TriangleMeasures& m) const {
    if (kind_ != Kind::kUniform && kind_ != Kind::kVarying) return false;
    const double scale = chart_.scale(corner);
    if (m.twice_area / 2 * scale * scale > criteria_.max_area) return true;
    return std::sqrt(m.longest_squared) * scale > criteria_.sizes.largest() * kRoundingFactor;
  }
  /// Returns whether a triangle is larger than allowed, or has an edge that is longer.
  bool is_too_large(Vec2 a, Vec2 b, Vec2 c, const TriangleMeasures& m) const {
    if (is_too_large_anywhere(a, m)) return true;
    if (!do_vary()) return false;
    return is_too_long(a, b) || is_too_long(b, c) || is_too_long(c, a);
  }
  /// Returns whether a triangle is larger than the size that is asked for at every place, even if a fixed side is the
  /// reason.
  bool is_larger_than_asked(Vec2 corner, const TriangleMeasures& m) const;

  /// Returns the size of a new triangle that has a corner at `corner` and its new point at `place`. It is infinity if
  /// any triangle is small enough.
  double for_new_triangle(Vec2 corner, Vec2 place) const;
  /// Returns whether thinning out may leave an edge of that length at a place.
  bool allows_when_thinned(double length, Vec2 p) const;
  /// Answers `allows_when_thinned` for one place and many lengths. The answers are valid as long as this object exists.
  class LimitWhenThinned;
  LimitWhenThinned limit_when_thinned(Vec2 p) const;
  /// Returns the sizes of the lattices that fill wide areas. There must be sizes, and this object must outlive the
  /// result.
  PlaneSizes of_lattices() const;

 private:
  /// How sizes are given in this patch. The kind is decided once, in the constructor.
  enum class Kind : std::uint8_t { kNone, kUniform, kVarying, kBesideFixedSides };

  static Kind kind_of(SizeGoal goal);
  void find_fixed_sides(const PatchToRefine& patch, RunControl& control);
  double at(Vec2 p) const;

  const PatchChart chart_;
  const Criteria& criteria_;
  Kind kind_;
  UnrefinedReason why_fixed_ = UnrefinedReason::kBoundaryLocked;
  std::unique_ptr<const FixedSideSizes> fixed_;  ///< null if no side is fixed
};

class PatchSizes::LimitWhenThinned {
 public:
  LimitWhenThinned(const PatchSizes& sizes, Vec2 place);

  Vec2 place() const { return place_; }
  bool allows(double length) const {
    if (is_beside_fixed_) return sizes_.allows(length, place_);
    const double in_space = length * scale_;
    return in_space <= sizes_.criteria_.even_size && (!does_vary_ || there_.allows(in_space));
  }
  /// The lengths that are allowed within some distance of the place: all up to `everywhere`, and none longer than
  /// `nowhere`. If nothing is known, these are negative and infinity.
  struct Around {
    double everywhere, nowhere;
  };
  Around around(double distance) const;

 private:
  const PatchSizes& sizes_;
  const Vec2 place_;
  const double scale_;
  const bool is_beside_fixed_, does_vary_;
  SizeField::Limit there_{};
};

}  // namespace remesh
