/// Changes a patch that is being refined: inserts points and cuts sides.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/refiner_scratch.h"
#include "core/refinement/refiner/triangle_judge.h"
#include "core/refinement/refiner/working_patch.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {

/// The permissions of a new point: which pieces of the boundary it may encroach on, and how near it may come to other
/// points.
enum class Encroachment : std::uint8_t {
  kForbid,  ///< it must not encroach on any piece
  kAllow,   ///< it may encroach on pieces that can be cut
  /// It may encroach on any piece and be nearer to other points than its spacing. The spacing then only limits how near
  /// later points may come to it.
  kIgnore,
};

/// The result of an attempt to insert a point.
struct Attempt {
  enum class Result : std::uint8_t { kDone, kEncroached, kTooNear };

  Result result = Result::kTooNear;
  /// The sides on which the point would encroach. They are valid until the next attempt.
  std::span<const std::uint32_t> encroached;

  bool is_done() const { return result == Result::kDone; }
};

/// Makes changes after which the whole patch is consistent again: the mesh is Delaunay, every vertex has its place, and
/// new triangles are judged. A triangle that misses a goal is put into the queue, unless it has an excuse: a reason why
/// it may have a small angle (TriangleJudge::excuse).
/// Source: L. P. Chew, Guaranteed-quality mesh generation for curved surfaces, 1993 (deletion around a cut).
class PatchEditor {
 public:
  /// All three objects must outlive this one.
  PatchEditor(const PatchSizes& sizes, WorkingPatch& patch, RefinerScratch& scratch)
      : sizes_(sizes), judge_(sizes, patch), patch_(patch), scratch_(scratch) {}

  const TriangleJudge& judge() const { return judge_; }

  /// Judges all triangles. No triangle may be in the queue yet.
  void judge_all(RunControl& control);

  /// Inserts a point if it keeps the spacing, if it encroaches on no piece that it must not encroach on, and if it has
  /// room.
  Attempt insert(const PointPlace& place, MinSpacing spacing, Encroachment encroachment);
  /// The search for the point begins at a triangle.
  Attempt insert(Vec2 p, std::uint32_t triangle, MinSpacing spacing, Encroachment encroachment) {
    return insert(patch_.look_at(p, triangle), spacing, encroachment);
  }

  /// Cuts a piece at the place that the segment table gives, and lists the cut among the patch's own cuts. Returns
  /// whether the piece was cut. It may turn out that rounding leaves no room for the cut (WorkingPatch::impossible).
  bool cut_side(std::uint32_t side);
  /// Cuts the patch's sides along a segment wherever they are not cut yet.
  /// Input:  `cuts` has all cuts of that segment, ascending.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  void apply_cuts(SegmentId segment, std::span<const double> cuts, const RunControl& control);

  /// Returns the number of triangles that this object has made. It includes the triangles that its cuts make in other
  /// patches, and leaves out those that `apply_cuts` makes.
  std::uint64_t made() const { return made_; }

 private:
  void judge_triangle(std::uint32_t t);
  void judge_changed();
  void clear_circle(std::uint32_t side);
  bool cut_side_at(std::uint32_t side, double t);
  std::uint32_t cut_one(std::uint32_t side, double t, Vec2 p, std::uint32_t vertex);

  const PatchSizes& sizes_;
  const TriangleJudge judge_;
  WorkingPatch& patch_;
  RefinerScratch& scratch_;
  std::uint64_t made_ = 0;
};

}  // namespace remesh
