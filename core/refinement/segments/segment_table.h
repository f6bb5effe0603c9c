/// Stores the segments of the whole surface. A segment is a part of patch boundaries between two vertices that stay. It
/// is owned by the mesh and shared by patches.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/union_find.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/charts/boundary_curve.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/segments/corner_rings.h"
#include "core/refinement/segments/segment_end.h"
#include "core/refinement/segments/traced_segments.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

struct TriangulatedPatches;

/// A segment is first divided into these equal parts, if it is cut at all. The parts are then halved.
struct EvenParts {
  double count = 1;
  /// True if the ends of the parts are shifted by half a part. Then the first and the last part are halves.
  bool is_shifted = false;

  /// Returns where the piece [t0, t1] is cut. If the piece contains ends of parts, it is cut at the one nearest to its
  /// middle; otherwise in the middle.
  double cut(double t0, double t1) const;
};

/// The reason why a segment is not cut.
enum class Lock : std::uint8_t {
  kNone,  ///< it may be cut
  /// It must stay, because boundaries are not to be split or because a patch beside it stays as it was.
  kFixed,
  /// A point on the segment would be so near to a vertex or to another segment that rounding could move it there.
  kNoRoom,
  /// It could be cut, but not without edges shorter than min_edge_length.
  kAsked,
};

/// A segment joins two vertices that stay, along a BoundaryCurve. Places on it are parameters from 0 (at `from`) to 1
/// (at `to`), in proportion to the length of the way.
struct BoundarySegment {
  VertexId from, to;  ///< ordered by position, the smaller one first
  double length = 0;  ///< the length of its curve
  /// One entry per end (SegmentEnd::place). Pieces at an end are cut on the rings with the radii base * 2^k, so that
  /// segments which meet at a small angle are cut alike. The base is 0 if no other segment is near there. Otherwise it
  /// is a third of the shortest of these segments or, where sizes vary, the first distance of their CornerRings.
  std::array<double, 2> ring_base{0, 0};
  EvenParts parts;                      ///< used where there are no rings
  double floor = 0;                     ///< no piece becomes shorter than this
  bool is_min_edge_user_limit = false;  ///< the floor would be lower without the option min_edge_length
  /// The floor is higher than features and sizes require, because of min_edge_length or of rounding.
  bool is_floor_raised = false;
  Lock lock = Lock::kNone;

  bool is_locked() const { return lock != Lock::kNone; }
};

/// The side that one patch has of a segment.
struct SegmentSide {
  SegmentId segment;
  PatchId patch;
  std::uint32_t half_edge;  ///< in the patch's mesh
};

/// Returns the ends of every segment, the smaller id first. Each segment occurs once, and they are ascending.
std::vector<std::array<VertexId, 2>> segment_ends(const PatchMeshes& meshes, RunControl& control);

/// Stores the segments, the limits of their pieces, and the patches that have them. Where a piece is cut depends on
/// that piece alone. So the cuts of a segment form one binary tree, independently of the order in which patches ask for
/// them. Patches can cut on their own and still agree.
class SegmentTable {
 public:
  /// Input:  the patches are triangulated over vertices that stay. `is_frozen` has one entry per patch; the
  ///         boundary of a frozen patch stays as it is, and so do its neighbours there.
  /// Source: rules.md, Owned segments; rules.md, Corner rings; rules.md, Floors.
  SegmentTable(const Surface& surface, const TriangulatedPatches& triangulated,
               const IdVector<PatchId, std::uint8_t>& is_frozen, const SizeField& sizes, const Goals& goals,
               RunControl& control);

  /// Plans the cuts along strips and at sharp corners. It has to be called once, after the constructor. Only here, time
  /// and memory grow with the number of cuts, so a hopeless refinement can be refused before.
  /// Input: The same as for the constructor.
  void plan_cuts(const TriangulatedPatches& triangulated, const SizeField& sizes, const Goals& goals,
                 RunControl& control);

