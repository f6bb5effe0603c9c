/// The claim in one numbering and one scale: what all tests of the checker read.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/verify.h"
#include "core/verify/edge_table.h"
#include "core/verify/findings.h"

namespace remesh::verification {

/// Indices grouped by patch.
class ByPatch {
 public:
  ByPatch() = default;
  ByPatch(std::size_t patch_count, std::span<const PatchId> patch_of);
  std::span<const std::uint32_t> operator[](std::size_t patch) const {
    return std::span(items_).subspan(begin_[patch], begin_[patch + 1] - begin_[patch]);
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> items_;
};

/// Vertices are numbered as in the surface. The new ones of a refined result follow, then output vertices that are
/// neither (moved, or a second one at the same place), so that whatever uses them fails by its edges.
/// Lengths are scaled by a power of two to coordinates of at most 1, so that nothing over- or underflows.
struct Model {
  Model() = default;
  Model(Model&&) = default;  // not copied: spans look into the model itself

  std::vector<Vec3> points;
  std::size_t surface_vertex_count = 0;
  std::size_t new_vertex_end = 0;     ///< new vertices are numbered from surface_vertex_count to here
  std::vector<std::uint8_t> is_kept;  ///< the output uses this vertex
  Faces input;
  Faces output;
  ByPatch input_by_patch;
  ByPatch output_by_patch;
  std::vector<Frame> frames;
  std::span<const Vec2> corner_uv;  ///< one per output corner
  double scale = 1;                 ///< model units times this are the units here
  double tolerance = 0;

  std::size_t patch_count() const { return frames.size(); }
  /// Has refinement made this vertex?
  bool is_new(VertexId v) const { return v.value >= surface_vertex_count && v.value < new_vertex_end; }

  /// May a distance be called within the tolerance? Besides a share of 1e-9 it allows for the rounding of the
  /// measurement itself: some ten roundings of numbers no larger than `reach`.
  bool is_within_tolerance(double distance, double reach) const {
    return distance <= tolerance * (1 + 1e-9) + 2e-15 * reach;
  }

  /// How far a new vertex may be from where it was meant to be, when coordinates up to `reach` went into it: some ten
  /// roundings in each of three.
  static double rounding(double reach) { return 0x1p-49 * reach; }

  // What the spans above look into.
  std::vector<std::uint32_t> output_face_begin;
  std::vector<VertexId> output_corners;
};

/// The largest of a point's coordinates, without sign.
inline double largest_coordinate(const Vec3& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

/// Do the claim's arrays fit together, with every number in range and every surface coordinate finite?
bool is_well_formed(const Claim& claim, RunControl& control);

/// Input:  a well-formed claim. Reports kMovedVertex.
Model make_model(const Claim& claim, Findings& findings, RunControl& control);

}  // namespace remesh::verification
