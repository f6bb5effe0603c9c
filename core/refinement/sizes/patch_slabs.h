/// The normal of each patch at a place, and the two planes between which the patch lies.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/sizes/steepness.h"

namespace remesh {

/// The slabs of all patches. A planar patch is in its own slab, and its plane is the same everywhere. A curved patch
/// has another tangent plane at each place. All places are in local units.
class PatchSlabs {
 public:
  PatchSlabs() = default;
  /// Input: the triangles of patch after patch; `begin` has the index of each patch's first one, and the end. `charts`
  ///        tells which patches are curved; it may be null if none is. Surface and charts must outlive this object.
  /// Cost:  O(n).
  PatchSlabs(const Surface& surface, const PatchSet& patches, const PatchCharts* charts,
             std::span<const Triangle> triangles, std::span<const std::uint32_t> begin, RunControl& control);

  bool is_curved(PatchId p) const { return !curved_.empty() && curved_[p] != nullptr; }
  /// Returns a slab that contains the whole patch.
  const Slab& operator[](PatchId p) const { return slabs_[p]; }

  /// Returns the unit normal of a patch at a place, on the facets' outside. It is null at the apex of a cone.
  Vec3 normal(PatchId p, const Vec3& place) const {
    return is_curved(p) ? curved_normal(p, place) : slabs_[p].plane.normal;
  }
  /// Returns the slab that decides whether a way from a place is steep: that of a planar patch, or the tangent plane of
  /// a curved one.
  Slab at(PatchId p, const Vec3& place) const {
    return is_curved(p) ? Slab{{place, curved_normal(p, place)}, kRounding} : slabs_[p];
  }

  /// The data that decides whether a way from any place of some pieces of a patch may be steep.
  struct OfPieces {
    Slab slab;              ///< contains the pieces
    double steep = kSteep;  ///< a way may be steep if the square of its sine is above this
  };
  /// Holds: The answer is certain for planes, cylinders and spheres. For other surfaces it is certain up to terms of
  ///        second order in the size of the pieces.
  OfPieces around(PatchId p, std::span<const Corners3> pieces) const;

  /// This is larger than the rounding error of a distance from a plane.
  static constexpr double kRounding = 0x1p-48;

 private:
  Vec3 curved_normal(PatchId p, const Vec3& place) const;

  const Surface* surface_ = nullptr;
  IdVector<PatchId, Slab> slabs_;
  IdVector<PatchId, const CurvedChart*> curved_;  ///< null for a planar patch; empty if no patch is curved
};

}  // namespace remesh
