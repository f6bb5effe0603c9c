#include "core/patches/planar/face_rungs.h"

#include <algorithm>

#include "core/patches/planar/coplanar_regions.h"

namespace remesh {
namespace {

/// After this many steps, a patch that fails goes to single faces at once. A chain of neighbours that fail one after
/// the other must not cost a step for each of its rungs.
constexpr std::uint32_t kPatientRungSteps = 6;

}  // namespace

FaceRungs one_rung_up(FaceRungs rungs, std::span<const FailedFaces> failed, std::size_t count) {
  rungs.rung.resize(count, 0);
  rungs.zone.resize(count, 0);
  rungs.reason.resize(count, PatchReason::kNone);
  ++rungs.steps;
  for (const FailedFaces& patch : failed) {
    const std::uint32_t zone = ++rungs.zones;
    for (const FaceId f : patch.faces) {
      std::uint8_t& rung = rungs.rung[f.value];
      if (rung < kSingleFace)
        rung = patch.is_single || rungs.steps > kPatientRungSteps ? kSingleFace : static_cast<std::uint8_t>(rung + 1);
      rungs.zone[f.value] = zone;
      if (rungs.reason[f.value] == PatchReason::kNone) rungs.reason[f.value] = patch.reason;
    }
  }
  return rungs;
}

std::optional<std::vector<FaceId>> exhausted_faces(const FaceRungs& rungs, std::span<const FailedFaces> failed) {
  const auto is_on_last = [&](FaceId f) { return rungs.are_any() && rungs.rung[f.value] == kSingleFace; };
  std::vector<FaceId> faces;
  for (const FailedFaces& patch : failed) {
    if (!patch.is_kept && !std::all_of(patch.faces.begin(), patch.faces.end(), is_on_last)) return std::nullopt;
    faces.insert(faces.end(), patch.faces.begin(), patch.faces.end());
  }
  return faces;
}

SurfaceRungs::SurfaceRungs(const Surface& surface, const Adjacency& adjacency, const std::vector<FaceId>& without_area,
                           const FaceRungs& rungs, bool keeps_boundaries)
    : zone(surface.face_label),
      rung(surface.face_count(), 0),
      is_forced(surface.vertex_count(), keeps_boundaries ? 1 : 0) {
  if (rungs.are_any()) {
    std::uint32_t labels = 0;
    for (const std::uint32_t label : surface.face_label) labels = std::max(labels, label);
    if (zone.empty()) zone.assign(surface.face_count(), 0);
    reason.resize(surface.face_count(), PatchReason::kNone);
    for (FaceId f(0); f.value < surface.face_count(); ++f.value) {
      // The highest rung of the input faces that a face covers counts, and the zone of the last failure.
      std::uint32_t last = 0;
      for (const FaceId source : surface.covered(f)) {
        rung[f] = std::max(rung[f], rungs.rung[source.value]);
        last = std::max(last, rungs.zone[source.value]);
        if (reason[f] == PatchReason::kNone) reason[f] = rungs.reason[source.value];
      }
      if (last != 0) zone[f] = labels + last;
    }
    for (FaceId f(0); f.value < surface.face_count(); ++f.value)
      for (std::uint32_t h = surface.face_begin[f.value]; zone[f] > labels && h < surface.face_begin[f.value + 1];
           ++h) {
        const std::uint32_t twin = adjacency.twin(h);
        if (twin != kNone && zone[adjacency.face_of(twin)] == zone[f]) continue;
        is_forced[adjacency.from(h)] = is_forced[adjacency.to(h)] = 1;
      }
  }
  if (without_area.empty()) return;
  reason.resize(surface.face_count(), PatchReason::kNone);
  is_kept.resize(surface.face_count(), 0);
  for (const FaceId f : without_area) {
    is_kept[f] = 1;
    rung[f] = kSingleFace;
    reason[f] = PatchReason::kNotPlanar;
    for (const VertexId v : surface.face(f)) is_forced[v] = 1;
  }
}

}  // namespace remesh
