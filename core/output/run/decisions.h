/// All that a run decides about how its surface is remeshed. There is no geometry here.
#pragma once

#include <optional>
#include <vector>

#include "core/mending/preparation.h"
#include "core/patches/curved/curved_choices.h"
#include "core/patches/planar/face_rungs.h"
#include "core/refinement/attempts/refinement_choices.h"

namespace remesh {

/// The decisions about stages that put another surface in the place of the prepared one.
struct DetailChoices {
  /// The faces of the surface that was divided with these rungs were cut along their intersections. This comes first.
  std::optional<FaceRungs> arranged;
  bool is_arranging_done = false;  ///< faces were cut, or that was tried in vain
  /// The surface that was divided with these rungs has lost its details, and so on. All other choices are about the
  /// last surface.
  std::vector<FaceRungs> replaced;
  bool are_done = false;  ///< details were looked for in vain
  /// The surface that came of this was made coarser, since it is free as a whole.
  bool is_coarsened = false;
  bool is_coarsening_done = false;  ///< it was made coarser, or that was tried in vain
  bool operator==(const DetailChoices&) const = default;
};

/// The decisions of a run. An attempt is a function of the input, the options and the decisions. Each step reads a part
/// of the decisions, and its product is used again as long as that part is the same.
struct Decisions {
  MendingLimits mending;
  DetailChoices details;
  FaceRungs rungs;
  CurvedChoices curved;
  RefinementChoices refinement;
  bool operator==(const Decisions&) const = default;

  explicit Decisions(const MinEdgeSearch& min_edge) : refinement(min_edge) {}
};

}  // namespace remesh
