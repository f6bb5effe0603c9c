/// The surfaces that were recognised, from which the facets of a mesh were made, and which patch belongs to which
/// surface.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

struct PatchSet;

/// The reason why the facets of a free region belong to no surface.
enum class FreeReason : std::uint8_t {
  kNone,
  kNoKindFits,  ///< no kind comes within the tolerance of all vertices
  kFewFacets,   ///< a kind fits, but the facets are too few to prove it
  /// A kind fits all vertices, but the facets are cut so unevenly that they are probably meant to be flat.
  kUnevenFacets
};

/// The side of a surface on which the facets' outside is.
enum class SurfaceSide : std::uint8_t {
  kConvex,   ///< away from the axis, the centre or the middle of the tube: a shaft, a ball
  kConcave,  ///< towards it: a hole, a fillet in a corner
  kBoth      ///< some facets look to the one side and some to the other: a pin in its bore
};

/// The stable name of a side.
std::string_view side_name(SurfaceSide side);
/// The stable name of a reason.
std::string_view reason_name(FreeReason reason);

/// A surface from which some facets were made, or a free region, for which no kind of surface was found. All lengths
/// are in model units.
/// This class is larger than the bound because it has the members of the contract's `surfaces`.
struct RecognisedSurface {
  AnalyticSurface shape;
  /// Revolution: the outline that turns around the axis, as a line through (distance from the axis, height above
  /// `shape.origin` along the axis). It is empty for all other kinds.
  std::vector<Vec2> profile;
  std::uint64_t patches = 0;
  std::uint64_t faces = 0;  ///< faces of the input
  double area = 0;          ///< area of the facets
  double input_chord_height =
      0;  ///< largest distance of the input's facets from the surface; 0 for planes and free ones
  /// The part of `input_chord_height` that the turns between the facets explain: the chord height of facets that sample
  /// the surface as a tessellation does.
  double explained_height = 0;
  double input_turn_deg = 0;  ///< largest angle by which the surface turns along an edge of a facet
  /// The number of facets in a full turn of the surface, in the direction with the fewest; see measure_turns. 0 if no
  /// facet has a neighbour to which the surface turns.
  double facets_per_turn = 0;
  double sweep_deg = 0;      ///< how much of a full turn around the axis the facets cover; 360 if all of it
  double tolerance = 0;      ///< all essential vertices lie within this distance of the surface
  double deviation = 0;      ///< the largest distance of an essential vertex from the surface
  double allowed = 0;        ///< the surface tolerance in force: max distance of input and output on this surface
  bool is_remeshed = false;  ///< facets of it were joined, and are remeshed as a whole
  /// The number of edges per full turn with which it is remeshed. Empty: facets stay, or a tolerance alone decides.
  std::optional<double> elements_per_circle;
  double bound = 0;  ///< the largest proven distance between input and output of one of its patches
  /// The distance of vertices outside of the surface by which its volume is kept. Empty if vertices lie on the surface.
  std::optional<double> outside;
  SurfaceSide side = SurfaceSide::kConvex;  ///< it has no meaning for planes and free regions
  Box3 extent;                              ///< the bounding box of the facets
  /// For a band: the surface of revolution of which it is a part. It is invalid for all other surfaces.
  SurfaceId whole;
  // The following are for free regions only.
  FreeReason reason = FreeReason::kNone;
  SurfaceKind nearest_kind = SurfaceKind::kFree;  ///< the kind that fits best, or kFree if none could be fitted
  double nearest_deviation = 0;  ///< the largest distance of a vertex from the best surface of that kind
};

/// The surfaces of a mesh. They are ordered by kind, then from large to small, so that the order depends on geometry
/// alone. A surface of revolution has no formula, so the cones and cylinders that its facets lie on stand behind all
/// others, as its bands.
struct RecognisedSurfaces {
  IdVector<SurfaceId, RecognisedSurface> surfaces;
  IdVector<PatchId, SurfaceId> of_patch;  ///< every patch belongs to one; to a band rather than to its whole

  /// Returns a copy. This takes time, because a mesh may have a surface for each of its faces, and a record is large.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  RecognisedSurfaces copy(RunControl& control) const;

  /// Moves the surfaces to other patches of the same faces. Each new patch belongs to the surface of its first face.
  void follow(const PatchSet& before, const PatchSet& now);
  /// Moves the surfaces to the patches of other faces, of which each belongs to a surface.
  void follow(const IdVector<FaceId, SurfaceId>& of_face, const PatchSet& now);

  /// Removes the bands. Then their patches, tolerances and bounds belong to the surfaces of revolution.
  void join_bands();
};

}  // namespace remesh
