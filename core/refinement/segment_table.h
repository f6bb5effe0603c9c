/// The segments of the whole surface: straight pieces of patch boundaries, owned by the mesh and shared by patches.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/union_find.h"
#include "core/geometry/patch_mesh.h"
#include "core/mesh/surface.h"
#include "core/refinement/corner_shells.h"
#include "core/refinement/goals.h"
#include "core/refinement/size_field.h"

namespace remesh {

struct SegmentTag {
  static constexpr char kPrefix = 's';
};
using SegmentId = Id<SegmentTag>;

/// The equal parts of a segment between which it is cut first, if it is cut at all; then they are halved.
struct EvenParts {
  double count = 1;
  bool is_shifted = false;  ///< by half of one: the first and the last one are halves

  /// Where the piece [t0, t1] is cut: between two parts, the nearest to its middle, or in its middle.
  double cut(double t0, double t1) const;
};

/// Why a segment stays as it is.
enum class Lock : std::uint8_t {
  kNone,    ///< it may be cut
  kKept,    ///< it must stay: boundaries are not to be split, or a patch beside it stays as it was
  kNoRoom,  ///< a point on it would be no farther than rounding from a vertex or from another segment
  kAsked,   ///< it could be cut, but not without edges shorter than min_edge_length
};

/// An edge between two vertices that stay. Places on it are parameters from 0 (`from`) to 1 (`to`).
struct BoundarySegment {
  VertexId from, to;  ///< by position, the smaller one first
  double length = 0;
  /// Around each end: the shells at base * 2^k on which pieces there are cut, so that segments that meet at a small
  /// angle are cut alike; 0 where no other segment is near. The base is a third of the shortest of these segments, or,
  /// where sizes vary, the first of their CornerShells.
  std::array<double, 2> shell_base{0, 0};
  EvenParts parts;               ///< where there are no shells
  double floor = 0;              ///< no piece becomes shorter
  bool is_floor_asked = false;   ///< it is as high for min_edge_length alone
  bool is_floor_raised = false;  ///< above what features and sizes ask for: for min_edge_length, or for rounding
  Lock lock = Lock::kNone;

  bool is_locked() const { return lock != Lock::kNone; }
};

/// One side of one patch along a segment.
struct SegmentSide {
  SegmentId segment;
  PatchId patch;
  std::uint32_t half_edge;  ///< in the patch's mesh
};

/// The ends of every segment, the smaller id first, each once; ascending.
std::vector<std::array<VertexId, 2>> segment_ends(const std::vector<PatchMesh>& meshes, RunControl& control);

/// Segments, what limits their pieces, and who has them. Where a piece is cut depends on that piece alone: the cuts of
/// a segment form one binary tree, whoever asks for them and when, so patches can cut on their own and agree later.
class SegmentTable {
 public:
  /// Input:   the patches' triangulations over vertices that stay. `is_frozen`, one per patch: its boundary stays as it
  ///          is (and with it its neighbours' there).
  /// Source:  rules.md, Owned segments; rules.md, Shells; rules.md, Floors.
  SegmentTable(const Surface& surface, const std::vector<PatchMesh>& meshes, const std::vector<std::uint8_t>& is_frozen,
               const SizeField& sizes, const Goals& goals, RunControl& control);

  /// Next, and once: where segments are cut along strips and at sharp corners. The only part that takes as long, and as
  /// much memory, as the cuts are many: what is hopeless can be refused before it.
  /// Input:   as above.
  void plan_cuts(const std::vector<PatchMesh>& meshes, const SizeField& sizes, const Goals& goals, RunControl& control);

  std::size_t size() const { return segments_.size(); }
  const BoundarySegment& operator[](SegmentId s) const { return segments_[s]; }
  /// The sides along a segment, by patch and half-edge.
  std::span<const SegmentSide> sides(SegmentId s) const {
    return std::span(sides_).subspan(begin_[s.value], begin_[s.value + 1] - begin_[s.value]);
  }
  /// The sides of a patch, by segment and half-edge, as indices of all_sides().
  std::span<const std::uint32_t> sides_of_patch(PatchId p) const { return by_patch_[p.value]; }
  std::span<const SegmentSide> all_sides() const { return sides_; }

  /// Rounding left no room for a cut of this segment: it stays as it is.
  void lock(SegmentId s) {
    if (!segments_[s].is_locked()) segments_[s].lock = Lock::kNoRoom;
  }

  Vec3 position(SegmentId s, double t) const;

  /// Where the piece [t0, t1] is cut: on a shell next to an end that has shells, else between parts or in the middle.
  /// Empty if the segment is locked or a half would be shorter than the floor.
  std::optional<double> cut(SegmentId s, double t0, double t1) const;

  /// The parameters at which a segment is cut for its size, before anything else: into the fewest parts that are no
  /// longer than the size there, equal where it is; on the side of a strip between its parts, by halves until no piece
  /// is longer than the size in its middle; beside sharp corners on their shells (CornerShells). Ascending.
  std::vector<double> size_cuts(SegmentId s, const SizeField& sizes) const;

 private:
  void cut_at_corners(SegmentId s, std::span<const double> at_from, std::span<const double> at_to,
                      const SizeField& sizes, std::vector<double>& cuts) const;
  void cut_between_parts(SegmentId s, const SizeField& sizes, std::vector<double>& cuts) const;
  void cut_evenly(SegmentId s, double first, double last, const SizeField& sizes, std::vector<double>& cuts) const;
  std::optional<double> place_cut(const BoundarySegment& s, double t0, double t1) const;

  const Surface& surface_;
  double min_edge_length_;
  std::vector<double> feature_;  ///< of each segment, the distance to the nearest; until `plan_cuts`
  std::vector<Corner> corners_;  ///< until `plan_cuts`
  UnionFind clusters_;           ///< ends that meet under small angles; until `plan_cuts`
  IdVector<SegmentId, BoundarySegment> segments_;
  std::vector<SegmentSide> sides_;
  std::vector<std::uint32_t> begin_;
  Grouping by_patch_;  ///< sides
  CornerShells corner_shells_;
};

}  // namespace remesh
