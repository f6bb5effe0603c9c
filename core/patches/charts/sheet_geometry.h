/// Measures sheets of curved surfaces, and decides where a sheet is divided so that its pieces have maps.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/base/vec.h"
#include "core/geometry/planes/frame.h"
#include "core/geometry/planes/plane.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// The connected facets of one surface. They are planar patches.
using PatchSheet = std::vector<PatchId>;

/// Measures sheets and pieces of sheets. All lengths are in model units. Only the last digits of sums depend on the
/// order of facets. This class is larger than the bound because every kind of surface has a rule of its own for where
/// it is divided, and all of these rules read the same angles of the same facets.
class SheetGeometry {
 public:
  /// Input: the surface and the facets outlive this object.
  SheetGeometry(const Surface& surface, const PatchSet& facets, const RunControl& control)
      : surface_(surface), facets_(facets), control_(control), check_(control) {}

  /// Returns whether a facet itself goes around the axis. A flat ring of a torus does, if no corner is where the torus
  /// is highest. Such a facet has no place in a map.
  bool goes_around(PatchId facet, const AnalyticSurface& shape);

  /// Returns whether a facet reaches the axis at which a torus ends, as at the tip of an ogive. Such a facet has no
  /// place in a map either.
  bool ends_at_axis(PatchId facet, const AnalyticSurface& shape);

  /// Returns the sector of each facet of a sheet, which is 0 everywhere if the sheet has a map as it is. Sectors begin
  /// at the angle of a corner. If corners are even, facets end where sectors do.
  std::vector<std::uint8_t> sectors(const PatchSheet& sheet, const AnalyticSurface& shape);

  /// Returns the corner at which a sheet is divided. The choice depends first on properties that do not change if the
  /// model is turned. The corner farthest from the middle of the sheet is taken. Of several such corners, one of the
  /// rarest kind is taken, where corners with facets of the same area are one kind. Remaining ties are broken by the
  /// smallest position.
  /// Output: a corner on the axis, such as the apex of a cone, is never taken.
  /// Cost:   O(n log n).
  Vec3 dividing_corner(const PatchSheet& sheet, const AnalyticSurface& shape);

  /// Returns whether a piece has a one-to-one map.
  bool has_map(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns a point in the direction of the middle of a piece, seen from the axis or the centre. With this middle, the
  /// map distorts the piece as little as possible. Its distance is of the size of the model, so that a scaling changes
  /// no direction.
  Vec3 middle_of_piece(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns 1 if all facets look away from the axis or centre, -1 if all look towards it, and otherwise 0.
  int side_of(const PatchSheet& piece, const AnalyticSurface& shape);
  /// Returns the area of a piece, in squared local units.
  double area_of(const PatchSheet& piece);
  /// Returns a plane with the mean normal through the mean of the facets' planes' origins, in local units.
  Plane mean_plane(const PatchSheet& piece);

 private:
  /// Two angles of a point: around the axis and, on a torus, around the tube.
  struct Angles {
    double around, tube;
  };
  /// Axes in which the angles of a sheet are measured.
  struct AngleFrame {
    const AnalyticSurface& shape;
    Axes axes;
    /// Returns the distance of a point from the axis.
    double radius(const Vec3& p) const;
    Angles of(const Vec3& p) const;
  };
  /// An interval of angles that a facet covers, from `begin` on, which is between 0 and a full turn.
  struct Covered {
    double begin, width;
  };
  /// The largest gap between intervals of angles.
  struct Gap {
    double width = 0;
    double middle_of_covered = 0;
  };
  struct Corner {
    Vec3 position;
    double area = 0;  ///< of the facets around it, in squared local units
  };

  template <class Take>
  void for_each_corner(PatchId p, const Take& take);
  double area_of(PatchId p);
  Vec3 middle_of(PatchId p);
  Vec3 middle_of_box(PatchId p);
  Vec3 smallest_corner(const PatchSheet& sheet);
  std::vector<Corner> corners_of(const PatchSheet& sheet);
  Vec3 middle_of_sheet(const PatchSheet& sheet);
  static Vec3 rarest(std::vector<Corner> corners);
  double reach_of(const PatchSheet& piece, const Vec3& point);
  double lowest_on_sphere(const PatchSheet& sheet, const AnalyticSurface& shape, const Vec3& pole);
  Vec3 pole_of(const PatchSheet& sheet, const AnalyticSurface& shape);
  AngleFrame frame_of(const PatchSheet& sheet, const AnalyticSurface& shape);
  Covered covered_by(PatchId p, const AngleFrame& frame, double Angles::*which);
  bool reaches_narrow_apex(const PatchSheet& sheet, const AngleFrame& frame);
  static Gap largest_gap(std::vector<Covered>& covered, const RunControl& control);
  Gap gap_of(const PatchSheet& sheet, const AngleFrame& frame, double Angles::*which);

  const Surface& surface_;
  const PatchSet& facets_;
  const RunControl& control_;
  StopCheck check_;
};

}  // namespace remesh
