/// The counts and measures of a mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace remesh {

struct Range {
  double min = 0;
  double mean = 0;
  double max = 0;
};

/// A histogram. `edges` has one entry more than `counts`. The first and the last bin also count values beyond them.
struct Histogram {
  std::vector<double> edges;
  std::vector<std::uint64_t> counts;
};

/// The quality of a set of triangles, by Verdict's definitions (Knupp et al., The Verdict Geometric Quality Library,
/// 2007).
struct Quality {
  double min_angle_deg = 0;
  double max_angle_deg = 0;
  Range radius_edge_ratio;  ///< circumradius / shortest edge; 1/sqrt(3) for the equilateral triangle
  Range aspect_ratio;       ///< longest edge * perimeter / (4 sqrt(3) area); 1 for the equilateral triangle
  Range edge_length;
  Range area;
  Histogram angle_histogram_deg;
  Histogram radius_edge_histogram;
};

/// The counts and measures of a surface. `volume` is empty if the surface is open.
struct MeshStatistics {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t components = 0;
  std::uint64_t boundary_edges = 0;
  std::uint64_t non_manifold_edges = 0;
  bool closed = false;
  std::int64_t euler = 0;
  /// The Euler number after mending. Only the statistics of the input have it.
  std::optional<std::int64_t> mended_euler;
  double area = 0;
  std::optional<double> volume;
  /// The number of pairs of faces that intersect. For the input, it is counted after mending, without the pairs inside
  /// one large patch. Empty if it was not counted.
  std::optional<std::uint64_t> intersecting_pairs;
  Box3 bounding_box;
  Quality quality;
};

}  // namespace remesh
