/// What the checker found wrong, patch by patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/verify/verdict.h"

namespace remesh::verification {

enum class Fault : std::uint8_t {
  kMalformed,         ///< the claim's arrays do not fit together
  kMovedVertex,       ///< an output vertex is neither the input's nor new, or another one is in its place
  kForeignVertex,     ///< a patch uses a vertex that it has not in the input
  kLostVertex,        ///< a patch dropped a vertex at which it is joined to others
  kNoFaces,           ///< a patch came back without faces
  kLostLoop,          ///< a boundary loop has no vertex left
  kBoundary,          ///< a boundary edge whose faces are not those that the input has along it
  kChord,             ///< a dropped boundary vertex is off the edge that replaces it
  kDeviation,         ///< input and output are further apart than the tolerance
  kFacingAway,        ///< an input face looks away from its patch's normal: the patch folds over
  kArea,              ///< the patch's area is not kept
  kZeroArea,          ///< a triangle of no area
  kInverted,          ///< a triangle that is turned over in the patch's plane
  kFrame,             ///< the frame is no frame
  kPlaneCoordinates,  ///< stored plane coordinates are not the projection of their vertex
  kNotDelaunay,       ///< an edge is not locally Delaunay, though it could be flipped
  kEuler,             ///< the Euler number changed
  kOpened,            ///< a closed surface is open now
  kVolume,            ///< the enclosed volume changed by more than the deviations explain
  kNewVertex,         ///< a new vertex is neither on one edge nor inside one patch
  kNewOffLine,        ///< new vertices on an edge are off the line between its ends, or not in order along it
  kLockedBoundary,    ///< a new vertex on an edge, where none was to be
  kUnlisted,          ///< a face misses the goals, and is not listed
  kListedInVain,      ///< a face is listed, and meets the goals
  kCertificate,       ///< a face is listed for a reason that it has not
  kShortEdge,         ///< refinement made an edge shorter than the least length
  kTooManyFaces,      ///< more faces than allowed
  kNewIntersection,   ///< faces intersect, of patches that do not in the input
  kPolygon,           ///< what came of a polygon of the input covers something else than the polygon
};
inline constexpr int kFaultCount = static_cast<int>(Fault::kPolygon) + 1;

/// One fault at one place. An invalid patch: it belongs to the whole.
struct Finding {
  PatchId patch;
  Fault fault;
  std::uint32_t element;  ///< vertex, face or boundary edge's first vertex; what the fault's words say
};

/// Collects findings: the first of each fault and patch. Not for several threads; those hand in lists.
class Findings {
 public:
  /// Only a refined result has a verdict on quality.
  Findings(std::size_t patch_count, bool is_refined) : is_refined_(is_refined), of_patch_(patch_count, 0) {}

  void add(PatchId patch, Fault fault, std::uint32_t element = 0);
  void add(const std::vector<Finding>& findings) {
    for (const Finding& f : findings) add(f.patch, f.fault, f.element);
  }
  /// Fills flags, failed patches and the first failures in words.
  void write_to(Verdict& verdict) const;

 private:
  bool is_refined_;
  std::vector<std::uint32_t> of_patch_;  ///< a bit for each fault
  std::uint32_t of_whole_ = 0;
  std::vector<Finding> findings_;
};

}  // namespace remesh::verification
