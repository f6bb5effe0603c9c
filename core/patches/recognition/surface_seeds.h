/// First guesses of surfaces from two facets that meet in an edge.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"

namespace remesh {

/// A smooth edge between two facets, from which surfaces may grow.
struct SurfaceSeed {
  double length_squared;
  double tie;              ///< breaks ties between equally long edges: their middle's place along a fixed direction
  std::uint32_t side;      ///< the first side of the edge, see FacetGraph
  std::uint32_t end_side;  ///< the side that begins where the edge ends
  PatchId facet;
};

/// Finds the smooth edges between facets that may be curved, each once, with the longest first, because the rounding of
/// its ends matters less for a long edge.
/// Holds:  the order depends on geometry alone.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
std::vector<SurfaceSeed> find_seeds(const FacetGraph& graph, RunControl& control);

/// Guesses the surfaces of two facets.
class SeedGuesses {
 public:
  explicit SeedGuesses(const FacetGraph& graph) : graph_(graph) {}

  /// Returns the guesses, with fewer parameters first: spheres, cylinders and cones for which the edge is a ruling.
  const std::vector<AnalyticSurface>& of(const SurfaceSeed& seed);

 private:
  void guess_cylinder_along(const Vec3& a, const Vec3& b);
  void guess_cones(const Vec3& a, const Vec3& b);

  const FacetGraph& graph_;
  std::vector<Vec3> first_, second_, points_;  ///< the corners of the two facets, and all of them
  std::vector<AnalyticSurface> guesses_;
};

}  // namespace remesh
