/// How far a coarser surface may be from the free faces that it replaces.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/output/run/free_part.h"

namespace remesh {

/// The goals for faces of no kind.
struct FreeGoals {
  std::optional<double> tolerance;            ///< in the unit of the part; empty: see tolerance_of
  std::optional<double> elements_per_circle;  ///< how many edges an arc has per full turn; empty: any number
  double min_angle_deg = 0;  ///< no angle below this is made, except where the surface's own angles are smaller
  bool is_volume_kept = false;
  bool is_refined = true;  ///< narrow triangles will be divided until their angles are good
};

/// A distance in the unit of the part, which is proven in the end, and the share of the distance to which samples are
/// held at each face.
struct FreeTolerance {
  double largest = 0;
  std::vector<float> shares;  ///< in (0, 1]; empty if all are 1
};

/// Returns the tolerance at each free face. It is the one that was asked for, or else the distance of the faces
/// themselves from what they probably stand for: the larger one of the chord height of most edges, and twice the noise
/// of the vertices, at most a thousandth of the box's diagonal; 0 if the part has no smooth edges. With a number of
/// elements per circle, the latter gets larger by the height of such an element over its chord, by the radius at each
/// place, which is at most half of the diagonal of a free region; and a tolerance that was asked for is at most this
/// sum. No share is below a thousandth.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
/// Source: Cohen-Steiner, Morvan, Restricted Delaunay triangulations and normal cycle, 2003, for the curvature.
FreeTolerance tolerance_of(const FreePart& part, const FreeGoals& goals, RunControl& control);

/// Predicts how many triangles the free faces become for each of some numbers of elements per circle, which stand in
/// the place of that of the goals. Nothing is made.
/// Input:   `longest_edge`, in the unit of the part, is a bound on edges to which the triangles are refined afterwards.
/// Output:  one number for each of `elements`. Where edges are not bounded, it is at most the number of free faces.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::vector<double> predicted_free_faces(const FreePart& part, const FreeGoals& goals, std::span<const int> elements,
                                         double longest_edge, RunControl& control);

}  // namespace remesh
