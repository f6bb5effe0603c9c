/// How near points may come to each other.
#pragma once

#include <cmath>

namespace remesh {

/// No point is put nearer to a vertex than its floor. There is one for each vertex, so it is one number: negative where
/// it is as high for min_edge_length alone.
class Floor {
 public:
  explicit Floor(double packed) : packed_(packed) {}
  Floor(double length, bool is_asked) : packed_(is_asked ? -length : length) {}
  /// That of features, model units, where nothing is to be shorter than min_edge_length (0: no matter).
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
