#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "core/base/rounded_to_float.h"
#include "core/base/stoppable.h"
#include "core/base/work_bound.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mending/preparation.h"
#include "core/mending/weld/resolution.h"
#include "core/mesh/adjacency.h"
#include "core/output/report/report.h"
#include "core/output/run/candidate.h"
#include "core/output/run/run_report.h"
#include "core/output/run/run_state.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patch_types/patch_reason.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/curved/curved_stage.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/patches/planar/coplanar_regions.h"
#include "core/patches/planar/input_intersections.h"
#include "core/patches/planar/ladder.h"
#include "core/refinement/adjustment/lifting.h"
#include "core/refinement/adjustment/separation.h"
#include "core/refinement/adjustment/volume_fit.h"
#include "core/refinement/attempts/goal_refinement.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/chords.h"
#include "core/refinement/rounds/rounds.h"

namespace remesh {
namespace {

/// The outcome of an attempt at the surface.
enum class AttemptOutcome {
  kVerified,          ///< the result passed verification
  kTooManyFaces,      ///< refinement made more faces than are allowed
  kFacetsCoarser,     ///< facets of curved surfaces stay, or are joined again, by what has fewer faces
  kOffsetsChanged,    ///< curved surfaces have to be moved by other offsets
  kRefinementFailed,  ///< the check failed on patches whose refinement can be left out
  kRestUnrefined,     ///< without any refinement, the result passed verification
  kPatchesFailed,     ///< some patches have no triangles, or the check failed on them
  kFacesFailed,       ///< patches failed that are single faces already
};

/// The step at which the next attempt begins. The results of earlier steps of the pipeline are used again.
enum class Step { kPrepare, kPartition, kTriangulate, kRefine, kFinish };

/// The table of what is tried after each outcome. A decision (in GoalRefinement, Ladder or MendingLimits) holds for all
/// later attempts, and each of the three can make only a limited number of decisions, so this ends.
struct Retry {
  AttemptOutcome outcome;
  Step next;
};
constexpr std::array kRetries{
    Retry{AttemptOutcome::kVerified, Step::kFinish},
    // Refine again with a smaller budget. The patches and their triangles are used again.
    Retry{AttemptOutcome::kTooManyFaces, Step::kRefine},
    // Join the facets again, apart from those that stay.
    Retry{AttemptOutcome::kFacetsCoarser, Step::kPartition},
    // Join the facets again, and move the curved surfaces outwards by better offsets, or not at all.
    Retry{AttemptOutcome::kOffsetsChanged, Step::kPartition},
    // Refine again, but leave the patches that failed as they are. The patches and their triangles are used again.
    Retry{AttemptOutcome::kRefinementFailed, Step::kRefine},
    // Refine the patches that have never failed. The result without any refinement is right.
    Retry{AttemptOutcome::kRestUnrefined, Step::kRefine},
    // Split the patches that failed under a tighter tolerance, in the end into single faces (Ladder). The prepared
    // surface is used again, and so are the regions of all other faces.
    Retry{AttemptOutcome::kPatchesFailed, Step::kPartition},
    // Mend again, but copy the faces that failed verbatim. Nothing is used again but that decision.
    Retry{AttemptOutcome::kFacesFailed, Step::kPrepare},
};

Step step_after(AttemptOutcome outcome) {
  return std::find_if(kRetries.begin(), kRetries.end(), [&](const Retry& r) { return r.outcome == outcome; })->next;
}

/// Faces of curved surfaces are asked for, whatever they are in proportion to, if more than this share of them is to be
/// finer than its facets.
constexpr double kMajority = 0.5;

/// The last correction of offsets changes angles by less than this, in degrees, in nearly all triangles.
constexpr double kAngleMarginOfFit = 0.1;

/// Returns the number of faces for the bounds on memory. Polygons count as their triangles, and three vertices count as
/// a face, whether or not a face has them.
template <class Polygons>
std::uint64_t counted_faces(const Polygons& mesh) {
  return std::max(mesh.corners.size() - 2 * mesh.face_count(), mesh.vertex_count() / 3 + 1);
}

/// Returns what is claimed of the curved patches, in their order. There are none if `curved` is null.
std::vector<CurvedClaim> claims_of(const CurvedPatches* curved, const CurvedGoals& goals) {
  std::vector<CurvedClaim> claims;
  if (curved == nullptr) return claims;
  for (const CurvedPatch& patch : curved->curved) {
    const RecognisedSurface& surface = curved->surfaces.surfaces[patch.surface];
    claims.push_back(
        {surface.shape, patch.limits.tolerance, goals.tolerance, goals.elements_of(surface), goals.feature_angle_deg});
  }
  return claims;
}

/// One run on one surface.
/// This class is larger than the bound because it has a short function for each step of the pipeline, so that the whole
/// can be read in one place.
class Run : private RunState {
 public:
  Run(const PolygonMesh& input, const Options& options, Storage storage, RunControl& control,
      std::vector<Diagnostic> diagnostics)
      : RunState(input, options, control), diagnostics_of_reader_(std::move(diagnostics)), storage_(storage) {}