  const Surface& surface() const { return surface_; }
  std::size_t size() const { return segments_.size(); }
  const BoundarySegment& operator[](SegmentId s) const { return segments_[s]; }
  /// Returns the sides along a segment, ordered by patch and half-edge.
  std::span<const SegmentSide> sides(SegmentId s) const {
    return std::span(sides_).subspan(begin_[s.value], begin_[s.value + 1] - begin_[s.value]);
  }
  /// Returns the sides of a patch as indices into all_sides(), ordered by segment and half-edge.
  std::span<const std::uint32_t> sides_of_patch(PatchId p) const { return by_patch_[p.value]; }
  std::span<const SegmentSide> all_sides() const { return sides_; }

  /// Locks a segment because rounding left no room for cutting it.
  void lock(SegmentId s) {
    if (!segments_[s].is_locked()) segments_[s].lock = Lock::kNoRoom;
  }

  /// Returns the curve along which a segment runs.
  BoundaryCurve curve(SegmentId s) const {
    const Vec3 &from = surface_.positions[segments_[s].from], &to = surface_.positions[segments_[s].to];
    // Segments that meet at a small angle are cut at the same distances from their common end. Therefore they are
    // straight.
    const bool has_rings = segments_[s].ring_base[0] > 0 || segments_[s].ring_base[1] > 0;
    const CurveTrace* const trace = has_rings ? nullptr : traced_.of(s);
    return trace == nullptr ? BoundaryCurve::line(from, to) : BoundaryCurve::traced(from, to, *trace);
  }
  Vec3 position(SegmentId s, double t) const { return curve(s).position(t); }

  /// Returns where the piece [t0, t1] is cut. Next to an end that has rings it is on a ring; otherwise it is between
  /// two parts or in the middle. Returns nothing if the segment is locked or if one half would be shorter than the
  /// floor.
  std::optional<double> cut(SegmentId s, double t0, double t1) const;

  /// Returns the parameters, ascending, at which a segment is cut for its size before any other cut. It is divided into
  /// the min number of parts that are no longer than the size at their place; the parts are equal where the size is.
  /// The side of a strip is first cut between its parts and then by halves, until no piece is longer than the size in
  /// its middle. Beside sharp corners, a segment is cut on their rings (CornerRings). If there would be more than
  /// `max_cuts`, there are about `max_cuts`, in the same proportion. Beside sharp corners there may be some more. Sizes
  /// are read at no more than twice as many places.
  std::vector<double> size_cuts(SegmentId s, const SizeField& sizes, std::uint64_t max_cuts = Goals::kNoLimit) const;

 private:
  void cut_at_corners(SegmentId s, std::span<const double> at_from, std::span<const double> at_to,
                      const SizeField& sizes, std::uint64_t max_cuts, std::vector<double>& cuts) const;
  void cut_between_parts(SegmentId s, const SizeField& sizes, std::uint64_t max_cuts, std::vector<double>& cuts) const;
  void cut_evenly(SegmentId s, double first, double last, const SizeField& sizes, std::uint64_t max_cuts,
                  std::vector<double>& cuts) const;
  double& ring_base(SegmentEnd end) { return segments_[end.segment()].ring_base[end.place()]; }
  std::optional<double> place_cut(const BoundarySegment& s, double t0, double t1) const;

  const Surface& surface_;
  double min_edge_length_;
  std::vector<double> feature_;  ///< distance from each segment to its nearest feature; empty after `plan_cuts`
  std::vector<Corner> corners_;  ///< empty after `plan_cuts`
  UnionFind clusters_;           ///< joins the ends of segments that meet under small angles; empty after `plan_cuts`
  IdVector<SegmentId, BoundarySegment> segments_;
  std::vector<SegmentSide> sides_;
  std::vector<std::uint32_t> begin_;
  TracedSegments traced_;
  Grouping by_patch_;  ///< indices of sides
  CornerRings corner_rings_;
  std::map<SegmentId, std::vector<double>> column_cuts_;  ///< size_cuts of segments along columns of curved patches
};

}  // namespace remesh
