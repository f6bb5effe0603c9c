/// The checker's own measure of gaps. It decides whether a facet that is not a neighbour is within some distance of a
/// place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/trees/box_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/verify/claim/claim.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Stores the input's facets as triangles, and where the input's patches are joined.
///
/// Seen from a place of a patch, another patch is across a gap if its nearest point is. A point is across a gap if
/// all of these are true:
///  - The way to it leaves the patch's plane steeply: the square of its sine is above kSteep (51 degrees). At a curved
///   patch, the normal of its surface is taken. Because facets turn away from that normal, a way is clearly steep only
///   above kSteepAtCurved (65 degrees), and any way may be steep.
///  - The way is longer than the tolerance. At a smaller distance the two patches touch.
///  - Of all points that are across a gap on this side of the patch, the nearest one is at least Goals::min_gap high
///   over the patch's plane. Narrower gaps do not count, and neither do patches beyond them.
///  - The patches do not cross or touch each other anywhere in the input.
/// - The surface does not hide the point. If both patches bound one closed, consistently oriented body, a way that
///   leaves the body through one of them must not enter it through the other from the inside.
///  - The way is shorter than a third of each way over the surface through a vertex or an edge that the two patches
///    share, which is straight on both sides of it.
/// - The way does not lead across a wedge: from one side of an edge at which patches meet at less than 60 degrees to
///   the other. All patches that are connected over edges that turn by less than Goals::feature_angle_deg are one side.
///   The way over the edge must be longer than 2 / sin(angle / 2) times the straight one to count. This class is larger
///   than the bound because all conditions for a gap read the same tables.
/// Holds:   it shares no code with the search that determines sizes, and takes no data from it. The common tools are
///          the tree of boxes, the nearest point on a triangle, and the triangles of polygons.
class GapCheck {
 public:
  /// The certainty that an answer needs.
  enum class Doubt {
    /// A patch counts only if it is across a gap by a clear margin. Parts that were not searched do not count.
    kIsNone,
    /// A triangle within the distance counts as soon as some way to its height would be steep. There is no test which
    /// of its points are visible and what is between. Parts that were not searched count.
    kCounts,
  };

  /// Input:  `seams` - the edges that bound the input's patches. Claim, model and seams must outlive this object.
  /// Errors: kCancelled, kTimeout - stopped through `control`.
  /// Cost:   O(n log n) in the input's corners.
  GapCheck(const Claim& claim, const NumberedClaim& numbered, const BoundaryGraph& seams, RunControl& control);

  /// True if a facet is across a gap from that place of the patch, less than `distance` away. Place and distance are
  /// in the numbered claim's scale.
  /// Cost:   bounded (kMaxLooks); O(log n) if few of the facets nearby do not count.
  bool is_any_within(const Vec3& place, PatchId patch, double distance, Doubt doubt) const;

  /// The max number of boxes, triangles and parts of borders that are tested for one place. If there are more, as at
  /// the tip of a cone of thousands of needles, the answer is in doubt.
  static constexpr std::size_t kMaxLooks = 8192;

  static constexpr double kSteep = 0.604;
  static constexpr double kSteepAtCurved = 0.82;
  static constexpr double kDetour = 3;

 private:
  struct OfPatch {
    PatchId patch;
    void join(const OfPatch& other) {
      if (patch != other.patch) patch = PatchId();
    }
  };
  using Facets = BoxTree<OfPatch>;
  /// A sharp edge, the sides that meet there, and the max ratio of the way over the edge to the straight way.
  struct Wedge {
    std::pair<std::uint32_t, std::uint32_t> sides;
    VertexId a, b;
    double factor = 0;
  };
  /// A part of a patch's border: an edge, or a vertex, for which both ends are the same.
  struct Part {
    VertexId a, b;
  };
  /// Borders with more parts than this have a tree.
  static constexpr std::size_t kLongBorder = 64;
  static constexpr std::uint32_t kNoTree = 0xffffffffu;

  void find_facets(const Claim& claim, RunControl& control);
  void find_bodies(const BoundaryGraph& seams, RunControl& control);
  void find_contacts(RunControl& control);
  void find_borders(const BoundaryGraph& seams, RunControl& control);
  void find_wedges(const BoundaryGraph& seams, double feature_angle_deg, RunControl& control);

  Vec3 local(const Vec3& place) const { return unit_ * (place - centre_); }
  Vec3 point(VertexId v) const { return local(numbered_.points[v.value]); }
  Corners3 corners(std::size_t slot) const;
  std::span<const Part> border_of(PatchId p) const {
    return std::span(border_parts_)
        .subspan(border_begin_[p.value], border_begin_[p.value + 1] - border_begin_[p.value]);
  }
  bool is_curved(PatchId p) const { return numbered_.curved_surface(p) != nullptr; }
  /// The tolerance of a curved patch, in local units; 0 for a plane. The patch's output may be this far off the facets.
  double curved_tolerance(PatchId p) const { return is_curved(p) ? unit_ * numbered_.curved_surface(p)->tolerance : 0; }
  /// The normal of a patch at a place.
  Vec3 normal(PatchId p, const Vec3& place) const;
  void find_sides();
  bool are_crossing(PatchId p, PatchId q) const;
  bool is_at(VertexId v, PatchId p) const;
  bool is_edge_of(const Part& part, PatchId p) const;
  bool is_clear_gap(const Vec3& from, PatchId p, const Vec3& there, PatchId q, std::size_t& looks) const;
  bool is_any_nearer(PatchId q, const Vec3& to, double squared, std::size_t& looks) const;
  bool may_be_narrow(const Vec3& from, PatchId p, const Vec3& there, PatchId q, std::size_t& looks) const;
  bool may_be_in_wedge(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double length, std::size_t& looks) const;
  bool is_over_surface(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double most, std::size_t& looks) const;

  const NumberedClaim& numbered_;
  Vec3 centre_;
  double unit_ = 1;        ///< local lengths are model lengths times this
  double rounding_ = 0;    ///< two facets that are not farther from each other may touch; local length
  double min_height_ = 0;  ///< gaps with a smaller height do not count; local units
  std::vector<std::array<VertexId, 3>> triangles_;
  Facets facets_;
  static constexpr std::uint32_t kOpen = 0xffffffffu;
  std::vector<std::uint32_t> body_;  ///< the closed body that each patch bounds, or kOpen
  /// Each vertex of several patches with each of these patches, sorted.
  std::vector<std::pair<VertexId, PatchId>> contacts_;
  std::vector<std::pair<Part, PatchId>> edges_;  ///< each bounding edge with each of its patches, sorted
  std::vector<std::uint32_t> border_begin_;      ///< the first part of each patch's border
  std::vector<Part> border_parts_;
  std::vector<std::uint32_t> border_tree_;  ///< the tree of each patch, or kNoTree
  std::vector<BoxTree<NoTag>> trees_;
  std::vector<std::uint32_t> side_;  ///< of each patch
  std::vector<Wedge> wedges_;        ///< by their sides
  std::span<const std::pair<PatchId, PatchId>> crossing_;
  bool is_crossing_known_ = true;
  std::vector<std::uint8_t> is_turned_;  ///< for each patch, its faces look against the normal of its curved surface
};

}  // namespace remesh::verification