  Result remesh(const RunSettings& settings) {
    for (Step step = Step::kPrepare; step != Step::kFinish; step = step_after(attempt())) {
      // Weld, choose the tolerance, mend.
      if (step == Step::kPrepare) prepare();
      // Sections 2 to 4 of the 2018 report: find coplanar faces, their patches, edge loops and essential vertices.
      if (step <= Step::kPartition) find_patches();
      // Section 5, for every patch: projection, lexicographic triangulation, flips, recovery of the loops, carving.
      // Vertices that were moved to keep a volume have changed the triangles.
      if (step <= Step::kTriangulate || curves.outside() != nullptr)
        triangulate();
      else
        candidate.undo_refinement();
    }
    report_remeshing(*this);
    return make_result(*this, settings);
  }

  Report analyze() {
    prepare();
    find_patches();
    triangulate();
    report_analysis(*this);
    return std::move(report);
  }

 private:
  void prepare() {
    // Nothing of the last attempt is needed any more.
    const AttemptEffort::Taken taken = refiner ? refiner->work_taken() : AttemptEffort::Taken();
    const double floor = refiner ? refiner->goals().min_edge_length : 0;
    refiner.reset();
    candidate.clear();
    control.memory().set_input(counted_faces(input));
    InputSummary summary;
    summary.diagnostics = diagnostics_of_reader_;
    prepared = remesh::prepare(input, options, limits_, summary, watch, control);
    // Polygons have got new corners where vertices lay on their edges.
    control.memory().set_input(std::max(counted_faces(input), counted_faces(surface())));
    report.input = std::move(summary.statistics);
    report.plane_tolerance = report.first_plane_tolerance = summary.plane_tolerance;
    report.plane_tolerance_is_automatic = summary.plane_tolerance_is_automatic;
    report.rounding_step = summary.rounding_step;
    report.diagnostics = std::move(summary.diagnostics);
    const double diagonal = report.input.bounding_box.diagonal();
    check_options(options, diagonal);
    curved_goals_ = curved_goals_of(options, diagonal);
    details.reset(options, report.plane_tolerance);
    refiner.emplace(goals_in_proportion(), control, taken, floor);
    regions_ = {};
    ladder_.emplace(surface(), prepared.without_area);
    if (options.keep_boundary_vertices) ladder_->forced().assign(surface().vertex_count(), 1);
    input_intersections.reset();
    curves.reset();
  }

  Goals goals_in_proportion() const {
    const double diagonal = report.input.bounding_box.diagonal();
    Goals goals = goals_of(options, diagonal);
    keep_in_proportion(goals, options, diagonal, triangles_of_input());
    if (storage_ == Storage::kFloat) keep_apart_in_storage(goals, options, step_of_storage());
    return goals;
  }

  /// Returns the distance between floats at the part's largest coordinate, or at the largest from an origin near it.
  double step_of_storage() const {
    const Box3& box = report.input.bounding_box;
    if (box.is_empty()) return 0;
    const double largest = std::max(largest_coordinate(box.min), largest_coordinate(box.max));
    const double longest = largest_coordinate(box.max - box.min);
    return step_of_floats(options.local_origin ? std::min(largest, longest) : largest);
  }

