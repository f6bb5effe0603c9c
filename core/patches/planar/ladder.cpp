#include "core/patches/planar/ladder.h"

#include <algorithm>

namespace remesh {
namespace {

/// After this many rounds, a patch that fails goes to single faces at once. A chain of neighbours that fail one after
/// the other must not cost a round for each of its rungs.
constexpr int kPatientRounds = 6;

}  // namespace

Ladder::Ladder(const Surface& surface, const std::vector<FaceId>& without_area)
    : surface_(surface), rung_(surface.face_count(), 0), forced_(surface.vertex_count(), 0) {
  if (without_area.empty()) return;
  reason_.resize(surface.face_count(), PatchReason::kNone);
  is_kept_.resize(surface.face_count(), 0);
  for (const FaceId f : without_area) {
    is_kept_[f] = 1;
    rung_[f] = kSingleFace;
    reason_[f] = PatchReason::kNotPlanar;
    for (const VertexId v : surface.face(f)) forced_[v] = 1;
  }
}

std::vector<FaceId> Ladder::step(const PatchSet& patches, const BoundaryLoops& loops, const Adjacency& adjacency,
                                 const std::vector<FailedPatch>& failed, Regions& regions) {
  if (steps_++ == 0) {
    zone_ = surface_.face_label;
    if (zone_.empty()) zone_.assign(surface_.face_count(), 0);
    reason_.resize(surface_.face_count(), PatchReason::kNone);
    for (const std::uint32_t label : zone_) next_zone_ = std::max(next_zone_, label + 1);
  }
  std::vector<FaceId> stuck;
  for (const auto& [patch, reason] : failed) {
    for (std::uint32_t l = loops.patch_begin[patch.value]; l < loops.patch_begin[patch.value + 1]; ++l)
      for (const std::uint32_t h : loops.loop(l)) forced_[adjacency.from(h)] = 1;
    const bool is_single = patches.faces_of(patch).size() == 1;
    for (const FaceId f : patches.faces_of(patch)) {
      if (rung_[f] == kSingleFace) {
        stuck.push_back(f);
        continue;
      }
      rung_[f] = is_single || steps_ > kPatientRounds ? kSingleFace : static_cast<std::uint8_t>(rung_[f] + 1);
      zone_[f] = next_zone_;
      if (reason_[f] == PatchReason::kNone) reason_[f] = reason;
      regions.of_face[f] = RegionId();
    }
    ++next_zone_;
  }
  return stuck;
}

}  // namespace remesh
