/// Stores the boundary of a patch while the patch is refined: its segments, and the pieces into which they are cut.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/refiner/patch_to_refine.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/segments/vertex_place.h"

namespace remesh {

/// Returns the reason why triangles miss a goal beside a side with that lock.
UnrefinedReason why_locked(Lock lock);
/// Returns the reason why triangles miss a goal if a new point would violate that spacing.
UnrefinedReason why_near(MinSpacing spacing);
/// Returns the stronger of two reasons why a goal is missed. The strongest is kBoundaryLocked, because the boundary
/// must stay whatever else holds. The next is kSizeFloor, because features and rounding forbid a point even if
/// min_edge_length allows it.
UnrefinedReason stronger(UnrefinedReason a, UnrefinedReason b);

/// The pieces of a patch's boundary, and the segments that meet at its corners. A piece is a side of the patch's mesh
/// and has the side's number. The two sides of a slit have the same pieces.
class PatchBoundary {
 public:
  struct Side {
    double t0, t1;          ///< the piece [t0, t1] of the segment
    std::uint32_t next;     ///< another piece of the same chain, or kNone
    std::uint32_t chain;    ///< index of its chain
    std::uint32_t partner;  ///< the other side of a slit, or kNone
    bool is_forward;        ///< the half-edge runs from t0 to t1
  };

  /// Makes the boundary as it is in the patch's mesh. Its sides are numbered as the sides of the patch in the table;
  /// the two sides of a slit follow each other. The table must outlive this object.
  PatchBoundary(const PatchToRefine& patch, std::pmr::memory_resource* memory);

  /// Returns a number of bytes that suffices for most boundaries with that many corners and sides.
  static std::size_t usual_bytes(std::size_t corners, std::size_t sides);

  std::uint32_t side_count() const { return static_cast<std::uint32_t>(sides_.size()); }
  const Side& side(std::uint32_t s) const { return sides_[s]; }
  SegmentId segment_of(std::uint32_t s) const { return chains_[sides_[s].chain].segment; }
  /// Returns the spacing that holds on the segment of a side.
  MinSpacing spacing_of(std::uint32_t s) const { return spacing_on(segment_of(s)); }
  MinSpacing spacing_on(SegmentId s) const { return {segments_[s].floor, segments_[s].is_min_edge_user_limit}; }
  Vec3 position(SegmentId s, double t) const { return segments_.position(s, t); }
  /// Returns the number of triangles that a cut of the segment makes in all patches.
  std::uint64_t cost_of_cut(SegmentId s) const { return segments_.sides(s).size(); }
  /// Returns where a piece is cut, or nothing if it has to stay.
  std::optional<double> cut_of(std::uint32_t s) const {
    return segments_.cut(segment_of(s), sides_[s].t0, sides_[s].t1);
  }

  std::size_t chain_count() const { return chains_.size(); }
  SegmentId segment_of_chain(std::size_t chain) const { return chains_[chain].segment; }
  /// Puts the pieces of a segment of this patch into `pieces`, ascending. For a slit, these are the pieces of one side.
  void list_pieces(SegmentId segment, std::vector<std::uint32_t>& pieces) const;

  /// Divides a side at t. The side keeps the piece at the start of its half-edge. The other piece becomes a new side,
  /// which has to be entered into its chain or made the partner of another one.
  void split(std::uint32_t s, double t);
  /// Returns whether a side is in the chain of its segment. Of a slit, only the pieces of one side are in the chain.
  bool is_in_chain(std::uint32_t s) const {
    const Side& side = sides_[s];
    return side.is_forward == sides_[chains_[side.chain].first].is_forward;
  }
  /// Enters a side into its chain, at any place.
  void add_to_chain(std::uint32_t s) { sides_[s].next = std::exchange(chains_[sides_[s].chain].first, s); }
  /// Makes two pairs of the four pieces of a slit whose two sides were split. Before, `second` was the partner of
  /// `first`, and the new pieces have the last two numbers. Each side has kept the piece at its own start, so the pairs
  /// cross over.
  void pair_pieces(std::uint32_t first, std::uint32_t second);
  /// Divides a whole side at all cuts of its segment. The side keeps the first piece along the segment. The other
  /// pieces become new sides, in their order along the segment.
  /// Input:  The first side of a slit was divided just before the second one.
  /// Output: The number of the first new side. If there are no cuts, no side has this number yet.
  std::uint32_t divide(std::uint32_t s, std::span<const double> cuts);

  bool is_any_locked(std::span<const std::uint32_t> sides) const {
    return std::any_of(sides.begin(), sides.end(), [&](auto s) { return segments_[segment_of(s)].is_locked(); });
  }
  /// Returns the reason why none of these sides is cut. If none of them is locked, this is `otherwise`.
  UnrefinedReason why_uncut(std::span<const std::uint32_t> sides, UnrefinedReason otherwise) const;

  /// A vertex whose place is not free.
  struct Vertex {
    std::uint32_t number;
    VertexPlace place;
  };
  /// Returns whether two vertices lie on two segments that meet under less than 60 degrees, at the same distance from
  /// where they meet.
  /// Input: `distance` is the distance between the two vertices, in model units.
  bool is_across_input_angle(const Vertex& a, const Vertex& b, double distance) const;

 private:
  /// The pieces of one segment, in no order.
  struct Chain {
    SegmentId segment;
    std::uint32_t first;  ///< a side; the others follow by Side::next
  };
  /// A segment at a corner, with the corner at the segment's other end.
  struct CornerSegment {
    VertexId other;
    SegmentId segment;
  };

  void collect_corner_segments(const PatchToRefine& patch);
  void collect_sides(const PatchToRefine& patch);
  std::span<const CornerSegment> segments_at(std::uint32_t corner) const {
    return std::span(corner_segments_)
        .subspan(corner_begin_[corner], corner_begin_[corner + 1] - corner_begin_[corner]);
  }
  static const CornerSegment* find_other(std::span<const CornerSegment> at_corner, VertexId other);
  double distance_to_end(const VertexPlace& place, int end) const;
  bool is_across(const VertexPlace& a, const VertexPlace& b, double distance) const;
  bool is_across(const VertexPlace& cut, std::uint32_t corner, double distance) const;
  bool is_across(std::uint32_t a, std::uint32_t b, double distance) const;

  const SegmentTable& segments_;
  std::pmr::vector<Side> sides_;
  std::pmr::vector<Chain> chains_;  ///< ordered by segment
  /// Corner v has the segments [corner_begin_[v], corner_begin_[v + 1]), ordered by their other corner.
  std::pmr::vector<CornerSegment> corner_segments_;
  std::pmr::vector<std::uint32_t> corner_begin_;
};

}  // namespace remesh