  void find_patches() {
    candidate.clear();
    const PatchSet before = curves.take_facets(partition);
    divide();
    while (details.is_wanted() && remove_details()) divide();
    // Beyond the 2018 report: find curved surfaces, and join their facets as far as that is asked for.
    watch.enter(Stage::kSurfaces);
    if (curved_goals_.tolerance || curved_goals_.may_have_elements())
      control.memory().set_output(options.max_output_faces.value_or(MemoryBound::kNone));
    curves.run(partition, before, prepared, *ladder_, options, curved_goals_,
               {report.plane_tolerance, options.refine ? refiner->goals().min_angle_deg : 0,
                refiner->goals().faces_without_floor},
               control);
    refiner->set_curved(curves.curved() != nullptr, curves.finer_share(curved_goals_) > kMajority);
    refiner->set_angle_margin(curves.outside() != nullptr ? kAngleMarginOfFit : 0);
    report.surfaces = curves.take_surfaces();
    freeze_marked(stays_frozen_);
  }

  void divide() {
    partition = make_partition(prepared, report.plane_tolerance, options, *ladder_, regions_, watch, control);
  }

  /// Looks for details in the triangles of the patches, before facets are joined, and makes the triangles without them
  /// the surface.
  /// Output: false if all stays as it is.
  bool remove_details() {
    // It is still needed which curved patches have failed, if nothing is removed.
    curves.forget_joined();
    triangulate();
    // The ladder comes first, and changes the patches.
    if (!find_failed_patches(candidate.triangulated.meshes).empty()) return false;
    if (!details.are_there(candidate.triangulated, surface(), adjacency(), control)) {
      details.stop();
      return false;
    }
    if (!input_intersections) find_input_intersections(Triangulated(surface(), control));
    if (!details.run({input, partition.patches, intersections(), report.plane_tolerance, options.weld_tolerance,
                      limits_.keep_verbatim},
                     candidate, prepared, watch, control))
      return false;
    control.memory().set_input(std::max(counted_faces(input), counted_faces(surface())));
    report.plane_tolerance = details.plane_tolerance();
    curves.reset();
    regions_ = {};
    ladder_.emplace(surface(), prepared.without_area);
    if (options.keep_boundary_vertices) ladder_->forced().assign(surface().vertex_count(), 1);
    input_intersections.reset();
    return true;
  }

  void triangulate() {
    watch.enter(Stage::kTriangulation);
    candidate.clear();
    const std::optional<CurvedBoundaries> boundaries = curves.boundaries();
    candidate.triangulated = mesh_patches(with_cuts(), adjacency(), partition.patches, partition.loops,
                                          partition.essential, {options.reference_axis, options.reference_direction},
                                          control, boundaries ? &*boundaries : nullptr);
    count_output();
  }

  /// Goes from the patches' triangles to a verdict.
  AttemptOutcome attempt() {
    if (!input_intersections) find_input_intersections(Triangulated(surface(), control));
    refiner->begin_attempt();
    watch.enter(Stage::kAssembly);
    std::vector<FailedPatch> failed = find_failed_patches(candidate.triangulated.meshes);
    if (!failed.empty()) return step_up(failed);
    // No edge inside a patch may be the edge of another patch. (If refinement is tried again, this changes nothing.)
    if (!candidate.has_chords)
      candidate.has_chords = !flip_chords(candidate.triangulated.meshes, with_cuts().vertex_count(), control);
    // All patches together: improve angles and sizes, and resolve the remaining conflicts between patches.
    refine();
    if (leave_coarser_facets()) {
      refiner->forget_attempt();
      return AttemptOutcome::kFacetsCoarser;
    }
    if (!keep_volumes()) {
      // The patches may be others after this. What is known of these must not be taken for theirs.
      refiner->forget_patches();
      return AttemptOutcome::kOffsetsChanged;
    }
    watch.enter(Stage::kAssembly);
    assemble(candidate, with_cuts(), asked_goals(), control);
    const bool are_angles_worse =
        refiner->has_found_floor() &&
        has_worse_angles(candidate, surface(), with_cuts(), curves.curved(), refiner->goals(), control);
    if (refiner->is_over_budget(candidate.assembled.faces.size(), are_angles_worse))
      return AttemptOutcome::kTooManyFaces;
    refuse_if_too_large();
    check_candidate();
    if (report.verified.all_true()) {
      if (!refiner->goes_on_with_the_rest()) return AttemptOutcome::kVerified;
      freeze_marked(has_failed_);
      return AttemptOutcome::kRestUnrefined;
    }
    mark_faces(report.verified.failed_patches, has_failed_);
    for (const PatchId p : report.verified.failed_patches) failed.push_back({p, PatchReason::kVerificationFailed});
    // If the result as a whole is wrong, no single patch is at fault, so all patches take a step.
    if (failed.empty())
      for (std::size_t p = 0; p < partition.patches.count(); ++p)
        failed.push_back({PatchId(p), PatchReason::kVerificationFailed});
    // A curved patch cannot be left as it was triangulated: that is too far from its surface.
    if (curved_at_fault(failed).empty() &&
        (refiner->freeze(report.verified.failed_patches, partition.patches.count()) || refiner->gives_up_the_rest()))
      return AttemptOutcome::kRefinementFailed;
    return step_up(failed);
  }

