/// Spikes of a polygon: pieces where its outline runs out and back over itself, which enclose no area.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A corner whose two neighbours coincide is the tip of a reversal: the outline goes out and comes back along one edge.
/// Inside the polygon that is a slit, which a triangulation can keep; outside it cannot be kept.
/// The sides of a narrow slit are within the tolerance of each other. Which of them stay:
enum class Reversals {
  kKeep,       ///< exact ones
  kCut,        ///< none
  kKeepSlits,  ///< exact ones, and narrow ones where the outline turns right at the tip
};

/// Without a spike both lists are empty.
struct Spikes {
  std::vector<std::uint32_t>
      outline;  ///< the corners that are left, in order; fewer than 3 if the polygon is all spikes
  /// The triangles that were cut off, as (previous corner, tip, next corner). Together with the outline they have the
  /// polygon's edges: whoever drops a triangle has to see to those who share its edges.
  std::vector<std::array<std::uint32_t, 3>> needles;
};

/// Cuts off the corners at which a polygon turns back over itself, one after the other, until none is left. So a spike
/// of several vertices goes from its tip down, and one that comes back only a part of the way is cut to that part.
/// Input:   the corners of a polygon. A tip turns back if its neighbours are on one side of it and exactly on one line
///          with it, or if the nearer one is within `tolerance` of the edge to the other one and further than twice
///          that from the tip. Corners within the tolerance of each other are one tip, or one foot. The tolerance is in
///          the points' units; 0: only what is exact. The area vector of the polygon says what a right turn is.
/// Holds:   the area vector of the outline is the polygon's, less those of the needles.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n).
Spikes cut_spikes(std::span<const Vec3> points, double tolerance, Reversals reversals, const RunControl& control);

struct PlaneSpikes {
  Spikes spikes;
  bool has_left_plane = false;  ///< a spike leaves the plane, be it a reversal or not
};

/// Does the same as cut_spikes with Reversals::kKeep, but cuts off also those exact reversals that leave the polygon's
/// plane. A slit lies in its face. What sticks out of the face is a spike, even if it lies inside the outline as seen
/// from above: a triangulation through its tip would be a tent. The plane is that of the outline without any reversal,
/// through the mean of its corners. The plane's reach is `plane_tolerance` or, if that outline is bent further, the
/// largest distance of the outline's own corners. A reversal goes from its first corner on that is out of reach.
/// Output:  the spikes. If none leaves the plane, they are those of kKeep.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n).
PlaneSpikes cut_spikes_out_of_plane(std::span<const Vec3> points, double tolerance, double plane_tolerance,
                                    const RunControl& control);

/// Whether a triangle is no higher than the tolerance over its longest side.
bool is_needle(const Vec3& a, const Vec3& b, const Vec3& c, double tolerance);

}  // namespace remesh
