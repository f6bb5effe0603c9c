#include "core/patches/curved/curved_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/patches/curved/curved_limits.h"
#include "core/patches/curved/torus_limits.h"
#include "core/patches/recognition/surface_recognition.h"

namespace remesh {
namespace {

/// After this many steps, curved patches that fail become facets without being tried with finer limits.
constexpr int kPatientSteps = 16;
/// After this many steps, all curved patches become facets. Parts were seen to take at most five steps, or 13 where
/// volumes are kept.
constexpr int kMaxSteps = 32;
/// So often facets are left because they are probably coarser. If refinement shows that they are not, they are joined
/// again. The patches beside them have finer boundaries then, and may be
/// the next ones.
constexpr int kMaxLeavings = 2;

/// Returns whether a patch reaches the apex of its cone, at which all rulings meet.
bool reaches_apex(const Surface& surface, const PatchSet& patches, PatchId p, const SurfaceMap& map, StopCheck& check) {
  if (map.shape().kind != SurfaceKind::kCone) return false;
  constexpr double kNearApex = 1e-3;
  double nearest = HUGE_VAL, farthest = 0;
  for (const FaceId f : patches.faces_of(p))
    for (const VertexId v : surface.face(f)) {
      check();
      const double radius = map.radius(surface.positions[v]);
      nearest = std::min(nearest, radius);
      farthest = std::max(farthest, radius);
    }
  return nearest < kNearApex * farthest;
}

/// Squeezes the maps of patches along their rulings. Without a bound on angles, edges may be as long as a patch there.
void squeeze_maps(const Surface& surface, const PatchSet& patches, CurvedPatches& joined, RunControl& control) {
  StopCheck check(control);
  for (std::size_t p = 0; p < joined.at.size(); ++p) {
    check();
    if (joined.at[PatchId(p)] == kNone) continue;
    SurfaceMap& map = joined.curved[joined.at[PatchId(p)]].map;
    if (!reaches_apex(surface, patches, PatchId(p), map, check)) map = map.squeezed();
  }
}

}  // namespace

double CurvedStage::finer_share(const CurvedGoals& goals) const {
  if (!goals.elements_per_circle) return 0;
  // Facets of one circle differ a little in their turns.
  constexpr double kAsFine = 1.02;
  const double turn_deg = 360 / *goals.elements_per_circle;
  double finer = 0, all = 0;
  for (const RecognisedSurface& surface : surfaces_.surfaces) {
    if (!(surface.allowed > 0)) continue;
    all += surface.area;
    if (surface.input_turn_deg > kAsFine * turn_deg) finer += surface.area;
  }
  return all > 0 ? finer / all : 0;
}

void CurvedStage::forget_joined() {
  curved_ = {};
  cuts_ = {};
  with_cuts_.reset();
  is_outside_ = false;
}

PatchSet CurvedStage::take_facets(Partition& partition) {
  return curved_.has_any() ? std::move(facets_) : std::move(partition.patches);
}

void CurvedStage::run(Partition& partition, const PatchSet& facets_before, Prepared& prepared, Ladder& ladder,
                      const Options& options, const CurvedGoals& goals, const Measures& measures, RunControl& control) {
  if (!recognised_.of_patch.empty())
    recognised_.follow(facets_before, partition.patches);
  else
    recognise(partition, prepared, options, measures.plane_tolerance, control);
  const Surface& surface = prepared.surface;
  std::vector<CurvedLimits> limits =
      curved_limits(surface, partition.patches, recognised_, goals, measures.plane_tolerance, control);
  fit_limits_of_tori({surface, partition.patches, recognised_, measures.plane_tolerance}, goals, limits, control);
  cuts_ = {};
  with_cuts_.reset();
  is_outside_ = false;
  const auto join = [&] {
    curved_ = join_curved_facets(surface, prepared.adjacency(control), partition.patches, recognised_,
                                 goals.feature_angle_deg, limits, rungs_, control);
    if (curved_.has_any())
      coarser_.count_facets(surface, prepared.adjacency(control), partition, curved_, measures.min_angle_deg, control);
  };
  join();
  if (curved_.has_any()) {
    const std::vector<SurfaceId> hopeless = coarser_.find_hopeless(curved_, goals, measures.in_proportion);
    for (const SurfaceId s : hopeless) limits[s.value] = {};
    if (!hopeless.empty()) join();
  }
  if (curved_.has_any()) {
    facets_ = take_joined_patches(partition, prepared, curved_, measures.plane_tolerance, ladder, control);
    coarser_.count_boundaries(prepared.adjacency(control), partition, curved_, nullptr, control);
    cut_boundaries(partition, prepared, ladder, goals, measures.min_angle_deg, control);
    coarser_.count_boundaries(prepared.adjacency(control), partition, curved_, &cuts_, control);
    if (goals.keeps_volume)
      is_outside_ = outside_.move_outside(
          {surface, prepared.adjacency(control), partition.patches, partition.loops, cuts_, ladder.forced()}, curved_,
          *with_cuts_, control);
    if (!goals.is_refined) squeeze_maps(surface, partition.patches, curved_, control);
  }
  tell_failures(partition);
  surfaces_ = (curved_.has_any() ? curved_.surfaces : recognised_).copy(control);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    RecognisedSurface& s = surfaces_.surfaces[SurfaceId(i)];
    s.allowed = limits[i].tolerance;
    s.is_remeshed = false;
    s.elements_per_circle.reset();
  }
  for (const CurvedPatch& patch : curved_.curved) {
    RecognisedSurface& s = surfaces_.surfaces[patch.surface];
    s.is_remeshed = true;
    s.elements_per_circle = goals.elements_of(s);
  }
}

