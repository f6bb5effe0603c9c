/// Where patches are joined, and how far it is from one to the other over the surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Knows for each vertex its patches and for each patch its border, but no pairs of patches: a vertex where n facets
/// meet has n^2 of them. Memory is linear in the corners.
class PatchContacts {
 public:
  /// The arguments must outlive this.
  PatchContacts(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, RunControl& control);

  /// Ascending.
  std::span<const PatchId> patches_at(VertexId v) const {
    return std::span(vertex_patches_)
        .subspan(vertex_begin_[v.value], vertex_begin_[v.value + 1] - vertex_begin_[v.value]);
  }
  /// The vertex of p at which the most patches meet; none if p is joined to no other.
  VertexId busiest_vertex(PatchId p) const;

  /// The two patches with the longest borders that are joined to p at vertices of at most so many patches.
  std::array<PatchId, 2> largest_neighbours(PatchId p, std::size_t most_patches) const;
  /// The vertices of p's border where so many patches meet, in the order of its faces.
  std::vector<VertexId> corners(PatchId p, std::size_t least_patches, std::size_t most_patches) const;

  /// Do they share a vertex?
  bool are_joined(PatchId p, PatchId q) const;
  /// Is there a vertex or edge that both share, and a part of it within `distance` of a place? Local units.
  /// Cost: linear in the smaller border if that is small, else O(log n) and what lies so near.
  bool are_joined_within(PatchId p, PatchId q, const Vec3& place, double distance) const;
  /// Is there a vertex or edge that both share, and a way from `from` on p over it to `to` on q, straight on either
  /// side and at most `most` long? Local units.
  /// Cost: linear in the smaller border if that is small, else O(log n) and what lies between the places.
  bool has_way(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double most) const;

 private:
  /// Borders longer than this have a tree.
  static constexpr std::size_t kLongBorder = 32;

  void find_vertex_patches(RunControl& control);
  void find_borders(RunControl& control);
  void add_tree(PatchId p, RunControl& control);

  /// Corners of p at which another patch is met, each vertex at least once; where p's border leaves the vertex, the
  /// half-edge along it.
  std::span<const std::uint32_t> border(PatchId p) const {
    return std::span(border_).subspan(border_begin_[p.value], border_begin_[p.value + 1] - border_begin_[p.value]);
  }
  bool is_at(VertexId v, PatchId p) const;
  bool is_along(std::uint32_t half_edge, PatchId p) const;
  /// Whether is_wanted(a, b) for what p and q share: an edge a-b, or a vertex a = b. `bound` is the least for a box,
  /// and what is above `most` is not asked for.
  template <class Bound, class IsWanted>
  bool any_shared(PatchId p, PatchId q, double most, const Bound& bound, const IsWanted& is_wanted) const;

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& patches_;
  std::vector<std::uint32_t> vertex_begin_;
  std::vector<PatchId> vertex_patches_;
  std::vector<std::uint32_t> border_begin_;
  std::vector<std::uint32_t> border_;
  std::vector<BoxTree<NoTag>> trees_;         ///< of the long borders
  IdVector<PatchId, std::uint32_t> tree_of_;  ///< which, or kNoTree
  static constexpr std::uint32_t kNoTree = 0xffffffffu;
};

}  // namespace remesh
