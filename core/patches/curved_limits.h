/// Decides how far the result may be from each curved surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/curved_patches.h"
#include "core/patches/recognised_surfaces.h"

namespace remesh {

/// Returns the limits of all surfaces with the tolerance or the number of elements that the options ask for. The
/// tolerance is 0 for planes, for free regions, and for surfaces from which the input's own facets are farther than is
/// allowed: no coarser result could be proven to be near enough to them.
/// Input:  `diagonal` is the diagonal of the input's bounding box. The patches are the facets that were recognised.
/// Cost:   O(n).
std::vector<CurvedLimits> curved_limits(const Surface& surface, const PatchSet& facets,
                                        const RecognisedSurfaces& recognised, const Options& options,
                                        double plane_tolerance, double diagonal, RunControl& control);

/// Returns limits for the surfaces more than a tenth of whose facets have a sharp corner. In these facets, no refinement
/// can meet the bound on angles, but in the whole surface it can. The result may be as far from the surface as the
/// input's own facets are. At this distance, a surface whose facets have no sharp corners needs no fewer triangles as a
/// whole than facet by facet. For all other surfaces the tolerance is 0.
/// Input:  see find_sharp_facets for `is_sharp`.
/// Cost:   O(n).
std::vector<CurvedLimits> limits_where_facets_are_sharp(const Surface& surface, const Adjacency& adjacency,
                                                        const PatchSet& facets, const RecognisedSurfaces& recognised,
                                                        const IdVector<PatchId, std::uint8_t>& is_sharp,
                                                        double plane_tolerance, RunControl& control);

}  // namespace remesh