/// Notes in the summaries which patches are finer than was asked for, or facets again, because curved patches failed.
void CurvedStage::tell_failures(Partition& partition) const {
  if (rungs_.empty()) return;
  for (std::size_t p = 0; p < partition.patches.count(); ++p) {
    const CurvedRung rung = rungs_[partition.patches.faces_of(PatchId(p))[0]];
    if (rung == CurvedRung::kJoined || rung == CurvedRung::kCoarser) continue;
    PatchSummary& summary = partition.summaries.patches[p];
    if (summary.status != PatchStatus::kRemeshed) continue;
    summary.status = PatchStatus::kReduced;
    summary.reason = PatchReason::kVerificationFailed;
  }
}

/// Finds what the facets were made from. They are those of the input, before the ladder has split any.
void CurvedStage::recognise(const Partition& partition, Prepared& prepared, const Options& options,
                            double plane_tolerance, RunControl& control) {
  const Surface& surface = prepared.surface;
  const Adjacency& adjacency = prepared.adjacency(control);
  std::optional<EssentialVertices> unforced;
  if (options.keep_boundary_vertices)
    unforced = essential_vertices(surface, adjacency, partition.loops,
                                  IdVector<VertexId, std::uint8_t>(surface.vertex_count(), 0),
                                  prepared.pinched(control), plane_tolerance / surface.unit, control);
  recognised_ =
      recognise_surfaces({surface, adjacency, partition.patches, partition.loops,
                          unforced ? *unforced : partition.essential, partition.summaries.patches},
                         {options.feature_angle_deg, kRecognitionTolerance * prepared.rounding_tolerance,
                          std::max(kPrintedSteps * prepared.printed_step, options.plane_tolerance.value_or(0))},
                         control);
}

