/// The claims that the independent checker tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/planes/frame.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/unrefined_reason.h"

namespace remesh {

/// Refinement's claim about what it has reached.
struct RefinementClaim {
  Goals goals;
  /// The output faces that do not meet the goals, ascending: faces with an angle below the bound, or with an edge or
  /// an area above it, or above the size that gaps or short edges ask for there.
  std::span<const FaceId> unrefined;
  std::span<const UnrefinedReason> reasons;  ///< one per entry of `unrefined`
  /// For each patch, true if refinement had to leave it and its boundary unchanged. Empty means that no patch is
  /// frozen.
  std::span<const std::uint8_t> frozen = {};
};

/// The pairs of patches that intersect in the input, sorted, with the smaller patch first. (p, p) means an
/// intersection within a patch.
struct InputIntersections {
  std::vector<std::pair<PatchId, PatchId>> patches;
  bool is_complete = true;  ///< false: there are so many intersections that some pairs may be missing
  bool are_told = true;     ///< false: if they are not all known, those of the output need not be listed

  bool has(PatchId p, PatchId q) const {
    return std::binary_search(patches.begin(), patches.end(), std::pair(std::min(p, q), std::max(p, q)));
  }
};

/// The pipeline's claim that a patch samples a curved surface.
struct CurvedClaim {
  AnalyticSurface shape;  ///< model units; kCylinder, kCone, kSphere or kTorus
  /// NumberedClaim units. Input and output of the patch may be this far apart, plus the plane tolerance, and each of
  /// them may be this far from the surface. What exceeds half of the radius of a cylinder, sphere or tube has no
  /// effect.
  double tolerance = 0;
  /// The surface tolerance that the options allow, in model units. If there is none, input and output may be no farther
  /// apart than the input's own facets explain, with what the number of edges per full turn adds.
  std::optional<double> surface_tolerance = {};
  std::optional<double> elements_per_circle = {};
  /// Facets that turn by more than this, in degrees, do not belong to one surface.
  double feature_angle_deg = 30;
};

/// The pipeline's claim that it has moved a vertex of the surface.
struct MovedVertex {
  VertexId output, of_surface;
};

/// The frames of patches. A patch that is one triangle of the input and of the output needs none.
class ClaimedFrames {
 public:
  /// Input: the frame of each patch.
  ClaimedFrames(const IdVector<PatchId, Frame>& of_all) : count_(of_all.size()), frames_(of_all.items()) {}
  /// Input: for each patch, the index of its frame, or kNone.
  ClaimedFrames(std::span<const std::uint32_t> of_patch, std::span<const Frame> frames)
      : count_(of_patch.size()), of_patch_(of_patch), frames_(frames) {}

  std::size_t patch_count() const { return count_; }
  /// Returns the frame of a patch, or null.
  const Frame* of(std::size_t p) const {
    const std::size_t at = of_patch_.empty() ? p : of_patch_[p];
    return at < frames_.size() ? &frames_[at] : nullptr;
  }

 private:
  std::size_t count_;
  std::span<const std::uint32_t> of_patch_;  ///< empty if every patch has a frame
  std::span<const Frame> frames_;
};

/// The pipeline's claim about what it has done. This class is larger than the bound because it is a list of arguments.
struct Claim {
  const Surface& surface;                  ///< the surface that was remeshed
  std::span<const PatchId> surface_patch;  ///< patch of each face of `surface`
  ClaimedFrames frames;
  std::span<const Vec3> positions;                    ///< output vertices
  std::span<const Triangle> faces;                    ///< output faces
  std::span<const PatchId> face_patch;                ///< patch of each output face
  std::span<const Vec2> corner_uv;                    ///< stored plane coordinates, 3 per output face
  double plane_tolerance = 0;                         ///< model units
  bool has_new_vertices = false;                      ///< made by refinement, or required by the chord rule
  const RefinementClaim* refinement = nullptr;        ///< null if nothing was refined
  const InputIntersections* intersections = nullptr;  ///< null if there are none
  /// The corners of `surface`, sorted by (smaller vertex, larger vertex, corner) of the edge that begins there. If
  /// this is empty or wrong, the checker sorts them itself.
  std::span<const std::uint32_t> surface_edge_order = {};
  /// The mesh as it was read. `surface` was made from it by welding within `weld_tolerance` and by mending. Null if
  /// it is not known.
  const PolygonMesh* input = nullptr;
  double weld_tolerance = 0;  ///< model units
  /// For each patch, the index of its surface in `curved`, or kNone for a plane. Empty means that all patches are
  /// planes. The frame and the plane coordinates of a curved patch are not read.
  std::span<const std::uint32_t> curved_of_patch = {};
  std::span<const CurvedClaim> curved = {};
  /// The vertices on boundaries of curved patches that are elsewhere in the output, ascending in both numbers.
  std::span<const MovedVertex> moved = {};
};

}  // namespace remesh
