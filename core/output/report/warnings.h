/// Makes diagnostics on the run as a whole.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/mesh/surface.h"
#include "core/output/report/report.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Tells how many faces refinement makes of each patch.
struct RefinedFaces {
  enum class Are : std::uint8_t { kCounted, kPredicted };
  std::function<double(PatchId)> of_patch;
  Are are = Are::kCounted;
};

/// Holds what there is to tell of free regions.
struct FreeAdvice {
  bool are_told = true;         ///< false: another diagnostic tells of them
  bool may_be_coarser = false;  ///< options that were not given make them coarser
  std::optional<double> faces;  ///< what kAdvisedElements are predicted to make of them
};
inline constexpr int kAdvisedElements = 16;

/// Tells which curved surfaces and free regions were found whose facets stay flat, how many faces these facets
/// become, and which options help. Each facet is a patch of its own, so that a bound on angles or sizes makes many
/// faces there.
/// Input:   the patches that were joined from facets are left out; `curved` is null if there are none.
/// Holds:   nothing is added if all surfaces are planes, or if there are only free regions of few facets. The
///          elements are the input's faces of curved surfaces and free regions.
void warn_of_curved_surfaces(const Surface& surface, const PatchSet& patches, const RecognisedSurfaces& recognised,
                             const RefinedFaces& refined, std::vector<Diagnostic>& diagnostics,
                             const CurvedPatches* curved = nullptr, const FreeAdvice& free = FreeAdvice());

/// Tells which surfaces elements_per_circle=auto has remeshed with fewer facets, what that has done to the volume,
/// and which options avoid it.
/// Input:   the report with its surfaces and the statistics of the input; those of the output if `are` is kCounted.
/// Output:  adds a diagnostic to the report unless no surface was remeshed so. Its elements are the input's faces
///          there.
void report_coarsened_surfaces(const Surface& surface, const PatchSet& patches, const CurvedPatches* curved,
                               RefinedFaces::Are are, Report& report);

/// Warns if most facets are patches of their own. This stands in for warn_of_curved_surfaces where each facet
/// counts as its own surface (feature_angle_deg is 0).
void warn_of_curves(const Surface& surface, const PatchSet& patches, std::vector<Diagnostic>& diagnostics);

/// Adds to the diagnostic incomplete_check that the verdict does not cover all intersections of the result.
void warn_of_many_intersections(std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