/// Cuts the boundaries of curved patches anew. The new vertices follow those of the surface.
void CurvedStage::cut_boundaries(Partition& partition, Prepared& prepared, Ladder& ladder, const CurvedGoals& goals,
                                 double min_angle_deg, RunControl& control) {
  IdVector<PatchId, PatchSurface> surfaces(partition.patches.count());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const PatchId p(i);
    surfaces[p].plane = partition.patches.planes[p];
    if (const CurvedPatch* patch = curved_.of(p)) {
      surfaces[p] = {&patch->map.shape(),
                     {},
                     patch->limits.boundary_tolerance,
                     patch->limits.max_turn,
                     patch->limits.boundary_sideways,
                     patch->limits.max_height,
                     patch->area};
      surfaces[p].fit_tolerance = recognised_.surfaces[patch->surface].tolerance;
    }
    // If the number of elements decides, chords are as deep as it says, whatever the way along the surface is.
    if (!goals.may_have_elements()) surfaces[p].along = surfaces[p].sideways;
  }
  if (!goals.may_cut_boundaries) {
    // The boundary stays as it is, so curved patches are remeshed between its vertices.
    cuts_.essential = partition.essential;
    return;
  }
  // Two legs of a right angle enclose the smallest angle that is allowed.
  const double max_length_per_width =
      min_angle_deg > 0 ? 1 / std::tan(min_angle_deg * std::numbers::pi / 180) : HUGE_VAL;
  cuts_ = cut_curves({prepared.surface, prepared.adjacency(control), partition.patches, partition.loops,
                      partition.essential, ladder.forced(), prepared.pinched(control)},
                     surfaces,
                     {kRecognitionTolerance * prepared.rounding_tolerance,
                      goals.feature_angle_deg * std::numbers::pi / 180, max_length_per_width},
                     control);
  partition.essential = cuts_.essential;
  leave_room_for_boundaries();
  with_cuts_ = prepared.surface;
  with_cuts_->positions.change(
      [&](std::vector<Vec3>& all) { all.insert(all.end(), cuts_.positions.begin(), cuts_.positions.end()); });
  for (const Vec3& p : cuts_.positions) with_cuts_->local.push_back(with_cuts_->to_local(p));
}

/// Makes patches finer whose boundaries have moved along their surfaces. What is proven for a patch is the root of the
/// squares of this way and of its depth, and both have to stay within one tolerance.
void CurvedStage::leave_room_for_boundaries() {
  // The checker computes a way that is a little longer, as it is farther around outside of the surface.
  constexpr double kWay = 1.05, kRoom = 0.98, kMinShare = 0.5;
  // A shorter way than this part of the tolerance makes no difference.
  constexpr double kShortWay = 0.1;
  for (std::size_t p = 0; p < cuts_.sideways.size(); ++p) {
    if (curved_.at[PatchId(p)] == kNone) continue;
    CurvedPatch& patch = curved_.curved[curved_.at[PatchId(p)]];
    // The limits of tori know of this, because all circles of a torus move along it.
    if (patch.map.shape().kind == SurfaceKind::kTorus) continue;
    const double way = kWay * cuts_.sideways[PatchId(p)], tolerance = patch.limits.tolerance;
    if (way < kShortWay * tolerance || std::hypot(patch.limits.max_height, way) <= tolerance) continue;
    const double room = std::sqrt(std::max(0.0, tolerance * tolerance - way * way));
    patch.limits.max_height = std::max(kRoom * room, kMinShare * patch.limits.max_height);
  }
}