  /// Counts the faces of the output for the bounds on memory, as far as there are any. A sample of sizes takes less
  /// than a face.
  void count_output() {
    const std::uint64_t samples = refiner->sample_count();
    control.memory().set_output(std::max(candidate.triangulated.triangle_count(), samples));
  }

  void refine() {
    Refinement& refinement = candidate.refinement;
    if (goals() == nullptr && !candidate.has_chords) return;
    watch.enter(Stage::kRefinement);
    if (goals() == nullptr) return separate_chords();
    refinement = refiner->refine(patched(), *ladder_, intersections().patches, candidate.triangulated);
    lift();
    report.refinement_rounds = refinement.rounds;
    report.min_edge_length = refiner->goals().min_edge_length;
    if (refiner->smallest_gap()) report.smallest_gap = refiner->smallest_gap();
  }

  /// Puts points into edges that exist twice.
  void separate_chords() {
    split_chords(with_cuts(), candidate.triangulated, candidate.refinement, {}, UnrefinedReason::kSizeFloor, control);
    lift();
  }

  void lift() {
    count_output();
    Refinement& refinement = candidate.refinement;
    lift_new_vertices(with_cuts(), partition.patches, candidate.triangulated, refinement.first_inner,
                      report.plane_tolerance, refinement.new_positions, control);
  }

  /// Lets facets of curved surfaces stay, or joins them again, by what has fewer faces.
  /// Output: whether anything has changed.
  bool leave_coarser_facets() {
    std::vector<std::uint64_t> triangles;
    for (const PatchMesh& patch : candidate.triangulated.meshes) triangles.push_back(patch.mesh.triangle_count());
    return curves.leave_coarser_facets(triangles, partition.patches, curved_goals_);
  }

  /// Moves vertices so that the volumes of curved surfaces are kept, if that is asked for.
  /// Output: false if the surfaces have to be moved by other offsets first, on which everything is done again.
  bool keep_volumes() {
    VolumeOffsets* const outside = curves.outside();
    if (outside == nullptr) return true;
    const FitInput fit{with_cuts(), partition.patches, *curves.curved(), *outside, asked_goals() != nullptr};
    const FittedVolumes fitted = fit_volumes(fit, candidate.triangulated, candidate.refinement.new_positions, control);
    if (!fitted.impossible.empty()) {
      curves.step_up(curves.patches_of(fitted.impossible), partition.patches, true);
      return false;
    }
    if (!fitted.is_near && outside->is_better_estimate_worth_while()) {
      outside->take_offsets(fitted.better);
      return false;
    }
    // A triangle that just meets a goal may miss it by a little after this last correction.
    if (asked_goals() != nullptr) assemble(candidate, with_cuts(), asked_goals(), control);
    FittedVertices moved =
        move_to_fit(fit, fitted, candidate.triangulated, candidate.refinement.new_positions, control);
    if (asked_goals() != nullptr) replace_reasons(candidate, moved.is_moved, UnrefinedReason::kEffort);
    candidate.moved = std::move(moved.places);
    for (SurfaceId s(0); s.value < fitted.offsets.size(); ++s.value)
      if (outside->goals()[s].is_wanted) report.surfaces.surfaces[s].outside = fitted.outside[s];
    return true;
  }

  void refuse_if_too_large() const {
    const std::uint64_t faces = candidate.assembled.faces.size(), max = options.max_output_faces.value_or(faces);
    if (faces > max)
      throw Error(Code::kOutputTooLarge, Stage::kAssembly,
                  "the result has " + std::to_string(faces) + " faces, more than allowed")
          .for_option("max_output_faces")
          .with_limit(max);
  }

  /// Checks the result once, and counts the work of the check.
  void run_check(const CheckedAgainst& against) {
    report.verified = check(candidate, against, control);
    refiner->take_check(report.verified.search_steps);
  }

