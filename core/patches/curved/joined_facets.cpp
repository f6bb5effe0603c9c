#include "core/patches/curved/joined_facets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/mesh/face_marks.h"
#include "core/patches/curved/curved_limits.h"
#include "core/patches/curved/torus_limits.h"
#include "core/patches/recognition/surface_recognition.h"

namespace remesh {
namespace {

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

/// Joins the facets of one partition.
class FacetJoiner {
 public:
  FacetJoiner(Partition& partition, Prepared& prepared, const RecognisedSurfaces& recognised, const SurfaceRungs& rungs,
              const CurvedChoices& choices, const CurvedGoals& goals, const JoiningMeasures& measures,
              RunControl& control)
      : partition_(partition),
        prepared_(prepared),
        recognised_(recognised),
        rungs_(rungs),
        choices_(choices),
        goals_(goals),
        measures_(measures),
        control_(control) {}

  JoinedFacets run() {
    const Surface& surface = prepared_.surface();
    if (choices_.are_any())
      for (FaceId f(0); f.value < surface.face_count(); ++f.value)
        curved_rungs_.push_back(choices_.rung_of(surface.covered(f)));
    std::vector<CurvedLimits> limits =
        curved_limits(surface, partition_.patches, recognised_, goals_, measures_.plane_tolerance, control_);
    fit_limits_of_tori({surface, partition_.patches, recognised_, measures_.plane_tolerance}, goals_, limits, control_);
    join(limits);
    if (curved().has_any()) {
      const std::vector<SurfaceId> hopeless = joined_.costs.find_hopeless(curved(), goals_, measures_.in_proportion);
      for (const SurfaceId s : hopeless) limits[s.value] = {};
      if (!hopeless.empty()) join(limits);
    }
    if (curved().has_any()) {
      joined_.facets =
          take_joined_patches(partition_, prepared_, curved(), measures_.plane_tolerance, rungs_, control_);
      joined_.costs.count_boundaries(adjacency(), partition_, curved(), nullptr, control_);
      cut_boundaries();
      joined_.costs.count_boundaries(adjacency(), partition_, curved(), &joined_.cuts, control_);
      if (goals_.keeps_volume) move_outside();
      if (!goals_.is_refined) squeeze_maps(surface, partition_.patches, curved(), control_);
    }
    report_failures();
    report_limits(limits);
    return std::move(joined_);
  }

 private:
  CurvedPatches& curved() { return joined_.patches; }
  const Adjacency& adjacency() { return prepared_.adjacency(control_); }

  void join(std::span<const CurvedLimits> limits) {
    const Surface& surface = prepared_.surface();
    curved() = join_curved_facets(surface, adjacency(), partition_.patches, recognised_, goals_.feature_angle_deg,
                                  limits, curved_rungs_, control_);
    if (curved().has_any())
      joined_.costs.count_facets(surface, adjacency(), partition_, curved(), measures_.min_angle_deg, control_);
  }

  void move_outside() {
    joined_.outside.emplace();
    const bool are_any_moved = joined_.outside->move_outside(
        {prepared_.surface(), adjacency(), partition_.patches, partition_.loops, joined_.cuts, rungs_.is_forced},
        choices_.offsets, curved(), *joined_.with_cuts, control_);
    if (!are_any_moved) joined_.outside.reset();
  }

  /// Cuts the boundaries of curved patches anew. The new vertices follow those of the surface.
  void cut_boundaries() {
    IdVector<PatchId, PatchSurface> surfaces(partition_.patches.count());
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const PatchId p(i);
      surfaces[p].plane = partition_.patches.planes[p];
      if (const CurvedPatch* patch = curved().of(p)) {
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
      if (!goals_.may_have_elements()) surfaces[p].along = surfaces[p].sideways;
    }
    if (!goals_.may_cut_boundaries) {
      // The boundary stays as it is, so curved patches are remeshed between its vertices.
      joined_.cuts.essential = partition_.essential;
      return;
    }
    // Two legs of a right angle enclose the smallest angle that is allowed.
    const double max_length_per_width =
        measures_.min_angle_deg > 0 ? 1 / std::tan(measures_.min_angle_deg * std::numbers::pi / 180) : HUGE_VAL;
    joined_.cuts = cut_curves({prepared_.surface(), prepared_.adjacency(control_), partition_.patches, partition_.loops,
                               partition_.essential, rungs_.is_forced, prepared_.pinched(control_)},
                              surfaces,
                              {kRecognitionTolerance * prepared_.rounding_tolerance,
                               goals_.feature_angle_deg * std::numbers::pi / 180, max_length_per_width},
                              control_);
    partition_.essential = joined_.cuts.essential;
    leave_room_for_boundaries();
    joined_.with_cuts = prepared_.surface();
    joined_.with_cuts->positions.change([&](std::vector<Vec3>& all) {
      all.insert(all.end(), joined_.cuts.positions.begin(), joined_.cuts.positions.end());
    });
    for (const Vec3& p : joined_.cuts.positions) joined_.with_cuts->local.push_back(joined_.with_cuts->to_local(p));
  }

