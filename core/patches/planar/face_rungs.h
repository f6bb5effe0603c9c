/// The ladder: a patch that fails is cut up by tighter tolerances, and in the end into its faces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_reason.h"

namespace remesh {

/// A patch whose triangulation or verification failed, in input faces.
struct FailedFaces {
  std::vector<FaceId> faces;  ///< the input faces that the patch covers, ascending
  PatchReason reason = PatchReason::kNone;
  /// The patch is a single face of the surface. No tolerance can change it.
  bool is_single = false;
  /// The patch is a face without area, which is a patch of its own from the beginning.
  bool is_kept = false;
  bool operator==(const FailedFaces&) const = default;
};

/// The rungs of the ladder on which the input faces stand. Rungs only rise, so the ladder ends.
/// Source: rules.md, Ladder.
struct FaceRungs {
  /// The following have one entry per input face, and are empty as long as no patch has failed.
  std::vector<std::uint8_t> rung;
  /// Faces may share a patch only if they are in the same zone. Each patch that fails gets a zone of its own, from 1
  /// on; 0 is for all faces that have never failed.
  std::vector<std::uint32_t> zone;
  std::vector<PatchReason> reason;  ///< the first one of each face
  std::uint32_t zones = 0;          ///< the number of zones that were given out
  std::uint32_t steps = 0;          ///< how often patches were taken up
  bool operator==(const FaceRungs&) const = default;

  bool are_any() const { return !rung.empty(); }
};

/// Takes every failed patch one rung up. Its faces may join each other again, within a tighter tolerance, but no other
/// faces. A patch of one face goes to the last rung at once.
/// Input: `count` is the number of all input faces.
/// Cost:  O(faces).
FaceRungs one_rung_up(FaceRungs rungs, std::span<const FailedFaces> failed, std::size_t count);

/// Returns the faces of all failed patches if all are on the last rung already, and nothing otherwise. No rung helps
/// them any more, so the surface itself has to become another one.
std::optional<std::vector<FaceId>> exhausted_faces(const FaceRungs& rungs, std::span<const FailedFaces> failed);

/// The meaning of the input faces' rungs for the faces and vertices of a surface.
struct SurfaceRungs {
  /// Faces share a region only if they are in the same zone: zones come from labels and from failures. Empty if all
  /// faces are in one zone.
  IdVector<FaceId, std::uint32_t> zone;
  IdVector<FaceId, std::uint8_t> rung;
  IdVector<FaceId, PatchReason> reason;    ///< empty while no face has a reason
  IdVector<FaceId, std::uint8_t> is_kept;  ///< faces without area, which keep their vertices; empty if there is none
  IdVector<VertexId, std::uint8_t> is_forced;  ///< vertices that are essential whatever their place is

  SurfaceRungs() = default;
  /// Input: `without_area` lists faces that are patches of their own and keep their vertices. With `keeps_boundaries`,
  ///        all vertices are forced. Otherwise those at the rim of each failed patch are.
  SurfaceRungs(const Surface& surface, const Adjacency& adjacency, const std::vector<FaceId>& without_area,
               const FaceRungs& rungs, bool keeps_boundaries);

  PatchReason reason_of(FaceId f) const { return reason.empty() ? PatchReason::kNone : reason[f]; }
  bool is_face_kept(FaceId f) const { return !is_kept.empty() && is_kept[f] != 0; }
};

}  // namespace remesh
