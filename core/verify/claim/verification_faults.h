/// The faults that the checker has found, patch by patch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/verify/claim/verdict.h"

namespace remesh::verification {

enum class Fault : std::uint8_t {
  kMalformed,    ///< the claim's arrays do not fit together
  kMovedVertex,  ///< an output vertex is neither an input vertex nor new, or shares the place of another output vertex
  kForeignVertex,     ///< a patch uses an input vertex that it does not have in the input
  kLostVertex,        ///< a patch dropped a vertex that joins it to other patches
  kNoFaces,           ///< a patch has no faces in the output
  kLostLoop,          ///< a boundary loop has no vertex left
  kBoundary,          ///< the faces along a boundary edge differ from the input's
  kReplacedSpan,      ///< a dropped boundary vertex is further from the edge that replaces it than the tolerance
  kDeviation,         ///< input and output are further apart than the tolerance
  kFacingAway,        ///< an input face points against its patch's normal, so the patch folds over
  kArea,              ///< the area of a patch has changed
  kZeroArea,          ///< a triangle has no area
  kInverted,          ///< a triangle is turned over in the patch's plane, or on its curved surface
  kFrame,             ///< the frame of a patch is not valid
  kPlaneCoordinates,  ///< stored plane coordinates are not the projection of their vertex
  kNotDelaunay,       ///< an edge is not locally Delaunay although it could be flipped
  kEuler,             ///< the Euler number has changed
  kOpened,            ///< a closed surface is now open
  kVolume,            ///< the enclosed volume changed by more than the deviations explain
  kNewVertex,         ///< a new vertex is neither on one edge nor inside one patch
  kNewOffLine,        ///< new vertices on an edge are off the line between its ends, or not in order along it
  kLockedBoundary,    ///< a new vertex is on an edge although boundaries were not to be split
  kUnlisted,          ///< a face misses the goals, but is not in the claim's list of such faces
  kListedInVain,      ///< a face is in that list although it meets the goals and was tested
  kCertificate,       ///< a face is in that list with a reason that does not apply to it
  kShortEdge,         ///< refinement made an edge shorter than the smallest permitted length
  kTooManyFaces,      ///< the output has more faces than permitted
  kNewIntersection,   ///< faces intersect although their patches do not intersect in the input
  kPolygon,           ///< the faces that were made of an input polygon do not cover that polygon
  kSurface,           ///< the surface that is claimed for a curved patch is not valid
  kCover,             ///< a curved patch does not cover its surface as often as its input does
  kUnexplained,       ///< a curved patch may be farther from its input than the input explains and the options allow
  kCap,  ///< a face that closes a hole is not flat, has another boundary than the hole, or meets other faces
};
inline constexpr int kFaultCount = static_cast<int>(Fault::kCap) + 1;

/// One fault at one place. The patch is invalid if the fault belongs to the whole mesh.
struct FoundFault {
  PatchId patch;
  Fault fault;
  std::uint32_t element;  ///< a vertex, a face, or the first vertex of a boundary edge, depending on the fault
};

/// Collects faults. It stores the first place of each fault in each patch. Only one thread may use it; several threads
/// collect lists and pass them on.
class FoundFaults {
 public:
  /// Input: `is_refined` - true for a refined result, which alone has a verdict on quality.
  FoundFaults(std::size_t patch_count, bool is_refined) : is_refined_(is_refined), of_patch_(patch_count, 0) {}

  void add(PatchId patch, Fault fault, std::uint32_t element = 0);
  void add(const std::vector<FoundFault>& faults) {
    for (const FoundFault& f : faults) add(f.patch, f.fault, f.element);
  }
  bool is_any() const { return !faults_.empty(); }
  /// Writes the flags, the failed patches and the first failures in words.
  void write_to(Verdict& verdict) const;

 private:
  bool is_refined_;
  std::vector<std::uint64_t> of_patch_;  ///< one bit for each fault
  std::uint64_t of_whole_ = 0;
  std::vector<FoundFault> faults_;
};

}  // namespace remesh::verification