  /// Runs the independent check of the promises. The check computes what it needs of the surface itself, or verifies
  /// it. New vertices that have the same place are moved apart first, or if the check has failed.
  void check_candidate() {
    prepared.release_all_but_order();
    watch.enter(Stage::kVerify);
    const InputIntersections known = intersections();
    const std::vector<CurvedClaim> curved_claims = claims_of(curves.curved(), curved_goals_);
    CheckedAgainst against{
        read_input(),           surface(),     partition.patches, known,         report.plane_tolerance,
        options.weld_tolerance, asked_goals(), curves.curved(),   curved_claims, refiner->frozen().items(),
        prepared.order()};
    const auto run = [&] {
      against.measure_sizes = nullptr;
      if (refiner->are_sizes_unmeasured())
        against.measure_sizes = [&](Candidate& candidate) {
          refiner->measure_sizes(patched(), candidate.triangulated, candidate.refinement);
          prepared.release_adjacency();
        };
      run_check(against);
      return report.verified.all_true();
    };
    // Vertices have the same place mostly where patches of the input cross or touch each other. The check takes too
    // long to find that out.
    if (!known.patches.empty()) separate_vertices(TwinsOf::kPatches);
    if (!run() && separate_vertices(TwinsOf::kSurface)) run();
  }

  /// Moves new vertices apart that have the same place.
  /// Output: whether there are any that could be moved.
  bool separate_vertices(TwinsOf of) {
    const std::vector<std::uint8_t> is_moved =
        separate_new_vertices(with_cuts(), candidate.triangulated, candidate.refinement, of, control);
    if (is_moved.empty()) return false;
    refiner->note_separated_vertices();
    assemble_again(candidate, with_cuts(), asked_goals(), is_moved, UnrefinedReason::kEffort, control);
    return true;
  }

  /// Marks for each face of the input, or empty as long as none is marked. They outlast a step of the ladder, after
  /// which the patches are others, and mending, after which the faces of the surface are others.
  using FaceMarks = std::vector<std::uint8_t>;

  /// Marks the faces from which these patches are made.
  void mark_faces(const std::vector<PatchId>& patches, FaceMarks& marks) const {
    marks.resize(input.face_count(), 0);
    for (const PatchId p : patches)
      for (const FaceId f : partition.patches.faces_of(p)) marks[surface().face_source[f].value] = 1;
  }
  /// Freezes the patches all of whose faces are marked.
  void freeze_marked(const FaceMarks& marks) {
    if (marks.empty()) return;
    std::vector<PatchId> marked;
    StopCheck check(control);
    for (std::uint32_t p = 0; p < partition.patches.count(); ++p) {
      check();
      const auto faces = partition.patches.faces_of(PatchId(p));
      if (std::all_of(faces.begin(), faces.end(), [&](FaceId f) { return marks[surface().face_source[f].value] != 0; }))
        marked.push_back(PatchId(p));
    }
    refiner->freeze(marked, partition.patches.count());
  }

  std::vector<PatchId> curved_at_fault(const std::vector<FailedPatch>& failed) {
    return curves.at_fault(failed, partition.patches, surface(), adjacency(), control);
  }

  /// Takes the patches that failed a step up the ladder. If curved ones may be at fault, they take a step of their own.
  AttemptOutcome step_up(const std::vector<FailedPatch>& failed) {
    keep_frozen();
    refiner->thaw();
    watch.enter(Stage::kPatches);
    if (const std::vector<PatchId> curved = curved_at_fault(failed); !curved.empty()) {
      // Attempts take long where patches of the input cross, and where floors are looked for. For a default, not much
      // of that work is spent in vain.
      const bool is_patient =
          !curved_goals_.is_automatic || (intersections().patches.empty() && !refiner->has_found_floor());
      curves.step_up(curved, partition.patches, is_patient);
      return AttemptOutcome::kPatchesFailed;
    }
    const std::vector<FaceId> exhausted =
        ladder_->step(partition.patches, partition.loops, adjacency(), failed, regions_);
    if (exhausted.empty() || exhausted.size() != partition.face_count_of(failed)) return AttemptOutcome::kPatchesFailed;
    keep_verbatim(exhausted);
    return AttemptOutcome::kFacesFailed;
  }

