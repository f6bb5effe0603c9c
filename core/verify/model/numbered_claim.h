/// The claim in one numbering of vertices and one scale. All tests of the checker read it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/largest_coordinate.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/curved_shape.h"
#include "core/verify/model/edge_table.h"

namespace remesh::verification {

/// The vertices of the surface that are at other places in the output. In the input they are at their old places.
struct MovedVertices {
  std::vector<std::uint32_t> at;  ///< indices of the following arrays, or kNone, by surface vertex; empty if none moved
  std::vector<Vec3> to;
  std::vector<double> allowed;  ///< the distance that a curved patch allows there

  std::uint32_t index(VertexId v) const { return v.value < at.size() ? at[v.value] : kNone; }
};

/// Points in the numbered claim's scale. First come the surface's points, which are scaled at each access, then the
/// points that were added.
class Points {
 public:
  Points() = default;
  Points(std::span<const Vec3> of_surface, double scale) : of_surface_(of_surface), scale_(scale) {}

  std::size_t size() const { return of_surface_.size() + added_.size(); }
  Vec3 operator[](std::size_t v) const {
    return v < of_surface_.size() ? scale_ * of_surface_[v] : added_[v - of_surface_.size()];
  }
  void push_back(const Vec3& unscaled) { added_.push_back(scale_ * unscaled); }

  MovedVertices moved;

 private:
  std::span<const Vec3> of_surface_;
  double scale_ = 1;
  std::vector<Vec3> added_;
};

/// The patches' frames in the numbered claim's scale. They are scaled at each access, because there may be a million.
/// A frame that is missing has grid 0, which no frame may have.
class Frames {
 public:
  Frames() = default;
  Frames(const ClaimedFrames& claimed, double scale) : claimed_(claimed), scale_(scale) {}

  std::size_t size() const { return claimed_.patch_count(); }
  Frame operator[](std::size_t p) const {
    Frame frame = claimed(p);
    frame.origin = scale_ * frame.origin;
    frame.scale *= scale_;
    return frame;
  }
  const Frame& claimed(std::size_t p) const {
    static const Frame kMissing;
    const Frame* const frame = claimed_.of(p);
    return frame != nullptr ? *frame : kMissing;
  }

 private:
  ClaimedFrames claimed_{{}, {}};
  double scale_ = 1;
};

/// The surface of a curved patch, and the distance from it that is allowed.
struct CurvedSurface {
  CurvedShape shape;
  double tolerance = 0;  ///< between input and output, without the plane tolerance
  CurvedClaim claim;     ///< in model units
};

/// The surfaces of all curved patches.
struct CurvedSurfaces {
  std::vector<CurvedSurface> surfaces;
  std::span<const std::uint32_t> of_patch;  ///< indices of these surfaces, or kNone; empty if all patches are planes
};

/// Vertices are numbered as in the surface. The new vertices of a refined result follow. After them come output
/// vertices that are neither (moved without a claim, or a second one at the same place). Faces with such vertices fail
/// the test of edges.
///
/// Lengths are scaled by a power of two to coordinates of at most 1, so that nothing overflows or underflows.
/// This class is larger than the bound because it is the list of what all tests read.
struct NumberedClaim {
  NumberedClaim() = default;
  NumberedClaim(NumberedClaim&&) = default;  // it cannot be copied, because its spans refer to its own members

  Points points;
  std::size_t surface_vertex_count = 0;
  std::size_t new_vertex_end = 0;          ///< new vertices are numbered from surface_vertex_count to here
  std::vector<std::uint8_t> is_in_output;  ///< the output uses this vertex
  Faces input;
  Faces output;
  Grouping input_by_patch;
  Grouping output_by_patch;
  /// For each patch, 1 if it is kept: it is one triangle of the input and the same triangle in the output. Nothing can
  /// be wrong with such a patch, so only its edges with other patches are tested, and its frame and plane coordinates
  /// are not read.
  std::vector<std::uint8_t> is_kept;
  Frames frames;
  std::span<const Vec2> corner_uv;  ///< one per output corner
  double scale = 1;                 ///< model units times this give the units used here
  double tolerance = 0;
  CurvedSurfaces curved;

  std::size_t patch_count() const { return frames.size(); }
  /// True if refinement made this vertex.
  bool is_new(VertexId v) const { return v.value >= surface_vertex_count && v.value < new_vertex_end; }

  /// The unit normal of a patch's frame. That of a kept patch is the normal of its triangle, or null if it has no area.
  Vec3 normal(PatchId p) const;

  bool has_curved() const { return !curved.of_patch.empty(); }
  /// The surface of a patch; null for a plane.
  const CurvedSurface* curved_surface(PatchId p) const {
    if (!has_curved() || curved.of_patch[p.value] == kNone) return nullptr;
    return &curved.surfaces[curved.of_patch[p.value]];
  }
  /// True if one of the patches that use an edge is curved.
  bool is_any_curved(std::span<const Use> uses) const {
    return has_curved() && std::any_of(uses.begin(), uses.end(),
                                       [&](const Use& use) { return curved_surface(use.patch()) != nullptr; });
  }

  bool is_moved(VertexId v) const { return points.moved.index(v) != kNone; }
  /// The place of a vertex in the output. `points` has its place in the input.
  Vec3 output_point(VertexId v) const { return is_moved(v) ? points.moved.to[points.moved.index(v)] : points[v.value]; }
  /// The max distance by which a vertex may be moved.
  double allowed_move(VertexId v) const { return is_moved(v) ? points.moved.allowed[points.moved.index(v)] : 0; }

  /// True if a distance counts as within the tolerance. Besides a share of 1e-9 this permits the rounding of the
  /// measurement itself: about ten roundings of numbers no larger than `reach`.
  bool is_within_tolerance(double distance, double reach) const { return is_within(distance, tolerance, reach); }
  static bool is_within(double distance, double allowed, double reach) {
    return distance <= allowed * (1 + 1e-9) + 2e-15 * reach;
  }

  /// The largest distance of a new vertex from its intended place, if it was computed from coordinates up to `reach`:
  /// about ten roundings in each of three coordinates.
  static double rounding(double reach) { return 0x1p-49 * reach; }

  // The spans in `output` refer to these arrays.
  std::vector<std::uint32_t> output_face_begin;
  std::vector<VertexId> output_corners;
};

/// True if the claim's arrays fit together, every number is in range and every surface coordinate is finite.
bool is_well_formed(const Claim& claim, RunControl& control);
/// True if the lists of a claim about refinement fit together and are in range. The above includes this.
bool is_well_formed(const RefinementClaim& refinement, std::size_t face_count, std::size_t patch_count);

/// Numbers the claim.
/// Input:  a well-formed claim. Reports kMovedVertex.
NumberedClaim number_claim(const Claim& claim, FoundFaults& faults, RunControl& control);

}  // namespace remesh::verification
