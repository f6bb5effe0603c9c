/// Defines the smallest distance that new points keep from a vertex.
#pragma once

namespace remesh {

/// The floor is this share of the features at a place, if nothing else raises it. With a larger share, refinement of
/// input angles near the bound would end in `size_floor`; with a smaller one, refinement would make more faces before
/// it gives up where the bound cannot be reached.
inline constexpr double kFloorShare = 0x1p-6;

/// The smallest distance from a vertex at which a new point may be put. Every vertex has such a distance. It is called
/// the vertex's floor.
struct MinSpacing {
  double length;          ///< model units
  bool is_asked = false;  ///< the floor would be lower without the option min_edge_length

  /// Returns the floor where features ask for `of_features` (model units) and no edge may be shorter than
  /// min_edge_length. A min_edge_length of 0 has no effect.
  static MinSpacing above(double min_edge_length, double of_features) {
    if (of_features > min_edge_length) return {of_features, false};
    return {min_edge_length, min_edge_length > 0};
  }

  friend bool operator<(MinSpacing a, MinSpacing b) { return a.length < b.length; }
};

}  // namespace remesh