  /// Makes patches finer whose boundaries have moved along their surfaces. What is proven for a patch is the root of
  /// the squares of this way and of its depth, and both have to stay within one tolerance.
  void leave_room_for_boundaries() {
    // The checker computes a way that is a little longer, as it is farther around outside of the surface.
    constexpr double kWay = 1.05, kRoom = 0.98, kMinShare = 0.5;
    // A shorter way than this part of the tolerance makes no difference.
    constexpr double kShortWay = 0.1;
    for (std::size_t p = 0; p < joined_.cuts.sideways.size(); ++p) {
      if (curved().at[PatchId(p)] == kNone) continue;
      CurvedPatch& patch = curved().curved[curved().at[PatchId(p)]];
      // The limits of a torus allow for this way already, because each circle on a torus moves along the torus.
      if (patch.map.shape().kind == SurfaceKind::kTorus) continue;
      const double way = kWay * joined_.cuts.sideways[PatchId(p)], tolerance = patch.limits.tolerance;
      if (way < kShortWay * tolerance || std::hypot(patch.limits.max_height, way) <= tolerance) continue;
      const double room = std::sqrt(std::max(0.0, tolerance * tolerance - way * way));
      patch.limits.max_height = std::max(kRoom * room, kMinShare * patch.limits.max_height);
    }
  }

  /// Notes in the summaries which patches are finer than was asked for, or facets again, because curved patches failed.
  void report_failures() {
    if (curved_rungs_.empty()) return;
    for (std::size_t p = 0; p < partition_.patches.count(); ++p) {
      const CurvedRung rung = curved_rungs_[partition_.patches.faces_of(PatchId(p))[0]];
      if (rung == CurvedRung::kJoined || rung == CurvedRung::kCoarser) continue;
      PatchSummary& summary = partition_.summaries.patches[p];
      if (summary.status != PatchStatus::kRemeshed) continue;
      summary.status = PatchStatus::kReduced;
      summary.reason = PatchReason::kVerificationFailed;
    }
  }

  void report_limits(std::span<const CurvedLimits> limits) {
    joined_.surfaces = (curved().has_any() ? curved().surfaces : recognised_).copy(control_);
    for (std::size_t i = 0; i < limits.size(); ++i) {
      RecognisedSurface& s = joined_.surfaces.surfaces[SurfaceId(i)];
      s.allowed = limits[i].tolerance;
      s.is_remeshed = false;
      s.elements_per_circle.reset();
    }
    for (const CurvedPatch& patch : curved().curved) {
      RecognisedSurface& s = joined_.surfaces.surfaces[patch.surface];
      s.is_remeshed = true;
      s.elements_per_circle = goals_.elements_of(s);
    }
  }

