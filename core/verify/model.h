/// The claim in one numbering and one scale: what all tests of the checker read.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/largest_coordinate.h"
#include "core/verify/edge_table.h"
#include "core/verify/verification_faults.h"
#include "core/verify/verify.h"

namespace remesh::verification {

/// Points in the model's scale: the surface's, scaled when they are asked for, and then those that were added.
class Points {
 public:
  Points() = default;
  Points(std::span<const Vec3> of_surface, double scale) : of_surface_(of_surface), scale_(scale) {}

  std::size_t size() const { return of_surface_.size() + added_.size(); }
  Vec3 operator[](std::size_t v) const {
    return v < of_surface_.size() ? scale_ * of_surface_[v] : added_[v - of_surface_.size()];
  }
  void push_back(const Vec3& unscaled) { added_.push_back(scale_ * unscaled); }

 private:
  std::span<const Vec3> of_surface_;
  double scale_ = 1;
  std::vector<Vec3> added_;
};

/// Vertices are numbered as in the surface. The new ones of a refined result follow, then output vertices that are
/// neither (moved, or a second one at the same place), so that whatever uses them fails by its edges.
/// Lengths are scaled by a power of two to coordinates of at most 1, so that nothing over- or underflows.
struct Model {
  Model() = default;
  Model(Model&&) = default;  // not copied: spans look into the model itself

  Points points;
  std::size_t surface_vertex_count = 0;
  std::size_t new_vertex_end = 0;     ///< new vertices are numbered from surface_vertex_count to here
  std::vector<std::uint8_t> is_kept;  ///< the output uses this vertex
  Faces input;
  Faces output;
  Grouping input_by_patch;
  Grouping output_by_patch;
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

/// Do the claim's arrays fit together, with every number in range and every surface coordinate finite?
bool is_well_formed(const Claim& claim, RunControl& control);

/// Input:  a well-formed claim. Reports kMovedVertex.
Model make_model(const Claim& claim, Findings& findings, RunControl& control);

}  // namespace remesh::verification
