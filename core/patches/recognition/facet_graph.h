/// The facets of a surface, and which of them meet smoothly.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/patches/recognition/facets.h"

namespace remesh {

/// The graph of facets over smooth edges. A facet is a planar patch, and its corners are its essential vertices. An
/// edge is smooth if it has two facets that turn by at most the feature angle, with no barrier between them.
class FacetGraph {
 public:
  /// Holds:  the facets outlive the graph.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n).
  FacetGraph(const Facets& facets, double feature_angle_deg, RunControl& control);

  std::size_t size() const { return facets_.patches.count(); }
  /// True if some edge is smooth.
  bool has_smooth_edges() const { return smooth_edges_ > 0; }
  double area(PatchId p) const { return facets_.summaries[p.value].area * inverse_unit_ * inverse_unit_; }
  const Vec3& normal(PatchId p) const { return facets_.patches.planes[p].normal; }
  const Vec3& position(VertexId v) const { return facets_.surface.local[v]; }
  VertexId vertex(std::uint32_t side) const { return facets_.adjacency.from(facets_.loops.half_edges[side]); }
  /// Returns the vertex in which a side ends.
  VertexId end_vertex(std::uint32_t side) const { return facets_.adjacency.to(facets_.loops.half_edges[side]); }
  bool is_corner(std::uint32_t side) const { return facets_.essential[vertex(side)]; }

  /// The sides of a facet are the half-edges of its loops. They are numbered one facet after another.
  std::uint32_t sides_begin(PatchId p) const { return facets_.loops.loop_begin[facets_.loops.patch_begin[p.value]]; }
  std::uint32_t sides_end(PatchId p) const { return sides_begin(PatchId(p.value + 1)); }
  /// Returns the facet beyond a side, if the edge between them is smooth. Otherwise the result is invalid.
  PatchId beyond(std::uint32_t side) const { return beyond_[side]; }

  /// Returns whether a facet may be a piece of a curved surface: it has one loop, few corners and a smooth side, or all
  /// of its sides are smooth, like those of a flat ring around a torus.
  bool may_be_curved(PatchId p) const { return corner_count_[p] != 0; }
  /// Returns whether a surface may begin to grow at a facet that may be curved. It has one loop and few corners.
  bool may_be_seed(PatchId p) const { return corner_count_[p] != 0 && corner_count_[p] != kManyCorners; }
  /// Returns the number of corners of a facet that may be a seed.
  std::size_t corner_count(PatchId p) const { return corner_count_[p]; }

  /// Calls take(position) for each corner of a facet, in the order of its loops.
  template <class Take>
  void for_each_corner(PatchId p, const Take& take) const {
    for (std::uint32_t s = sides_begin(p); s < sides_end(p); ++s)
      if (is_corner(s)) take(position(vertex(s)));
  }
  /// Returns the mean of a facet's corners.
  Vec3 mean_corner(PatchId p) const {
    Vec3 sum;
    int count = 0;
    for_each_corner(p, [&](const Vec3& q) {
      sum += q;
      ++count;
    });
    return (1.0 / std::max(1, count)) * sum;
  }
  /// Calls take(from, to, is_corner) for each side of a facet. The last argument tells whether the side begins at a
  /// corner.
  template <class Take>
  void for_each_side(PatchId p, const Take& take) const {
    for (std::uint32_t s = sides_begin(p); s < sides_end(p); ++s)
      take(position(vertex(s)), position(facets_.adjacency.to(facets_.loops.half_edges[s])), is_corner(s));
  }
  /// Calls take(neighbour) for each smooth side.
  template <class Take>
  void for_each_neighbour(PatchId p, const Take& take) const {
    for (std::uint32_t s = sides_begin(p); s < sides_end(p); ++s)
      if (beyond_[s].is_valid()) take(beyond_[s]);
  }

 private:
  const Facets& facets_;
  std::vector<PatchId, DefaultInit<PatchId>> beyond_;
  static constexpr std::uint8_t kManyCorners = 255;

  FilledIdVector<PatchId, std::uint8_t> corner_count_;  ///< 0 if the facet cannot be curved
  std::size_t smooth_edges_ = 0;
  double inverse_unit_;
};

}  // namespace remesh
