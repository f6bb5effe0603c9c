/// The goals of refinement: the options, as numbers that always have a value.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/base/options.h"

namespace remesh {

/// Lengths and areas are in model units, angles in degrees. If there is no bound, an upper bound is infinity and a
/// lower one is 0.
struct Goals {
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

  double min_angle_deg = 0;        ///< lower bound for every triangle, measured in space
  double max_edge_length;          ///< infinity: none
  double max_area;                 ///< infinity: none
  std::uint64_t target_faces = 0;  ///< max_edge_length is chosen so that there are about so many faces; 0: it is not
  double target_edge_length = 0;   ///< max_edge_length is chosen so that this is about the median edge; 0: it is not
  double min_edge_length = 0;      ///< refinement makes no shorter edge
  double proximity = 0;            ///< edges are at most as long as the gap divided by this; 0: no such limit
  double min_gap = 0;              ///< gaps that are narrower than this do not count for proximity
  double feature_angle_deg = 30;   ///< patches that turn by less are on the same side of a wedge, which is no gap
  double gradation = 0;            ///< largest ratio of the lengths of neighbouring edges, > 1; 0: no limit
  std::uint64_t max_faces;         ///< limit on the faces of the whole result
  /// If there would be more faces than this, refinement looks for a value of min_edge_length with which there are no
  /// more. kNoLimit: it does not look for one.
  std::uint64_t faces_without_min_edge = kNoLimit;
  double lowest_min_edge = 0;      ///< the first value that is tried
  double min_edge_of_storage = 0;  ///< min_edge_length is at least this; points stay apart in the storage
  bool split_boundaries = true;

  /// The sizes for gaps and short edges are known at some places and interpolated between them. An edge that is longer
  /// than the size by no more than this factor meets it. A longer one is listed in the report.
  static constexpr double kSizeSlack = 1.1;
  /// Returns for how many faces sizes may be looked for. Where the faces are kept in proportion, attempts whose floor
  /// is too low ask for more than there will be.
  std::uint64_t max_faces_looked_for() const {
    constexpr std::uint64_t kTimes = 16;
    return faces_without_min_edge < kNoLimit / kTimes ? kTimes * faces_without_min_edge : max_faces;
  }
  bool has_target() const { return target_faces > 0 || target_edge_length > 0; }
  /// Returns the rate at which the size grows with the distance from the place that asks for it. Without a gradation it
  /// is 1, because a gap grows by at most the distance between two places. The max is kSteepest: with it, the size
  /// reaches its max as soon as two places differ, and sums stay finite.
  double size_slope() const { return gradation > 0 ? std::min(gradation - 1, kSteepest) : 1; }
  static constexpr double kSteepest = 0x1p40;

  /// This is the largest min_angle_deg that the contract allows.
  static constexpr double kMaxDegrees = Options::kMaxMinAngleDeg;
};

/// Returns the goals that the options ask for, with the contract's defaults (25 degrees; gradation 1.5 with proximity).
/// Without `refine` there is no goal at all.
/// Input: `diagonal` is the diagonal of the input's bounding box. It is needed for max_edge_fraction.
Goals goals_of(const Options& options, double diagonal);

/// Keeps the answer in proportion to the input, if min_edge_length is automatic and no size is given: it may have 20
/// faces for each triangle of the input, plus 1,000. With proximity it may have 40 for each, plus 5,000 if curved
/// surfaces are remeshed, too, and plus 20,000 if they are not. Where details of a given size are removed, it may have
/// a quarter of the faces for each triangle, and no edge is made shorter than a third of that size, for whatever
/// reason.
/// Input: `triangles` is the number of the input's triangles, where a polygon counts as the triangles that fill it.
void keep_in_proportion(Goals& goals, const Options& options, double diagonal, std::uint64_t triangles);

/// Makes no edge so short that its triangles become equal or flat in the numbers of the result's storage, if
/// min_edge_length is automatic.
/// Input: `step` is the distance between such numbers at the part's largest coordinate, in model units.
void keep_apart_in_storage(Goals& goals, const Options& options, double step);

/// Returns the length below which no edge is made because smaller details are removed, in model units; 0 if there is no
/// such length, or if refinement could not keep it. It is a third of defeature_size.
double min_edge_of_details(const Options& options, const Goals& goals);

/// Return the area of an equilateral triangle with this edge, and the edge of one with this area. No triangle with
/// edges up to `edge` has a larger area. Infinity gives infinity.
double equilateral_area(double edge);
double equilateral_edge(double area);

}  // namespace remesh
