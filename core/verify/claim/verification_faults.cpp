#include "core/verify/claim/verification_faults.h"

#include <algorithm>
#include <string>
#include <tuple>

namespace remesh::verification {
namespace {

constexpr std::size_t kMaxFailures = 20;

constexpr std::uint64_t bit(Fault fault) { return std::uint64_t{1} << static_cast<int>(fault); }
static_assert(kFaultCount < 64);

// These masks hold the faults that refute each promise. Some faults refute more than one promise. If boundaries do
// not match, the result is not conforming, and the argument for the distance of the surfaces fails too (see
// patch_shape.h).
constexpr std::uint64_t kAgainstSurface =
    bit(Fault::kMalformed) | bit(Fault::kMovedVertex) | bit(Fault::kForeignVertex) | bit(Fault::kNoFaces) |
    bit(Fault::kLostLoop) | bit(Fault::kBoundary) | bit(Fault::kReplacedSpan) | bit(Fault::kDeviation) |
    bit(Fault::kFacingAway) | bit(Fault::kArea) | bit(Fault::kInverted) | bit(Fault::kEuler) | bit(Fault::kVolume) |
    bit(Fault::kNewVertex) | bit(Fault::kNewOffLine) | bit(Fault::kPolygon) | bit(Fault::kSurface) |
    bit(Fault::kCover) | bit(Fault::kUnexplained) | bit(Fault::kCap);
constexpr std::uint64_t kAgainstConforming = bit(Fault::kMalformed) | bit(Fault::kLostVertex) | bit(Fault::kLostLoop) |
                                             bit(Fault::kBoundary) | bit(Fault::kZeroArea) | bit(Fault::kInverted) |
                                             bit(Fault::kOpened) | bit(Fault::kNewVertex) | bit(Fault::kNewOffLine) |
                                             bit(Fault::kNewIntersection);
constexpr std::uint64_t kAgainstDelaunay =
    bit(Fault::kMalformed) | bit(Fault::kFrame) | bit(Fault::kPlaneCoordinates) | bit(Fault::kNotDelaunay);
constexpr std::uint64_t kAgainstQuality = bit(Fault::kMalformed) | bit(Fault::kLockedBoundary) | bit(Fault::kUnlisted) |
                                          bit(Fault::kListedInVain) | bit(Fault::kCertificate) |
                                          bit(Fault::kShortEdge) | bit(Fault::kTooManyFaces);
static_assert((kAgainstSurface | kAgainstConforming | kAgainstDelaunay | kAgainstQuality) ==
              (std::uint64_t{1} << kFaultCount) - 1);

std::string words(const FoundFault& found) {
  const std::string id = std::to_string(found.element);
  switch (found.fault) {
    case Fault::kMalformed: return "the arrays that describe the result do not fit together";
    case Fault::kMovedVertex:
      return "output vertex " + id +
             " is neither at the place of its input vertex nor declared as new, or has the same place as another "
             "vertex";
    case Fault::kForeignVertex: return "vertex " + id + " is used by the patch, but does not belong to it in the input";
    case Fault::kLostVertex: return "vertex " + id + " is gone, although it joins the patch to others";
    case Fault::kNoFaces: return "no faces are left";
    case Fault::kLostLoop: return "a boundary loop through vertex " + id + " is gone";
    case Fault::kBoundary:
      return "the faces at a boundary edge of vertex " + id + " are not those that the input has there";
    case Fault::kReplacedSpan:
      return "boundary vertices next to vertex " + id + " are too far from the edge that replaces them";
    case Fault::kDeviation: return "input and output are further apart than the tolerance";
    case Fault::kFacingAway: return "input face " + id + " faces away from the patch's normal";
    case Fault::kArea: return "the area has changed";
    case Fault::kZeroArea: return "output face " + id + " has no area";
    case Fault::kInverted: return "output face " + id + " is turned over";
    case Fault::kFrame: return "the plane coordinate system is not right-handed, orthonormal and on a grid";
    case Fault::kPlaneCoordinates:
      return "the plane coordinates of output face " + id + " are not the projections of its corners";
    case Fault::kNotDelaunay: return "an edge of output face " + id + " is not locally Delaunay";
    case Fault::kEuler: return "the Euler number has changed";
    case Fault::kOpened: return "the surface is closed in the input, but open in the output";
    case Fault::kVolume: return "the volume has changed by more than the distances between input and output explain";
    case Fault::kNewVertex: return "new vertex " + id + " is neither on one edge nor inside one patch";
    case Fault::kNewOffLine: return "new vertices next to vertex " + id + " are off their edge, or out of order";
    case Fault::kLockedBoundary: return "new vertex " + id + " is on a boundary that must not be split";
    case Fault::kUnlisted: return "output face " + id + " misses the goals, but is not listed in `unrefined`";
    case Fault::kListedInVain: return "output face " + id + " meets the goals, but is listed in `unrefined`";
    case Fault::kCertificate:
      return "output face " + id + " is listed in `unrefined` for a reason that does not apply to it";
    case Fault::kShortEdge: return "an edge that refinement made at vertex " + id + " is shorter than allowed";
    case Fault::kTooManyFaces: return "there are more faces than allowed";
    case Fault::kNewIntersection:
      return "output face " + id + " intersects another face, but their patches do not intersect in the input";
    case Fault::kSurface: return "the surface of the curved patch is not valid";
    case Fault::kCover: return "the curved patch covers its surface another number of times than its input does";
    case Fault::kUnexplained:
      return "the facets of the curved patch and the options do not explain how far it is from its input";
    case Fault::kPolygon: return "the triangles made of input polygon " + id + " do not cover it exactly once";
    case Fault::kCap:
      return "the face that closes a hole at input face " + id +
             " is not flat, is not bounded by the hole's rim, or meets other faces";
  }
  return {};
}

}  // namespace

void FoundFaults::add(PatchId patch, Fault fault, std::uint32_t element) {
  std::uint64_t& seen = patch.is_valid() ? of_patch_[patch.value] : of_whole_;
  if (seen & bit(fault)) return;
  seen |= bit(fault);
  faults_.push_back({patch, fault, element});
}

void FoundFaults::write_to(Verdict& verdict) const {
  std::uint64_t faults = of_whole_;
  for (std::size_t p = 0; p < of_patch_.size(); ++p) {
    faults |= of_patch_[p];
    if (of_patch_[p] != 0) verdict.failed_patches.push_back(PatchId(p));
  }
  verdict.surface = (faults & kAgainstSurface) == 0;
  verdict.conforming = (faults & kAgainstConforming) == 0;
  verdict.delaunay = (faults & kAgainstDelaunay) == 0;
  if (is_refined_) verdict.quality = (faults & kAgainstQuality) == 0;

  // Faults of the whole come first: their patch is invalid, which is the largest number, and adding 1 makes it
  // 0.
  std::vector<FoundFault> first(std::min(kMaxFailures, faults_.size()));
  const auto key = [](const FoundFault& f) { return std::tuple(f.patch.value + 1, f.fault); };
  std::partial_sort_copy(faults_.begin(), faults_.end(), first.begin(), first.end(),
                         [&](const FoundFault& a, const FoundFault& b) { return key(a) < key(b); });
  for (const FoundFault& f : first) {
    verdict.failures.push_back((f.patch.is_valid() ? "patch " + std::to_string(f.patch.value) + ": " : "") + words(f));
  }
}

}  // namespace remesh::verification
