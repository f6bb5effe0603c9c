/// Defines the floor: the smallest distance that new points keep from others.
#pragma once

#include <cmath>

namespace remesh {

/// No point is put nearer to a vertex than the vertex's floor. Every vertex has one, so it is packed into one number.
/// The number is negative if the floor is as high as it is only because of min_edge_length.
class Floor {
 public:
  explicit Floor(double packed) : packed_(packed) {}
  Floor(double length, bool is_asked) : packed_(is_asked ? -length : length) {}
  /// Returns the floor where features ask for `of_features` (model units) and nothing may be shorter than
  /// min_edge_length. A min_edge_length of 0 has no effect.
  static Floor above(double min_edge_length, double of_features) {
    return of_features > min_edge_length ? Floor(of_features, false) : Floor(min_edge_length, min_edge_length > 0);
  }

  double length() const { return std::fabs(packed_); }  ///< model units
  bool is_asked() const { return std::signbit(packed_); }
  double packed() const { return packed_; }

  friend bool operator<(Floor a, Floor b) { return a.length() < b.length(); }

 private:
  double packed_;
};

}  // namespace remesh
