/// Groups faces that lie in one plane.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/plane.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"

namespace remesh {

struct RegionTag {
  static constexpr char kPrefix = 'r';
};
using RegionId = Id<RegionTag>;

/// Regions so far. Faces without a region are still to be grouped; so are all where nothing is said of any.
struct Regions {
  FilledIdVector<FaceId, RegionId> of_face;
  FilledIdVector<RegionId, Plane> planes;
  FilledIdVector<RegionId, double>
      deviation;               ///< largest distance of a corner from the plane, of those that were grown
  bool are_connected = false;  ///< each over edges, as those are that coplanar_regions makes
};

/// How faces are told apart; tolerances in local units.
struct CoplanarityRule {
  double plane_tolerance = 0;
  double normal_tolerance = 1e-6;
  /// Per face: only faces with equal zones may share a region (labels; and what the ladder keeps apart). Empty: all
  /// may.
  const IdVector<FaceId, std::uint32_t>* zone = nullptr;
  /// Per face: the step of the ladder, 0 to kSingleFace; it scales the tolerance, and at the last each face is alone.
  const IdVector<FaceId, std::uint8_t>* rung = nullptr;
  /// What each coordinate is printed to, where the tolerance comes from that; 0: unknown.
  Vec3 printed_steps = {};
};

/// The ladder's last step: one patch an input face.
inline constexpr std::uint8_t kSingleFace = 3;

/// The plane tolerance on a step of the ladder, in the units of `tolerance`; `floor` is kToleranceFloor in them.
double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor);

/// Gives a region to every face that has none. Faces that hang together over manifold edges and fit one plane are a
/// region; where they do not fit, regions grow from the largest face over such edges, layer by layer.
/// Holds:  every corner of every face of a region is within half the tolerance of the region's plane, and no face looks
///         the other way; a face too thin for its normal to mean anything (height under two tolerances) is held by its
///         corners alone. Triangles that bend by more than the digits they are printed with explain, and by more than
///         kUnquestionedBend, are not joined over their common edge, even if a plane is as near: of four corners more
///         is known than of many. Regions are edge-connected. No creep: all faces are held against the one final plane.
///         Neither the order of faces and vertices nor scaling by powers of two changes the regions.
/// Cost:   O(n log n); on the caller's TBB arena, by islands: faces that hang together over edges whose two faces one
///         plane may fit.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 2; rules.md, Coplanarity;
///         rules.md, Thin faces.
void coplanar_regions(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                      const CoplanarityRule& rule, Regions& regions, RunControl& control);

}  // namespace remesh
