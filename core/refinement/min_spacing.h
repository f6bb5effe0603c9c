/// Defines the smallest distance that new points keep from a vertex.
#pragma once

namespace remesh {

/// No point is put nearer to a vertex than this. Every vertex has one, which is its floor.
struct MinSpacing {
  double length;          ///< model units
  bool is_asked = false;  ///< the floor is as high as it is only because of min_edge_length

  /// Returns the floor where features ask for `of_features` (model units) and nothing may be shorter than
  /// min_edge_length. A min_edge_length of 0 has no effect.
  static MinSpacing above(double min_edge_length, double of_features) {
    if (of_features > min_edge_length) return {of_features, false};
    return {min_edge_length, min_edge_length > 0};
  }

  friend bool operator<(MinSpacing a, MinSpacing b) { return a.length < b.length; }
};

}  // namespace remesh
