/// Removes points that a refined patch does not need.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/goals/thinning.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/refiner_scratch.h"
#include "core/refinement/refiner/working_patch.h"

namespace remesh {

/// Thins out a patch that is done. Points inside that the bounds do not need in the end are removed one by one, or one
/// point takes the place of two. It goes on around every place where it succeeds. Each step leaves fewer points, so it
/// ends.
/// Holds:  Triangles are within the bounds as before. If angles have a bound or there are sizes, no new triangle is
///         flatter than one with two angles of 28 degrees, or than the flattest one before. Triangles that miss a bound
///         stay as they are.
/// Source: H. Erten, A. Üngör, Quality triangulations with locally optimal Steiner points, 2009 (one point for two); M.
///         Badoiu, K. Clarkson, Smaller core-sets for balls, 2003 (places for these points).
class PatchThinner {
 public:
  /// All three objects must outlive this one. There must be sizes, or angles must have no bound.
  PatchThinner(const PatchSizes& sizes, WorkingPatch& patch, RefinerScratch& scratch)
      : sizes_(sizes), criteria_(sizes.criteria()), patch_(patch), mesh_(patch.mesh), scratch_(scratch) {}

  /// Tries all points inside from the vertex `first` on, and points that get other neighbours meanwhile. Points are
  /// skipped if nothing has changed around them and their neighbours since they were last tried.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  void thin_out(std::uint32_t first, Thinning thinning, RunControl& control);

 private:
  /// The measures of the triangles between a point and a ring.
  struct Fan {
    double worst_shape;  ///< minimum of TriangleMeasures::shape; negative if a triangle is turned over
    double twice_area;   ///< the sum over all of them
    bool is_any_sharp;
  };

  using Limit = PatchSizes::LimitWhenThinned;

  /// Returns whether triangles may be arbitrarily flat. Then only the depth of a curved patch requires points.
  bool are_shapes_free() const { return criteria_.min_angle_deg == 0 && !criteria_.has_sizes(); }
  bool find_ring(std::uint32_t v, std::vector<std::uint32_t>& ring) const;
  bool find_hole(std::uint32_t v, std::size_t k);
  Fan fan_of(Vec2 p, std::span<const std::uint32_t> ring) const;
  bool is_fan_good(Vec2 p, std::span<const std::uint32_t> ring, double worst_shape) const;
  void record_remade();
  void take(std::uint32_t v);
  void put_back();
  bool is_inside(std::uint32_t t, Vec2 p) const;
  bool are_remade_well(double worst_shape) const;
  bool is_good_in_space(std::uint32_t t) const;
  bool leave_out(std::uint32_t v, double worst_shape);
  std::optional<Vec2> place_within(std::span<const std::uint32_t> ring, MinSpacing spacing, double worst_shape,
                                   const Limit& limit) const;
  bool is_out_of_reach(const Limit& limit) const;
  std::uint32_t merge(std::uint32_t v, std::uint32_t w, double worst_shape, const Limit& limit);
  void list_unsettled(std::uint32_t first, std::pmr::vector<std::uint8_t>& is_waiting);
  void settle();
  std::uint32_t put_in(Vec2 p, MinSpacing spacing, double worst_shape);

  const PatchSizes& sizes_;
  const Criteria& criteria_;
  WorkingPatch& patch_;
  DelaunayMesh& mesh_;
  RefinerScratch& scratch_;
};

}  // namespace remesh
