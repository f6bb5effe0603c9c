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

/// The regions found so far. Faces without a region are still to be grouped. If `of_face` is empty, no face has a
/// region yet.
struct Regions {
  FilledIdVector<FaceId, RegionId> of_face;
  FilledIdVector<RegionId, Plane> planes;
  FilledIdVector<RegionId, double>
      deviation;  ///< largest distance from the plane of any corner of the faces in the region
  /// Each region is connected over edges, like those that coplanar_regions makes.
  bool are_connected = false;
};

/// The rule by which faces belong to one plane or not. Tolerances are in local units.
struct CoplanarityRule {
  double plane_tolerance = 0;
  double normal_tolerance = 1e-6;
  /// One zone per face. Only faces in equal zones may share a region. Zones come from labels and from what the ladder
  /// separates. Empty: all faces are in one zone.
  const IdVector<FaceId, std::uint32_t>* zone = nullptr;
  /// One rung of the ladder per face, 0 to kSingleFace. It scales the tolerance, and on the last rung each face is
  /// alone.
  const IdVector<FaceId, std::uint8_t>* rung = nullptr;
  /// The step to which each coordinate is printed, if the tolerance comes from printing; 0 if unknown.
  Vec3 printed_steps = {};
};

/// The last rung of the ladder. Each input face on it is a patch of its own.
inline constexpr std::uint8_t kSingleFace = 3;

/// The plane tolerance on a rung of the ladder, in the units of `tolerance`. `floor` is kToleranceFloor in these units.
double tolerance_at_rung(double tolerance, std::uint8_t rung, double floor);

/// Gives a region to every face that has none. Faces that are connected over manifold edges are one region if they fit
/// one plane. If they do not, regions grow from the largest face over such edges, layer by layer.
/// Holds:  every corner of every face of a region is within half the tolerance of the region's plane, and no face has
///         the opposite orientation. If a face is too thin for its normal to be meaningful (height under two
///         tolerances), only its corners are tested. Two triangles are not joined over their common edge if they bend
///         there by more than the digits they are printed with explain, and by more than kUnquestionedBend, even if a
///         plane is near enough: for four corners the bend can be tested exactly, for many it cannot. Regions are
///         edge-connected. They do not creep along a curved surface, because all faces are tested against the one final
///         plane. Neither the order of faces and vertices nor scaling by powers of two changes the regions.
/// Cost:   O(n log n); on the caller's TBB arena. The parallel parts are islands, which are faces connected over edges
///         whose two faces may fit one plane.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 2; rules.md, Coplanarity;
///         rules.md, Thin faces.
void coplanar_regions(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                      const CoplanarityRule& rule, Regions& regions, RunControl& control);

}  // namespace remesh
