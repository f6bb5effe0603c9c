/// The ladder: a patch that fails is cut up by tighter tolerances, and in the end into its input faces.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_reason.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/regions.h"

namespace remesh {

/// A patch whose triangulation or verification failed, and the reason.
struct FailedPatch {
  PatchId patch;
  PatchReason reason;
};

/// The state of the ladder. Rungs only rise, and vertices that are forced stay forced, so it ends.
/// Source: rules.md, Ladder.
class Ladder {
 public:
  /// Faces without area begin on the last rung: each is a patch of its own that is kept with its vertices. The surface
  /// must outlive the ladder.
  explicit Ladder(const Surface& surface, const std::vector<FaceId>& without_area = {});

  /// Takes every failed patch one rung up. Its faces lose their region. In new regions they may join each other, within
  /// a tighter tolerance, but no other faces. The vertices of the patch's boundary become essential. A patch of one
  /// face goes to the last rung at once, because no tolerance changes it.
  /// Returns: the faces of failed patches that are on the last rung already. Regions cannot help these faces any more,
  ///          so the caller has to change the surface.
  std::vector<FaceId> step(const PatchSet& patches, const BoundaryLoops& loops, const Adjacency& adjacency,
                           const std::vector<FailedPatch>& failed, Regions& regions);

  /// Returns the zone of each face. Faces may share a region only if they are in the same zone. At first the zone of a
  /// face is its label. Each patch that fails then gets a new zone for its faces. The result is empty if all faces are
  /// in one zone.
  const IdVector<FaceId, std::uint32_t>& zone() const { return zone_.empty() ? surface_.face_label : zone_; }
  const IdVector<FaceId, std::uint8_t>& rung() const { return rung_; }
  PatchReason reason(FaceId f) const { return reason_.empty() ? PatchReason::kNone : reason_[f]; }
  /// Returns whether a face was on the last rung from the beginning.
  bool is_kept(FaceId f) const { return !is_kept_.empty() && is_kept_[f] != 0; }
  IdVector<VertexId, std::uint8_t>& forced() { return forced_; }

 private:
  const Surface& surface_;
  IdVector<FaceId, std::uint32_t> zone_;  ///< equal to the surface's labels before the first step
  IdVector<FaceId, std::uint8_t> rung_;
  IdVector<FaceId, PatchReason> reason_;    ///< empty while no face has a reason
  IdVector<FaceId, std::uint8_t> is_kept_;  ///< empty if no face is kept
  IdVector<VertexId, std::uint8_t> forced_;
  std::uint32_t next_zone_ = 0;
  int steps_ = 0;
};

}  // namespace remesh
