#include "core/patches/curved/curved_goals.h"

namespace remesh {
namespace {

/// A surface with more facets per turn was divided finely in order to be near a curved surface. With fewer facets, the
/// facets may be meant as they are. The half leaves room for rounding.
constexpr double kMaxFacetsMeant = 32.5;
/// A surface with more facets is remeshed with this number of edges per turn. Their chord height is 0.86 % of the
/// radius.
constexpr double kEdgesOfFineSurfaces = 24;

}  // namespace

std::optional<double> CurvedGoals::elements_of(const RecognisedSurface& surface) const {
  if (!is_automatic) return elements_per_circle;
  return surface.facets_per_turn > kMaxFacetsMeant ? std::optional(kEdgesOfFineSurfaces) : std::nullopt;
}

CurvedGoals curved_goals_of(const Options& options, double diagonal) {
  CurvedGoals goals;
  goals.tolerance = options.surface_tolerance;
  if (options.surface_tolerance_fraction) goals.tolerance = *options.surface_tolerance_fraction * diagonal;
  goals.elements_per_circle = options.elements_per_circle;
  goals.is_automatic = are_fine_facets_coarsened(options);
  // Vertices that must stay cannot follow a surface that moves outwards.
  goals.keeps_volume =
      options.circle_fit == CircleFit::kVolume && options.split_boundaries && !options.keep_boundary_vertices;
  const bool are_sizes_given = options.max_edge_length || options.max_edge_fraction || options.max_area ||
                               is_target_given(options) || options.proximity > 0 || options.gradation;
  goals.may_coarser_facets_stay = !are_sizes_given && !goals.keeps_volume;
  goals.is_refined = options.refine;
  goals.may_cut_boundaries = options.split_boundaries;
  goals.feature_angle_deg = options.feature_angle_deg;
  return goals;
}

}  // namespace remesh