  Partition& partition_;
  Prepared& prepared_;
  const RecognisedSurfaces& recognised_;
  const SurfaceRungs& rungs_;
  const CurvedChoices& choices_;
  const CurvedGoals& goals_;
  const JoiningMeasures& measures_;
  RunControl& control_;
  IdVector<FaceId, CurvedRung> curved_rungs_;  ///< one per face of the surface; empty as long as all are joined
  JoinedFacets joined_;
};

}  // namespace

RecognisedSurfaces recognise_facets(const Partition& partition, Prepared& prepared, const Options& options,
                                    double plane_tolerance, RunControl& control) {
  const Surface& surface = prepared.surface();
  const Adjacency& adjacency = prepared.adjacency(control);
  std::optional<EssentialVertices> unforced;
  if (options.keep_boundary_vertices)
    unforced = essential_vertices(surface, adjacency, partition.loops,
                                  IdVector<VertexId, std::uint8_t>(surface.vertex_count(), 0),
                                  prepared.pinched(control), plane_tolerance / surface.unit, control);
  return recognise_surfaces({surface, adjacency, partition.patches, partition.loops,
                             unforced ? *unforced : partition.essential, partition.summaries.patches},
                            {options.feature_angle_deg, kRecognitionTolerance * prepared.rounding_tolerance,
                             std::max(kPrintedSteps * prepared.printed_step, options.plane_tolerance.value_or(0))},
                            control);
}

JoinedFacets join_facets(Partition& partition, Prepared& prepared, const RecognisedSurfaces& recognised,
                         const SurfaceRungs& rungs, const CurvedChoices& choices, const CurvedGoals& goals,
                         const JoiningMeasures& measures, RunControl& control) {
  return FacetJoiner(partition, prepared, recognised, rungs, choices, goals, measures, control).run();
}

std::optional<CurvedBoundaries> JoinedFacets::boundaries() const {
  if (!patches.has_any()) return std::nullopt;
  return CurvedBoundaries{patches, cuts};
}

double JoinedFacets::finer_share(const CurvedGoals& goals) const {
  if (!goals.elements_per_circle) return 0;
  // Facets of one circle differ a little in their turns.
  constexpr double kAsFine = 1.02;
  const double turn_deg = 360 / *goals.elements_per_circle;
  double finer = 0, all = 0;
  for (const RecognisedSurface& surface : surfaces.surfaces) {
    if (!(surface.allowed > 0)) continue;
    all += surface.area;
    if (surface.input_turn_deg > kAsFine * turn_deg) finer += surface.area;
  }
  return all > 0 ? finer / all : 0;
}

std::vector<CurvedFault> JoinedFacets::faults(const std::vector<FailedPatch>& failed, const PatchSet& of,
                                              const Surface& surface, const Adjacency& adjacency,
                                              const RunControl& control) const {
  std::vector<PatchId> found;
  if (!patches.has_any()) return {};
  const auto add = [&](PatchId p) {
    if (patches.of(p) != nullptr) found.push_back(p);
  };
  StopCheck check(control);
  for (const FailedPatch& patch : failed) {
    check();
    add(patch.patch);
    if (patches.of(patch.patch) != nullptr) continue;
    for (const FaceId f : of.faces_of(patch.patch))
      for (std::uint32_t h = surface.face_begin[f.value]; h < surface.face_begin[f.value + 1]; ++h)
        for (const std::uint32_t other : adjacency.half_edges(adjacency.edge_of(h))) {
          check();
          add(of.of_face[adjacency.face_of(other)]);
        }
  }
  sort_unique(found, control);
  return faults_at(found, of, surface);
}

std::vector<CurvedFault> JoinedFacets::faults_of(std::span<const SurfaceId> some, const PatchSet& of,
                                                 const Surface& surface) const {
  std::vector<PatchId> found;
  for (PatchId p(0); p.value < patches.at.size(); ++p.value)
    if (const CurvedPatch* const patch = patches.of(p))
      if (std::find(some.begin(), some.end(), patch->surface) != some.end()) found.push_back(p);
  return faults_at(found, of, surface);
}

std::vector<CurvedFault> JoinedFacets::faults_at(std::span<const PatchId> curved, const PatchSet& of,
                                                 const Surface& surface) const {
  // Many patches may belong to one surface, and to look for those beside it takes time.
  std::map<SurfaceId, std::vector<SurfaceId>> moved;
  std::vector<CurvedFault> faults;
  for (const PatchId p : curved) {
    const SurfaceId s = patches.of(p)->surface;
    if (outside && moved.count(s) == 0) moved[s] = outside->moved_at(s);
    faults.push_back({covered_by(surface, of.faces_of(p)), s, moved[s]});
  }
  return faults;
}

CoarserFaces JoinedFacets::compare(const std::vector<std::uint64_t>& triangles, const PatchSet& of,
                                   const Surface& surface, const IdVector<PatchId, SurfaceId>& of_patch,
                                   const CurvedChoices& choices, const CurvedGoals& goals) const {
  CoarserFaces found;
  const auto add = [&](PatchId p, std::vector<FaceId>& faces) {
    const std::vector<FaceId> covered = covered_by(surface, of.faces_of(p));
    faces.insert(faces.end(), covered.begin(), covered.end());
  };
  if (choices.are_left_uncompared) {
    found.are_compared = true;
    std::vector<std::uint8_t> is_left;
    for (std::size_t p = 0; p < of.count(); ++p) {
      const FaceId first = of.faces_of(PatchId(p)).front();
      is_left.push_back(choices.rung_of(surface.covered(first)) == CurvedRung::kCoarser ? 1 : 0);
    }
    const std::vector<SurfaceId> finer = find_finer(of_patch, triangles, is_left, choices.allowed);
    for (PatchId p(0); p.value < is_left.size(); ++p.value)
      if (is_left[p.value] != 0 && std::binary_search(finer.begin(), finer.end(), of_patch[p])) add(p, found.finer);
  }
  if (!patches.has_any() || !choices.may_leave_facets()) return found;
  CoarserFacets::Coarser coarser = costs.find_coarser(patches, triangles, choices.allowed, goals);
  for (const PatchId p : coarser.patches) add(p, found.coarser);
  found.allowed = std::move(coarser.allowed);
  return found;
}

}  // namespace remesh
