/// What happens to a patch that fails: it is cut up by tighter tolerances, at last into its input faces.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/patch_reason.h"
#include "core/geometry/patch_set.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/coplanar_regions.h"

namespace remesh {

/// A patch that failed, and why.
struct FailedPatch {
  PatchId patch;
  PatchReason reason;
};

/// The state of the ladder. Rungs only rise and forced vertices only grow in number, so it ends.
/// Source: rules.md, Ladder.
class Ladder {
 public:
  /// Faces without area begin on the last step: each is kept as it is, alone, with its vertices. The surface must
  /// outlive the ladder.
  explicit Ladder(const Surface& surface, const std::vector<FaceId>& without_area = {});

  /// Takes every failed patch one step up: its faces lose their region and may only join each other again, under the
  /// next tolerance; the vertices of its boundary become essential.
  /// Returns: the failed patches' faces that are on the last step already: for them the surface must change.
  std::vector<FaceId> step(const PatchSet& patches, const BoundaryLoops& loops, const Adjacency& adjacency,
                           const std::vector<FailedPatch>& failed, Regions& regions);

  /// Empty: none is kept apart.
  const IdVector<FaceId, std::uint32_t>& zone() const { return zone_.empty() ? surface_.face_label : zone_; }
  const IdVector<FaceId, std::uint8_t>& rung() const { return rung_; }
  PatchReason reason(FaceId f) const { return reason_.empty() ? PatchReason::kNone : reason_[f]; }
  /// On the last step from the beginning.
  bool is_kept(FaceId f) const { return !is_kept_.empty() && is_kept_[f] != 0; }
  IdVector<VertexId, std::uint8_t>& forced() { return forced_; }

 private:
  const Surface& surface_;
  IdVector<FaceId, std::uint32_t> zone_;  ///< as the surface's labels before the first step
  IdVector<FaceId, std::uint8_t> rung_;
  IdVector<FaceId, PatchReason> reason_;    ///< empty while no face has one
  IdVector<FaceId, std::uint8_t> is_kept_;  ///< empty where none is
  IdVector<VertexId, std::uint8_t> forced_;
  std::uint32_t next_zone_ = 0;
  int steps_ = 0;
};

}  // namespace remesh