std::vector<PatchId> CurvedStage::at_fault(const std::vector<FailedPatch>& failed, const PatchSet& patches,
                                           const Surface& surface, const Adjacency& adjacency,
                                           const RunControl& control) const {
  std::vector<PatchId> found;
  if (!curved_.has_any()) return found;
  const auto add = [&](PatchId p) {
    if (curved_.of(p) != nullptr) found.push_back(p);
  };
  StopCheck check(control);
  for (const FailedPatch& patch : failed) {
    check();
    add(patch.patch);
    if (curved_.of(patch.patch) != nullptr) continue;
    for (const FaceId f : patches.faces_of(patch.patch))
      for (std::uint32_t h = surface.face_begin[f.value]; h < surface.face_begin[f.value + 1]; ++h)
        for (const std::uint32_t other : adjacency.half_edges(adjacency.edge_of(h))) {
          check();
          add(patches.of_face[adjacency.face_of(other)]);
        }
  }
  sort_stoppable(found.begin(), found.end(), control);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void CurvedStage::step_up(const std::vector<PatchId>& at_fault, const PatchSet& patches, bool is_patient) {
  rungs_.resize(patches.of_face.size(), CurvedRung::kJoined);
  ++steps_;
  if (steps_ > kMaxSteps) {
    for (std::size_t f = 0; f < patches.of_face.size(); ++f)
      if (curved_.of(patches.of_face[FaceId(f)]) != nullptr) rungs_[FaceId(f)] = CurvedRung::kFacet;
    return;
  }
  std::vector<SurfaceId> left, changed;
  for (const PatchId p : at_fault) {
    changed.push_back(curved_.of(p)->surface);
    const auto faces = patches.faces_of(p);
    const bool is_tightened =
        !is_patient || steps_ > kPatientSteps ||
        std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return rungs_[f] != CurvedRung::kJoined; });
    CurvedRung next = is_tightened ? CurvedRung::kFacet : CurvedRung::kTightened;
    // If finer limits did not help, the surface and those beside it stay where they are, and all begins anew there.
    if (is_tightened && is_outside_)
      if (const std::vector<SurfaceId> moved = outside_.moved_at(curved_.of(p)->surface); !moved.empty()) {
        left.insert(left.end(), moved.begin(), moved.end());
        next = CurvedRung::kJoined;
      }
    for (const FaceId f : faces) rungs_[f] = next;
  }
  if (!is_outside_) return;
  outside_.leave(left);
  outside_.forget(changed);
}

bool CurvedStage::leave_coarser_facets(const std::vector<std::uint64_t>& triangles, const PatchSet& patches,
                                       const CurvedGoals& goals) {
  const IdVector<PatchId, SurfaceId>& of_patch = curved_.has_any() ? curved_.surfaces.of_patch : recognised_.of_patch;
  const auto set_rung = [&](PatchId p, CurvedRung rung) {
    for (const FaceId f : patches.faces_of(p)) rungs_[f] = rung;
  };
  bool is_any = false;
  if (coarser_.is_any_left()) {
    std::vector<std::uint8_t> is_left;
    for (std::size_t p = 0; p < patches.count(); ++p)
      is_left.push_back(rungs_[patches.faces_of(PatchId(p)).front()] == CurvedRung::kCoarser ? 1 : 0);
    const std::vector<SurfaceId> finer = coarser_.find_finer(of_patch, triangles, is_left);
    for (PatchId p(0); p.value < is_left.size(); ++p.value)
      if (is_left[p.value] != 0 && std::binary_search(finer.begin(), finer.end(), of_patch[p])) {
        set_rung(p, CurvedRung::kJoined);
        is_any = true;
      }
  }
  if (!curved_.has_any() || leavings_ == kMaxLeavings) return is_any;
  const std::vector<PatchId> coarser = coarser_.find_coarser(curved_, triangles, goals);
  if (coarser.empty()) return is_any;
  ++leavings_;
  rungs_.resize(patches.of_face.size(), CurvedRung::kJoined);
  for (const PatchId p : coarser) set_rung(p, CurvedRung::kCoarser);
  return true;
}

std::vector<PatchId> CurvedStage::patches_of(const std::vector<SurfaceId>& surfaces) const {
  std::vector<PatchId> found;
  for (PatchId p(0); p.value < curved_.at.size(); ++p.value)
    if (const CurvedPatch* patch = curved_.of(p))
      if (std::find(surfaces.begin(), surfaces.end(), patch->surface) != surfaces.end()) found.push_back(p);
  return found;
}

std::optional<CurvedBoundaries> CurvedStage::boundaries() const {
  if (!curved_.has_any()) return std::nullopt;
  return CurvedBoundaries{curved_, cuts_};
}

}  // namespace remesh
