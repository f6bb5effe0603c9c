/// Estimates how short the pieces of edges become under a bound on angles, before any edge is cut.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/run_control.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/prediction/prediction.h"
#include "core/refinement/prediction/sampled_edges.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// The lengths of edges that refinement is expected to make around each sample. They are the smallest of these:
/// - the length of the edge itself;
/// - the length that fits beside a near vertex or another edge, at the bound on angles;
/// - the size that is asked for;
/// - the length at any other sample of the same triangle, plus its growth over the distance from there.
/// Edges belong to all patches that have them, so lengths spread from patch to patch as cuts do. No length is below the
/// floor of its edge, and an edge without room for a cut stays as it is. From its short side, nothing spreads into a
/// triangle with an angle of the input below the bound, because such a triangle may stay.
/// Holds:  the lengths do not depend on the number of threads. With another order of patches, they may differ by about
///         a tenth: a length that would fall by less than that stays.
/// Cost:   O(n log n) for n edges; some 100 bytes an edge and 20 a sample. Each length is changed a bounded number of
///         times.
/// Source: experiments.md, Prediction.
class EdgeSizes {
 public:
  /// Input:  goals.min_angle_deg > 0. All arguments must outlive this object.
  /// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
  EdgeSizes(const SampledEdges& edges, const TriangulatedPatches& triangulated, const Goals& goals,
            const SizeField& sizes, RunControl& control);

  const SampledEdges& edges() const { return edges_; }
  /// Returns the length at a sample, in model units.
  double at(std::uint32_t sample) const { return length_[sample]; }
  /// Returns the number of pieces into which an edge is expected to be cut. This need not be a whole number.
  double pieces(std::uint32_t edge) const { return limits_[edge].pieces; }
  /// Returns the tangent of the bound on angles.
  double tangent() const { return tangent_; }
  /// Returns the growth of lengths per distance.
  double growth() const { return growth_; }
  /// Returns the distance of the bound from bounds for which refinement does not end: 0 at such a bound, 1 without a
  /// bound.
  double slack() const { return slack_; }
  /// Returns whether a triangle may stay because its only small angle lies between two edges of the input.
  bool is_excused(std::uint32_t triangle) const { return excused_side_[triangle] != kNoSide; }
  /// Returns whether an edge stays because there is no room for a cut: its surroundings are narrower than `floor`.
  bool has_no_room(std::uint32_t edge) const { return limits_[edge].has_no_room; }
  double floor(std::uint32_t edge) const { return limits_[edge].floor; }
  /// Returns the length of edges where refined triangles have the size that is asked for at a place of a patch.
  static double asked_for(const Goals& goals, const SizeField& sizes, const PatchChart& chart, Vec2 place);

 private:
  static constexpr std::uint8_t kNoSide = 3;

  // All lengths are in model units.

  struct Limits {
    double floor = 0;  ///< no piece becomes shorter than this
    double pieces =
        1;  ///< the number of pieces; before lengths have spread, the number that the size in the middle needs
    double longest = 0;  ///< the largest of the lengths at its samples
    bool has_no_room = false;
  };
  struct Surroundings {
    double feature = std::numeric_limits<double>::infinity();  ///< the distance to the nearest feature in any patch
    double noise = 0;  ///< no cut is nearer to a vertex than this, because of rounding
  };
  class LookAround;
  class Spreading;

  void find_excused(const TriangulatedPatches& triangulated, RunControl& control);
  void find_room(RunControl& control);
  void limit_all(const TriangulatedPatches& triangulated, RunControl& control);
  void limit_by_point(EdgeSide side, Vec2 point);
  void limit_by_segment(EdgeSide side, Vec2 from, Vec2 to);
  void limit_by_goals(std::uint32_t edge, const Surroundings& near, const TriangulatedPatches& triangulated);
  void count_pieces(std::uint32_t edge);

  const SampledEdges& edges_;
  const Goals& goals_;
  const SizeField& sizes_;
  double slack_, growth_, tangent_;
  double beside_segment_;                   ///< the length beside a segment, per distance from it
  double beside_vertex_;                    ///< the length beside a vertex, per distance from it
  double asked_ = 0;                        ///< the length that is asked for, if it is the same everywhere
  std::vector<double> length_;              ///< one per sample
  std::vector<Limits> limits_;              ///< one per edge
  std::vector<std::uint8_t> excused_side_;  ///< one per triangle: its short side, or kNoSide
};

}  // namespace remesh
