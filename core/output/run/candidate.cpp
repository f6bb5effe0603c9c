#include "core/output/run/candidate.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/stoppable.h"
#include "core/mending/polygons/triangulated.h"
#include "core/refinement/adjustment/lifting.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/chords.h"
#include "core/refinement/rounds/rounds.h"
#include "core/verify/verify.h"

namespace remesh {
namespace {

void sort_pairs(std::vector<std::pair<PatchId, PatchId>>& pairs) { sort_unique(pairs); }

/// Finds the surface's own vertices that are somewhere else in the result.
std::vector<MovedVertex> find_moved(const Candidate& candidate, const Surface& surface) {
  std::vector<MovedVertex> moved;
  for (VertexId i(0); i.value < candidate.assembled.vertex.size(); ++i.value) {
    const VertexId v = candidate.assembled.vertex[i];
    if (v.value >= surface.vertex_count()) break;
    if (candidate.positions[i] != surface.positions[v]) moved.push_back({i, v});
  }
  return moved;
}

/// Returns whether a triangle had a reason that no longer counts because one of its vertices was moved.
bool has_lost_reason(const Candidate& candidate, FaceId f, std::span<const std::uint8_t> is_moved) {
  if (candidate.refinement.reason[f.value] != UnrefinedReason::kAcrossInputAngle) return false;
  const Triangle& face = candidate.assembled.faces[f];
  return std::any_of(face.begin(), face.end(),
                     [&](VertexId v) { return is_moved[candidate.assembled.vertex[v].value] != 0; });
}

}  // namespace

Candidate::~Candidate() { free_in_parallel(triangulated.meshes.items()); }

void Candidate::clear() {
  free_in_parallel(triangulated.meshes.items());
  has_chords = are_chords_flipped = false;
  forget_refinement();
}

void Candidate::flip_chords(std::size_t vertex_end, RunControl& control) {
  if (has_chords) return;
  const FlippedChords flipped = remesh::flip_chords(triangulated.meshes, vertex_end, control);
  has_chords = flipped.are_any_left;
  are_chords_flipped = are_chords_flipped || flipped.are_any;
}

void Candidate::undo_refinement() {
  refinement.before.exchange_with(triangulated.meshes);
  forget_refinement();
}

void Candidate::undo_assembly() {
  if (are_chords_flipped)
    clear();
  else
    forget_refinement();
}

void Candidate::forget_refinement() {
  refinement = {};
  assembled = {};
  positions.clear();
  unrefined = {};
  moved.clear();
}

void assemble(Candidate& candidate, const Surface& surface, const Goals* goals, RunControl& control) {
  const std::vector<Vec3>& made = candidate.refinement.new_positions;
  candidate.assembled = assembly(surface.vertex_count() + made.size(), candidate.triangulated.meshes, control);
  candidate.positions.clear();
  candidate.positions.reserve(candidate.assembled.vertex.size());
  StopCheck stop(control);
  auto moved = candidate.moved.begin();
  for (const VertexId v : candidate.assembled.vertex) {
    stop();
    while (moved != candidate.moved.end() && moved->first < v) ++moved;
    if (moved != candidate.moved.end() && moved->first == v)
      candidate.positions.push_back(moved->second);
    else
      candidate.positions.push_back(v.value < surface.vertex_count() ? surface.positions[v]
                                                                     : made[v.value - surface.vertex_count()]);
  }
  if (goals != nullptr) list_unrefined(candidate, *goals, control);
}

void list_unrefined(Candidate& candidate, const Goals& goals, RunControl& control) {
  candidate.unrefined = find_unrefined(candidate.positions.items(), candidate.assembled.faces.items(),
                                       candidate.refinement.reason, candidate.refinement.misses_sizes, goals, control);
}

bool has_worse_angles(Candidate& candidate, const Surface& surface, const Surface& with_cuts,
                      const CurvedPatches* curved, const Goals& goals, RunControl& control) {
  std::vector<VertexId> corners;
  StopCheck check(control);
  for (std::size_t i = 0; i < candidate.unrefined.faces.size(); ++i) {
    check();
    const UnrefinedReason reason = candidate.unrefined.reasons[i];
    const FaceId f = candidate.unrefined.faces[i];
    const bool is_by_floor = reason == UnrefinedReason::kMinEdgeLength || reason == UnrefinedReason::kSizeFloor;
    const bool is_curved = curved != nullptr && curved->of(candidate.assembled.face_patch[f]) != nullptr;
    if (is_by_floor && !is_curved)
      corners.insert(corners.end(), candidate.assembled.faces[f].begin(), candidate.assembled.faces[f].end());
  }
  const SmallAngles left = small_angles(candidate.positions.items(), corners, goals.min_angle_deg, control);
  if (left.count == 0) return false;
  SmallAngles before =
      small_angles(surface.positions.items(), Triangulated(surface, control).corners(), goals.min_angle_deg, control);
  if (!left.are_worse_than(before)) return false;
  candidate.refinement.before.exchange_with(candidate.triangulated.meshes);
  before.take_worse(
      small_angles(with_cuts.positions.items(), candidate.triangulated.corners(), goals.min_angle_deg, control));
  candidate.refinement.before.exchange_with(candidate.triangulated.meshes);
  return left.are_worse_than(before);
}

void replace_reasons(Candidate& candidate, std::span<const std::uint8_t> is_moved, UnrefinedReason reason) {
  std::vector<UnrefinedReason>& reasons = candidate.refinement.reason;
  const std::vector<FaceId>& missing = candidate.unrefined.faces;
  auto next = missing.begin();
  for (std::size_t t = 0; t < reasons.size(); ++t) {
    const bool is_missing = next != missing.end() && next->value == t;
    if (is_missing) ++next;
    if (!is_missing || has_lost_reason(candidate, FaceId(t), is_moved)) reasons[t] = reason;
  }
}

void assemble_again(Candidate& candidate, const Surface& surface, const Goals* goals,
                    std::span<const std::uint8_t> is_moved, UnrefinedReason reason, RunControl& control) {
  const std::vector<FaceId> missed_before = std::move(candidate.unrefined.faces);
  assemble(candidate, surface, goals, control);
  if (goals == nullptr) return;
  UnrefinedFaces& unrefined = candidate.unrefined;
  StopCheck check(control);
  auto next = missed_before.begin();
  for (std::size_t i = 0; i < unrefined.faces.size(); ++i) {
    check();
    const FaceId f = unrefined.faces[i];
    while (next != missed_before.end() && *next < f) ++next;
    const bool was_missing = next != missed_before.end() && *next == f;
    if (!was_missing || has_lost_reason(candidate, f, is_moved))
      unrefined.reasons[i] = candidate.refinement.reason[f.value] = reason;
  }
}

Verdict check(Candidate& candidate, const CheckedAgainst& against, RunControl& control) {
  // A triangle without a new vertex is kept if no vertex is moved.
  const ListedFrames listed = candidate.triangulated.charts.frames(
      [&](PatchId p) { return candidate.moved.empty() && candidate.triangulated.meshes[p].vertices.size() == 3; },
      control);
  const ClaimedFrames frames(listed.of_patch, listed.frames);
  std::optional<RefinementClaim> refined;
  if (against.goals != nullptr)
    refined = {*against.goals, candidate.unrefined.faces, candidate.unrefined.reasons, against.frozen};
  const std::vector<MovedVertex> moved = find_moved(candidate, against.surface);
  const bool has_new_vertices = !candidate.refinement.new_positions.empty() || against.curved != nullptr;
  const Claim claim{against.surface,
                    against.patches.of_face,
                    frames,
                    candidate.positions.items(),
                    candidate.assembled.faces.items(),
                    candidate.assembled.face_patch.items(),
                    candidate.assembled.corner_uv,
                    against.plane_tolerance,
                    has_new_vertices,
                    refined ? &*refined : nullptr,
                    &against.intersections,
                    against.edge_order,
                    against.input,
                    against.weld_tolerance,
                    against.curved != nullptr ? std::span<const std::uint32_t>(against.curved->at.items())
                                              : std::span<const std::uint32_t>(),
                    against.curved_claims,
                    moved};
  Verification verification(claim, control);
  if (refined && against.measure_sizes && !verification.has_failed()) {
    against.measure_sizes(candidate);
    list_unrefined(candidate, *against.goals, control);
    refined->unrefined = candidate.unrefined.faces;
    refined->reasons = candidate.unrefined.reasons;
  }
  return verification.finish();
}

void assemble_triangles(Candidate& candidate, const CheckedAgainst& against, Stopwatch& watch, RunControl& control) {
  watch.enter(Stage::kAssembly);
  TriangulatedPatches& triangulated = candidate.triangulated;
  Refinement& refinement = candidate.refinement;
  candidate.flip_chords(against.surface.vertex_count(), control);
  if (candidate.has_chords) {
    split_chords(against.surface, triangulated, refinement, {}, UnrefinedReason::kSizeFloor, control);
    lift_new_vertices(against.surface, against.patches, triangulated, refinement.first_inner, against.plane_tolerance,
                      refinement.new_positions, control);
  }
  assemble(candidate, against.surface, nullptr, control);
}

Verdict check_triangles(Candidate& candidate, const CheckedAgainst& against, Stopwatch& watch, RunControl& control) {
  assemble_triangles(candidate, against, watch, control);
  watch.enter(Stage::kVerify);
  return check(candidate, against, control);
}

InputIntersections intersecting_patches(const FoundIntersections& found, const PatchSet& patches) {
  InputIntersections known{{}, found.is_complete};
  for (const auto& [f, g] : found.pairs) known.patches.push_back(std::minmax({patches.of_face[f], patches.of_face[g]}));
  sort_pairs(known.patches);
  return known;
}

InputIntersections patches_that_still_intersect(InputIntersections of_input, const Verdict& verdict,
                                                const IdVector<FaceId, PatchId>& face_patch) {
  of_input.is_complete = verdict.are_all_intersections_known;
  // Without a full list, any of those of the input may still be there.
  if (!verdict.are_all_intersections_listed && of_input.is_complete) return of_input;
  std::erase_if(of_input.patches, [](const auto& pair) { return pair.first != pair.second; });
  for (const auto& [f, g] : verdict.intersections)
    of_input.patches.push_back(std::minmax({face_patch[f], face_patch[g]}));
  sort_pairs(of_input.patches);
  return of_input;
}

}  // namespace remesh
