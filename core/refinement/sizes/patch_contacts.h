/// Tells where patches are joined, and how long the ways between them over the surface are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Returns the length of the shortest way from p over the segment a-b to q, if both are unfolded into one plane about
/// its line.
double way_over(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q);

/// Stores the patches of each vertex and the border of each patch. No pairs of patches are stored, because a vertex
/// where n facets meet has n^2 pairs. The memory is linear in the number of corners.
class PatchContacts {
 public:
  /// The arguments must outlive this object.
  PatchContacts(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, RunControl& control);

  /// Returns the patches at a vertex, ascending.
  std::span<const PatchId> patches_at(VertexId v) const {
    return std::span(vertex_patches_)
        .subspan(vertex_begin_[v.value], vertex_begin_[v.value + 1] - vertex_begin_[v.value]);
  }
  /// Returns the vertex of p at which the most patches meet. It is invalid if p is joined to no other patch.
  VertexId busiest_vertex(PatchId p) const;

  /// Finds the neighbours of p: the patches that share a vertex with p, but only vertices count at which at most
  /// `most_patches` patches meet. Returns the two neighbours with the longest borders. If there are fewer than two, the
  /// rest of the entries are invalid.
  std::array<PatchId, 2> largest_neighbours(PatchId p, std::size_t most_patches) const;
  /// Returns the vertices of p's border where between `least_patches` and `most_patches` patches meet, in the order of
  /// p's faces.
  std::vector<VertexId> corners(PatchId p, std::size_t least_patches, std::size_t most_patches) const;

  /// Returns whether the two patches share a vertex.
  bool are_joined(PatchId p, PatchId q) const;
  /// Returns whether the patches share a vertex or an edge that comes within `distance` of a place. All values are in
  /// local units.
  /// Cost: Constant if the thread has asked about this pair of patches before and they share little. Linear in the
  ///       smaller border if that is small. Otherwise O(log n) and the number of border edges within the distance.
  bool are_joined_within(PatchId p, PatchId q, const Vec3& place, double distance) const;
  /// Returns whether there is a way of length at most `most` from `from` on p to `to` on q that crosses a shared vertex
  /// or edge and is straight on both sides of it. All values are in local units.
  /// Cost: The same as for `are_joined_within`, with the border edges between the two places.
  bool has_way(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double most) const;

 private:
  /// Borders longer than this get a tree of boxes.
  static constexpr std::size_t kLongBorder = 32;
  /// If an edge has more faces than this, a list of the edge's patches is stored.
  static constexpr std::size_t kCrowded = 8;
  struct Crowd {
    EdgeId edge;
    std::vector<PatchId> patches;  ///< ascending
  };

  void find_vertex_patches(RunControl& control);
  void find_borders(RunControl& control);
  void find_crowds(RunControl& control);
  void add_tree(PatchId p, RunControl& control);

  /// Returns the border of p as half-edges. They begin at all vertices of p where other patches meet it, each at least
  /// once. Where p's border leaves such a vertex, the half-edge runs along the border.
  std::span<const std::uint32_t> border(PatchId p) const {
    return std::span(border_).subspan(border_begin_[p.value], border_begin_[p.value + 1] - border_begin_[p.value]);
  }
  struct Shared;
  const Shared& shared(PatchId p, PatchId q) const;
  bool is_at(VertexId v, PatchId p) const;
  bool is_along(std::uint32_t half_edge, PatchId p) const;
  /// Returns whether is_wanted(a, b) is true for any edge a-b that p and q share, or any vertex with a = b. `bound`
  /// gives a lower bound for a box. Boxes whose bound is above `most` are not searched.
  template <class Bound, class IsWanted>
  bool any_shared(PatchId p, PatchId q, double most, const Bound& bound, const IsWanted& is_wanted) const;

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& patches_;
  std::uint64_t number_;  ///< no other object has this number; see `shared`
  std::vector<std::uint32_t> vertex_begin_;
  std::vector<PatchId> vertex_patches_;
  std::vector<std::uint32_t> border_begin_;
  std::vector<std::uint32_t> border_;
  std::vector<Crowd> crowds_;                 ///< ascending by edge
  std::vector<BoxTree<NoTag>> trees_;         ///< trees of the long borders
  IdVector<PatchId, std::uint32_t> tree_of_;  ///< index in `trees_`, or kNoTree
  static constexpr std::uint32_t kNoTree = 0xffffffffu;
};

}  // namespace remesh
