/// The bounds on edges that differ from place to place, as the checker finds them by itself.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/box_tree.h"
#include "core/verify/boundary_graph.h"
#include "core/verify/facing_facets.h"
#include "core/verify/model.h"
#include "core/verify/straight_lines.h"
#include "core/verify/verify.h"

namespace remesh::verification {

/// Tests output faces against goals.proximity or, without it, goals.gradation.
///
/// With proximity a place of a patch asks for the size (gap + tolerance) / proximity; the places that are looked at are
/// each face's centroid and the middles of its edges, and an edge may be as long as the size at a place and the slope
/// times the way from there to its own middle. With gradation alone each straight line of the input's boundaries asks
/// for its own length, and an edge may be as long as that and the slope times the way from the line to its middle.
/// Either with Goals::kSizeSlack. The floor that sizes have is no part of the bound: what it keeps from being met has
/// to be listed.
///
/// What a face misses is told by two measures, since two that compute a bound differ near it: one counts only what is
/// clear, and allows kClearly more; the other counts all that may be, and allows as much less.
class VaryingSizes {
 public:
  /// Input:  goals with proximity or gradation; the edges that bound the input's patches, and those that bound the
  ///         output's. All of these outlive this.
  VaryingSizes(const Claim& claim, const Model& model, const BoundaryGraph& input_seams,
               const BoundaryGraph& output_seams, RunControl& control);

  bool is_missed_clearly(std::uint32_t output_face) const;
  bool may_be_missed(std::uint32_t output_face) const;

  static constexpr double kClearly = 1.02;

 private:
  struct Length {
    double value = HUGE_VAL;
    void join(Length other) { value = std::min(value, other.value); }
  };
  struct Segment {
    Vec3 a, b;
  };
  /// Straight pieces, each of which asks for its own length.
  class Graded {
   public:
    Graded() = default;
    Graded(std::vector<Segment> segments, const Model& model, double slope, RunControl& control);
    /// In the model's scale. Is there a piece near which an edge with that middle may not be so long?
    bool is_too_long(double length, const Vec3& middle) const;

   private:
    Vec3 centre_;
    double slope_ = 0;
    std::vector<Segment> segments_;
    BoxTree<Length> tree_;
  };

  bool is_missed(std::uint32_t output_face, FacingFacets::Doubt doubt) const;

  const Model& model_;
  const double proximity_, slope_;
  std::optional<FacingFacets> facets_;  ///< with proximity
  Graded lines_, pieces_;               ///< without: as long as may be, and as short as may be
};

}  // namespace remesh::verification
