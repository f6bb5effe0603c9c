/// Numbers the edges of all patches and places samples on them, at which a prediction reads sizes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// An edge of a triangulated patch. A constrained edge is a single edge, shared by all patches that have it.
struct SampledEdge {
  std::uint32_t first_side, side_count;      ///< of its sides
  std::uint32_t first_sample, sample_count;  ///< of its samples, which are in order along the edge
  double length;                             ///< model units
  bool is_constrained;
};

/// A half-edge of a patch.
struct EdgeSide {
  PatchId patch;
  std::uint32_t half_edge;
};

/// The edges of all patches, and samples on them. The samples are dense where sizes may change quickly: beside ends
/// where a short edge begins, and beside the foot of a near vertex. From there on, the distances between samples grow
/// by a factor. So an edge of a good mesh has a sample at each end, and no edge has more than some 60.
/// Cost: O(n log n) for n edges, mostly to sort them; some 100 bytes an edge and 8 a sample.
class SampledEdges {
 public:
  /// Input:  the patches, which must outlive this object. `has_middles` asks for a sample in the middle of each edge,
  ///         and not only near features.
  /// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
  SampledEdges(const TriangulatedPatches& triangulated, bool has_middles, RunControl& control);

  std::uint32_t size() const { return static_cast<std::uint32_t>(edges_.size()); }
  const SampledEdge& operator[](std::uint32_t e) const { return edges_[e]; }
  std::uint32_t edge_at(EdgeSide side) const { return edge_of(begin_[side.patch] + side.half_edge); }
  std::span<const EdgeSide> sides(const SampledEdge& e) const {
    return std::span(sides_).subspan(e.first_side, e.side_count);
  }

  // Half-edges are also numbered through all patches, three for each triangle, so that spreading over triangles needs
  // no access to patches.

  /// Returns the half-edges of an edge's sides.
  std::span<const std::uint32_t> half_edges(const SampledEdge& e) const {
    return std::span(half_edges_).subspan(e.first_side, e.side_count);
  }
  std::uint32_t edge_of(std::uint32_t half_edge) const { return edge_of_[half_edge] / 2; }
  /// Returns whether a half-edge runs in the direction in which the samples of its edge are ordered.
  bool is_forward(std::uint32_t half_edge) const { return edge_of_[half_edge] % 2 != 0; }
  /// Returns 1 minus the cosine of the triangle's angle at the start of a half-edge.
  double versine(std::uint32_t half_edge) const { return versine_[half_edge]; }

  std::size_t sample_count() const { return place_.size(); }
  /// Returns where a sample is on its edge, from 0 to 1.
  double place(std::uint32_t sample) const { return place_[sample]; }
  /// Returns the first sample of an edge beyond a place, or one past its last sample.
  std::uint32_t first_sample_after(const SampledEdge& e, double place) const {
    const auto begin = place_.begin() + e.first_sample;
    return e.first_sample + static_cast<std::uint32_t>(std::upper_bound(begin, begin + e.sample_count, place) - begin);
  }

  /// Returns the index of a half-edge's triangle among the triangles of all patches.
  std::uint32_t triangle_of(EdgeSide side) const { return (begin_[side.patch] + side.half_edge) / 3; }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(scale_.size()); }
  /// Returns the length in model units per length in the plane of the patch, at a half-edge's triangle.
  double scale(EdgeSide side) const { return scale_[triangle_of(side)]; }
  /// Returns the step of coordinates at a half-edge's triangle, in model units.
  double rounding(EdgeSide side) const {
    return std::max(steps_[side.patch].in_space, steps_[side.patch].in_plane * scale(side));
  }
  const PatchMesh& patch(EdgeSide side) const { return meshes_[side.patch]; }

  /// A straight way in the plane of a patch.
  struct Way {
    Vec2 from, step;
    Vec2 at(double place) const { return from + place * step; }
  };
  /// Returns the way along an edge, in the order of its samples.
  Way way(EdgeSide side) const {
    const PatchMesh& patch = meshes_[side.patch];
    const Vec2 from = patch.uv[patch.mesh.from(side.half_edge)], to = patch.uv[patch.mesh.to(side.half_edge)];
    return is_forward(side) ? Way{from, to - from} : Way{to, from - to};
  }

 private:
  struct Steps {
    double in_space, in_plane;
  };

  void measure(const TriangulatedPatches& triangulated, PatchId p, RunControl& control);
  void add_versines(std::uint32_t first, const Vec2 (&p)[3]);
  void number_constrained(RunControl& control);
  void number_others(RunControl& control);
  void add_edge(EdgeSide side, bool is_constrained);
  void add_side(EdgeSide side, bool is_forward);
  bool is_forward(EdgeSide side) const { return is_forward(begin_[side.patch] + side.half_edge); }
  std::vector<double> shortest_at_vertices(RunControl& control) const;
  void place_samples(bool has_middles, RunControl& control);
  void add_beside(std::uint32_t e, const std::vector<double>& shortest, std::vector<double>& places) const;

  const PatchMeshes& meshes_;
  IdVector<PatchId, std::uint32_t> begin_;  ///< the first half-edge of each patch among those of all patches
  IdVector<PatchId, Steps> steps_;          ///< the steps of coordinates
  std::vector<std::uint32_t> edge_of_;      ///< one per half-edge: twice its edge, and 1 more if it runs forward
  std::vector<float> versine_;              ///< one per half-edge
  std::vector<double> scale_;               ///< one per triangle
  std::vector<SampledEdge> edges_;
  std::vector<EdgeSide> sides_;
  std::vector<std::uint32_t> half_edges_;  ///< one per side
  std::vector<double, DefaultInit<double>> place_;
};

}  // namespace remesh
