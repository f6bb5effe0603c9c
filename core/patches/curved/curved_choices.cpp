#include "core/patches/curved/curved_choices.h"

#include <algorithm>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// After this many steps, curved patches that fail become facets without being tried with finer limits.
constexpr int kPatientSteps = 16;
/// After this many steps, all curved patches become facets. Parts were seen to take at most five steps, or 13 where
/// volumes are kept.
constexpr int kMaxSteps = 32;
constexpr int kMaxLeavings = 2;
constexpr int kMaxCorrections = 3;

}  // namespace

bool OffsetChoices::is_left(SurfaceId surface) const { return std::binary_search(left.begin(), left.end(), surface); }

bool OffsetChoices::is_better_estimate_worth_while() const { return corrections < kMaxCorrections; }

void OffsetChoices::take(const IdVector<SurfaceId, double>& better) {
  known.assign(better.size(), {});
  for (SurfaceId s(0); s.value < better.size(); ++s.value) known[s] = better[s];
  ++corrections;
}

void OffsetChoices::leave(std::span<const SurfaceId> surfaces, std::span<const SurfaceId> changed) {
  left.insert(left.end(), surfaces.begin(), surfaces.end());
  sort_unique(left);
  for (const std::span<const SurfaceId> some : {surfaces, changed})
    for (const SurfaceId s : some)
      if (s.value < known.size()) known[s].reset();
  corrections = std::min(corrections, kMaxCorrections - 1);
}

CurvedRung CurvedChoices::rung_of(std::span<const FaceId> covered) const {
  if (are_all_facets) return CurvedRung::kFacet;
  CurvedRung highest = CurvedRung::kJoined;
  if (!rung.empty())
    for (const FaceId f : covered) highest = std::max(highest, rung[f.value]);
  return highest;
}

bool CurvedChoices::may_leave_facets() const { return leavings < kMaxLeavings; }

CurvedChoices after_faults(CurvedChoices now, std::span<const CurvedFault> faults, bool is_patient, bool are_any_moved,
                           std::size_t count) {
  now.rung.resize(count, CurvedRung::kJoined);
  if (++now.steps > kMaxSteps) {
    now.are_all_facets = true;
    return now;
  }
  std::vector<SurfaceId> left, changed;
  for (const CurvedFault& fault : faults) {
    changed.push_back(fault.surface);
    const bool is_tightened = !is_patient || now.steps > kPatientSteps ||
                              std::any_of(fault.faces.begin(), fault.faces.end(),
                                          [&](FaceId f) { return now.rung[f.value] != CurvedRung::kJoined; });
    CurvedRung next = is_tightened ? CurvedRung::kFacet : CurvedRung::kTightened;
    // If finer limits did not help, the surface and those beside it stay where they are, and all begins anew there.
    if (is_tightened && are_any_moved && !fault.moved.empty()) {
      left.insert(left.end(), fault.moved.begin(), fault.moved.end());
      next = CurvedRung::kJoined;
    }
    for (const FaceId f : fault.faces) now.rung[f.value] = next;
  }
  if (are_any_moved) now.offsets.leave(left, changed);
  return now;
}

CurvedChoices after_comparison(CurvedChoices now, const CoarserFaces& faces, std::size_t count) {
  if (faces.are_compared) now.are_left_uncompared = false;
  if (!faces.are_any()) return now;
  now.rung.resize(count, CurvedRung::kJoined);
  for (const FaceId f : faces.finer) now.rung[f.value] = CurvedRung::kJoined;
  if (faces.coarser.empty()) return now;
  ++now.leavings;
  for (const FaceId f : faces.coarser) now.rung[f.value] = CurvedRung::kCoarser;
  for (const auto& [surface, triangles] : faces.allowed) {
    if (now.allowed.size() <= surface.value) now.allowed.resize(surface.value + 1);
    now.allowed[surface] = triangles;
  }
  now.are_left_uncompared = now.are_left_uncompared || !faces.allowed.empty();
  return now;
}

}  // namespace remesh
