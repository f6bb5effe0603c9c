/// What refinement aims at: the options, as numbers that are always there.
#pragma once

#include <cstdint>

#include "core/base/options.h"

namespace remesh {

/// Model units and degrees. No bound is infinity (upper) or 0 (lower).
struct Goals {
  double min_angle_deg = 0;    ///< of every triangle, in space
  double max_edge_length;      ///< infinity: none
  double max_area;             ///< infinity: none
  double min_edge_length = 0;  ///< refinement makes nothing shorter
  double proximity = 0;        ///< edges are at most the gap over this; 0: off
  double gradation = 0;        ///< largest growth of neighbouring edges, > 1; 0: not limited
  std::uint64_t max_faces;     ///< of the whole result
  bool split_boundaries = true;

  /// Sizes that gaps and short edges ask for are known at some places and interpolated between them. An edge that is
  /// longer by no more than this factor meets them; a longer one is listed.
  static constexpr double kSizeSlack = 1.1;
  /// How fast the size grows with the distance from the place that asks for it. Where no gradation is asked for: a gap
  /// grows by no more than the way from it.
  double size_slope() const { return gradation > 0 ? gradation - 1 : 1; }

  /// The largest min_angle_deg of the contract.
  static constexpr double kMaxDegrees = Options::kMaxMinAngleDeg;
};

/// The goals that options ask for, with the contract's defaults (25 degrees; gradation 1.5 with proximity).
/// Input:  `diagonal` of the input's bounding box, for max_edge_fraction. Without `refine` there is no goal at all.
Goals goals_of(const Options& options, double diagonal);

/// Edge and area of an equilateral triangle: of all with edges up to `edge` the largest. Infinity for infinity.
double equilateral_area(double edge);
double equilateral_edge(double area);

}  // namespace remesh
