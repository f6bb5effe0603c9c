/// The checker's own computation of the bounds on edge lengths that vary from place to place.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/trees/box_tree.h"
#include "core/verify/claim/claim.h"
#include "core/verify/goals/gap_check.h"
#include "core/verify/goals/straight_lines.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Tests output faces against goals.proximity or, without it, against goals.gradation.
///
/// With proximity, a place of a patch requires the size (gap + tolerance) / proximity. The places that are tested are
/// each face's centroid and the midpoints of its edges. An edge may be as long as the size at a place plus the slope
/// times the distance from that place to the edge's own midpoint.
///
/// With gradation alone, each straight line of the input's boundaries requires its own length. An edge may be as long
/// as that length plus the slope times the distance from the line to the edge's midpoint. Each piece of a curve that
/// was cut anew also requires its own length, but that is not certain.
///
/// Both bounds are multiplied by Goals::kSizeSlack. The smallest size that refinement permits is not part of the
/// bound: faces that cannot meet the bound because of it must be listed.
///
/// Two measures decide whether a face misses its bound, because two programs that compute a bound differ near it. One
/// counts only certain gaps and permits kClearly more. The other counts all possible gaps and permits kClearly less.
class VaryingSizes {
 public:
  /// Input:  `claim` - its goals have proximity or gradation; `input_seams` - the edges that bound the input's
  ///         patches; `output_seams` - those that bound the output's. All of these must outlive this object.
  VaryingSizes(const Claim& claim, const NumberedClaim& numbered, const BoundaryGraph& input_seams,
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
    double size;  ///< the size that the place requires
  };
  /// Straight segments, each of which requires a size.
  class Graded {
   public:
    Graded() = default;
    Graded(std::vector<Segment> segments, const NumberedClaim& numbered, double slope, RunControl& control);
    /// True if an edge of that length with that midpoint would be too long beside some segment.
    /// Input: in the numbered claim's scale.
    bool is_too_long(double length, const Vec3& middle) const;

   private:
    Vec3 centre_;
    double slope_ = 0;
    std::vector<Segment> segments_;
    BoxTree<Length> tree_;
  };

  bool is_missed(std::uint32_t output_face, GapCheck::Doubt doubt) const;

  const NumberedClaim& numbered_;
  const double proximity_, slope_;
  std::optional<GapCheck> facets_;  ///< set with proximity
  /// They are set without proximity. `lines_` requires the largest possible lengths, `pieces_` the smallest.
  Graded lines_, pieces_;
};

}  // namespace remesh::verification