  /// Remembers which faces are frozen if it took much work to find them.
  void keep_frozen() {
    const bool are_of_these = refiner->frozen().size() == partition.patches.count();
    if (refiner->work_taken().triangles < kWorkBeforeFrozenStay || !are_of_these) return;
    std::vector<PatchId> frozen;
    for (std::uint32_t p = 0; p < partition.patches.count(); ++p)
      if (refiner->frozen()[PatchId(p)] != 0) frozen.push_back(PatchId(p));
    mark_faces(frozen, stays_frozen_);
  }

  /// Marks faces to be copied verbatim in the next attempt.
  /// Errors: kVerificationFailed - all of them have been copied before.
  void keep_verbatim(const std::vector<FaceId>& exhausted) {
    limits_.keep_verbatim.resize(input.face_count(), 0);
    bool is_new = false;
    for (const FaceId f : exhausted) {
      const FaceId source = surface().face_source[f];
      is_new = is_new || limits_.keep_verbatim[source.value] == 0;
      limits_.keep_verbatim[source.value] = 1;
    }
    if (is_new || give_up_joining()) return;
    // If a face cannot be resolved at the mesh's scale, the input is at fault. Otherwise the fault is ours.
    for (const FaceId f : exhausted)
      if (is_unresolved(surface(), f)) throw unresolved(surface(), f);
    const std::vector<std::string>& failures = report.verified.failures;
    const FaceId source = surface().face_source[exhausted.front()];
    throw Error(Code::kVerificationFailed, Stage::kVerify,
                "face " + std::to_string(source.value) +
                    " could not be reproduced in a result that passes verification: " +
                    (failures.empty() ? "the result failed its own check" : failures.front()))
        .at_element(source.value);
  }

  /// Gives up splitting edges at T-junctions, closing seams and holes, and dividing polygons that have copies. Where
  /// sheets nearly touch, new vertices in faces, closed seams or new faces may be the reason why a result fails
  /// verification.
  /// Output: whether there were any. All of them are left alone from now on.
  bool give_up_joining() {
    const auto is_joining = [&](const Diagnostic& d) {
      return (d.code == DiagnosticCode::kTJunction && options.repair.t_junctions) ||
             (d.code == DiagnosticCode::kSeam && options.repair.seams) || d.code == DiagnosticCode::kClosedHole ||
             (d.code == DiagnosticCode::kDuplicateFace && options.repair.duplicates);
    };
    const bool were_joined =
        limits_.is_joining_allowed && std::any_of(report.diagnostics.begin(), report.diagnostics.end(), is_joining);
    limits_.is_joining_allowed = false;
    return were_joined;
  }

  const std::vector<Diagnostic> diagnostics_of_reader_;
  const Storage storage_;  ///< the numbers that the result is meant for
  MendingLimits limits_;
  CurvedGoals curved_goals_;      ///< known when the prepared surface is
  std::optional<Ladder> ladder_;  ///< belongs to the prepared surface
  Regions regions_;
  FaceMarks has_failed_;    ///< the faces of patches that have failed the check
  FaceMarks stays_frozen_;  ///< the faces of patches that stay frozen after a step of the ladder
};

/// An arena with this many threads. The calling thread stores it for later runs. TBB (2021.8) never frees some KB of
/// each arena whose workers did not come in time, so an arena per run would fill the memory of a long-lived process.
tbb::task_arena& reused_arena(int threads) {
  thread_local std::map<int, tbb::task_arena> arenas;
  return arenas.try_emplace(threads, threads).first->second;
}

/// Runs `work` on this many threads. If the caller's arena has as many, it runs there.
template <class Work>
auto in_arena(int threads, Work work) {
  if (tbb::this_task_arena::max_concurrency() == threads) return work();
  return reused_arena(threads).execute(work);
}

}  // namespace

int thread_count(const PolygonMesh& input, const Options& options, const RunSettings& settings) {
  const auto most = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  const int allowed = std::clamp(settings.workers, 1, most);
  return !options.refine && input.corners.size() < settings.serial_corners ? 1 : allowed;
}

Result remesh_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                      RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings), [&] {
    return Run(input, options, settings.storage, control, std::move(diagnostics)).remesh(settings);
  });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings),
                  [&] { return Run(input, options, settings.storage, control, std::move(diagnostics)).analyze(); });
}

}  // namespace remesh
