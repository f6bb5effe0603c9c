/// Places the vertices of curved surfaces outside of these, so that the result keeps the volume of what the surfaces
/// bound (circle_fit=volume).
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/curved_choices.h"
#include "core/patches/curved/offset_moves.h"
#include "core/patches/planar/boundary_loops.h"

namespace remesh {

/// The volume or area that the triangles of one surface have to enclose.
struct OffsetGoal {
  bool is_wanted = false;
  /// The surface has an open border, so that it bounds no solid. Then its area counts.
  bool is_area = false;
  /// The volume between `centre`, the true surface, and the flat fans between the true boundary curves and the chords
  /// of their new pieces; or the area of the true surface. It is in local units.
  double target = 0;
  Vec3 centre;
};

/// Patches whose boundaries have been cut anew.
struct CutPatches {
  const Surface& surface;  ///< without the vertices of the cuts
  const Adjacency& adjacency;
  const PatchSet& patches;
  const BoundaryLoops& loops;
  const CurveCuts& cuts;
  const IdVector<VertexId, std::uint8_t>& forced;  ///< vertices that must stay
};

/// Knows by how much each curved surface is moved outwards. The offsets are estimates, unless results have shown better
/// ones (refinement/adjustment/volume_fit.h).
class VolumeOffsets {
 public:
  /// Moves the curved surfaces, and the vertices on their boundaries, as was chosen. All later steps work on the moved
  /// surfaces.
  /// Input:   `with_cuts` is the surface with the vertices of the cuts behind its own.
  /// Output:  the positions of essential vertices and cuts on the boundaries of curved patches, and the maps and limits
  ///          of these patches. Returns whether any surface is moved.
  /// Holds:   see add_offset_moves for the places of vertices. Forced vertices stay.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:    O(n log n).
  bool move_outside(const CutPatches& cut, const OffsetChoices& choices, CurvedPatches& curved, Surface& with_cuts,
                    RunControl& control);

  /// Returns the goal of each surface: the volume to enclose, or the area. The result is empty if no surface is moved.
  const IdVector<SurfaceId, OffsetGoal>& goals() const { return goals_; }
  const IdVector<SurfaceId, double>& offsets() const { return offsets_; }
  /// Returns the moves of all vertices on boundaries of curved patches, from their places on the true surfaces.
  const OffsetMoves& moves() const { return moves_; }

  /// Returns the offsets of regular polygons that turn as far as edges may: a scale for each surface.
  const IdVector<SurfaceId, double>& scales() const { return scales_; }
  /// Tells whether some vertices on the boundary of a surface cannot follow it, as where a plane touches it. If such a
  /// surface were moved before it is refined, the triangles at its boundary would be steep, and smaller triangles would
  /// be steeper. So its offset is 0 at first.
  bool is_anchored(SurfaceId surface) const { return is_anchored_[surface] != 0; }

  /// Returns a surface if it is moved; otherwise those that are moved and share vertices with it.
  /// Cost: O(vertices on boundaries).
  std::vector<SurfaceId> moved_at(SurfaceId surface) const;

 private:
  void set_goals(const CutPatches& cut, const OffsetChoices& choices, const CurvedPatches& curved, RunControl& control);
  void set_scales(const CurvedPatches& curved);
  void find_anchored(const CutPatches& cut, const CurvedPatches& curved, RunControl& control);

  IdVector<SurfaceId, OffsetGoal> goals_;
  IdVector<SurfaceId, double> offsets_;
  IdVector<SurfaceId, double> scales_;
  OffsetMoves moves_;
  IdVector<SurfaceId, std::uint8_t> is_anchored_;
};

}  // namespace remesh
