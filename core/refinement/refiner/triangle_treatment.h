/// Treats the triangles of a patch that miss a goal.
#pragma once

#include <cstdint>
#include <span>

#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/refiner/patch_editor.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/refiner_scratch.h"
#include "core/refinement/refiner/steiner_places.h"
#include "core/refinement/refiner/triangle_judge.h"
#include "core/refinement/refiner/working_patch.h"

namespace remesh {

/// Mends one triangle at a time by a point inside or by cuts of the boundary. If neither helps, the triangle stays and
/// gets the reason why.
/// Source: L. P. Chew, Guaranteed-quality mesh generation for curved surfaces, 1993 (lens).
class TriangleTreatment {
 public:
  /// All three objects must outlive this one.
  TriangleTreatment(const PatchSizes& sizes, WorkingPatch& patch, PatchEditor& editor)
      : sizes_(sizes), patch_(patch), editor_(editor), judge_(editor.judge()), places_(sizes, patch) {}

  /// Treats the triangle of a task. If the triangle has changed since it was put into the queue, nothing is done.
  void treat(const TriangleTask& task);

 private:
  void treat_angle(const TriangleTask& task, const TriangleJudge::Shape& shape, MinSpacing spacing);
  void treat_size(std::uint32_t t, const TriangleJudge::Shape& shape, MinSpacing spacing);
  bool insert_in_column(Vec2 p, std::uint32_t t, const TriangleJudge::Shape& shape, MinSpacing spacing);
  bool cut_any(std::span<const std::uint32_t> sides);
  bool cut_too_long_side(std::uint32_t t);
  bool split_too_large(std::uint32_t t, MinSpacing spacing);

  const PatchSizes& sizes_;
  WorkingPatch& patch_;
  PatchEditor& editor_;
  const TriangleJudge& judge_;
  SteinerPlaces places_;
};

}  // namespace remesh
