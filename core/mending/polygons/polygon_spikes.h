/// Finds the spikes of a polygon. A spike is a part where the outline runs out and back over itself and encloses no
/// area.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// The reversals that stay. A corner whose two neighbours coincide is the tip of a reversal: the outline goes out and
/// comes back along one edge. Inside the polygon that is a slit, which a triangulation can preserve; outside it cannot
/// be preserved.
/// The two sides of a narrow slit are within the tolerance of each other.
enum class Reversals {
  kKeep,       ///< exact reversals stay
  kCut,        ///< none stay
  kKeepSlits,  ///< exact reversals stay, and narrow slits where the outline turns right at the tip
};

/// The result of cutting off spikes. If there is no spike, both lists are empty.
struct Spikes {
  std::vector<std::uint32_t>
      outline;  ///< the corners that are left, in order; fewer than 3 if the polygon is all spikes
  /// The triangles that were cut off, as (previous corner, tip, next corner). Together with the outline they have the
  /// polygon's edges, so whoever drops a triangle has to take care of the faces that share its edges.
  std::vector<std::array<std::uint32_t, 3>> needles;
};

/// Cuts off the corners at which a polygon turns back over itself, one after the other, until none is left. So a spike
/// with several vertices is cut off from its tip down, and a spike whose outline comes back only part of the way is cut
/// off by that part.
/// Input:   the corners of a polygon, and a tolerance in their units; with 0, only exact spikes are cut off. A tip
///          turns back if its neighbours are on one side of it and exactly on one line with it. It also does if the
///          nearer neighbour is within `tolerance` of the edge to the other one, and further than twice the tolerance
///          from the tip. Corners within the tolerance of each other count as one tip, or one foot. The polygon's area
///          vector defines what a right turn is.
/// Holds:   the area vector of the outline is that of the polygon minus those of the needles.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n).
Spikes cut_spikes(std::span<const Vec3> points, double tolerance, Reversals reversals, const RunControl& control);

struct PlaneSpikes {
  Spikes spikes;
  bool has_left_plane = false;  ///< a spike, whether it is a reversal or not, leaves the plane
};

/// Cuts off spikes as cut_spikes does with Reversals::kKeep, and also cuts off exact reversals that leave the polygon's
/// plane. A slit lies in its face. A reversal that sticks out of the face is a spike, even if it lies inside the
/// outline as seen from above: a triangulation through its tip would be a tent. The plane is that of the outline
/// without any reversal, through the mean of its corners. A corner is out of the plane's reach if it is further away
/// than both `plane_tolerance` and all corners of that outline. A reversal is cut off from its first corner on that is
/// out of reach.
/// Output:  the spikes. If none leaves the plane, they are those of kKeep.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n).
PlaneSpikes cut_spikes_out_of_plane(std::span<const Vec3> points, double tolerance, double plane_tolerance,
                                    const RunControl& control);

/// Returns whether the height of a triangle over its longest side is at most the tolerance.
bool is_needle(const Vec3& a, const Vec3& b, const Vec3& c, double tolerance);

}  // namespace remesh
