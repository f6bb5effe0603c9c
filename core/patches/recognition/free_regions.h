/// Regions of facets that may be curved, but belong to no claim.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// The regions, each of which is connected by smooth edges.
class FreeRegions {
 public:
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n).
  FreeRegions(const FacetGraph& graph, const ClaimTable& table, RunControl& control);

  /// Returns the area of the region of a facet. It is 0 if the facet belongs to no region, or to a region of few
  /// facets, which are planes rather than a surface of their own.
  double area_of(PatchId p) const { return region_of_[p] == kNone ? 0 : area_[region_of_[p]]; }

 private:
  IdVector<PatchId, std::uint32_t> region_of_;
  std::vector<double> area_;  ///< by region
};

}  // namespace remesh
