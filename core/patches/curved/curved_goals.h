/// The goals for curved surfaces: the options, as numbers.
#pragma once

#include <optional>

#include "core/base/options.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// How finely curved surfaces are to be divided, and how far the result may be from them.
struct CurvedGoals {
  /// The max distance between the curved parts of input and output, in model units. Empty: the distance of the input's
  /// own facets from each surface.
  std::optional<double> tolerance;
  std::optional<double> elements_per_circle;  ///< the same number for all surfaces; empty: none, or see `is_automatic`
  bool is_automatic = false;                  ///< surfaces with many facets per turn get fewer of them
  bool keeps_volume = false;                  ///< surfaces are moved outwards, so that their volume is kept
  /// Facets may stay if they are coarser than joined patches: only these goals decide the number of faces, and no
  /// volume is kept.
  bool may_coarser_facets_stay = true;
  bool is_refined = true;  ///< the patches are refined after facets were joined
  bool may_cut_boundaries = true;
  double feature_angle_deg = 30;  ///< facets that turn by more do not belong to one surface

  /// Returns whether some surface may be remeshed with a number of edges per full turn.
  bool may_have_elements() const { return elements_per_circle || is_automatic; }
  /// Returns whether any surface may be remeshed. At the resolution of its own facets, a clean cylinder needs no fewer
  /// triangles as a whole than facet by facet. So facets stay unless a tolerance or a number of elements allows coarser
  /// ones.
  bool is_any() const { return tolerance ? *tolerance > 0 : may_have_elements(); }
  /// Returns the number of edges per full turn with which a surface is remeshed, if there is one.
  std::optional<double> elements_of(const RecognisedSurface& surface) const;
};

/// Returns the goals that the options ask for.
/// Input: `diagonal` is the diagonal of the input's bounding box.
CurvedGoals curved_goals_of(const Options& options, double diagonal);

}  // namespace remesh
