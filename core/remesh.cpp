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

#include "core/base/blocks.h"
#include "core/base/parallel.h"
#include "core/base/stoppable.h"
#include "core/base/stopwatch.h"
#include "core/base/tolerance.h"
#include "core/base/work_bound.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_reason.h"
#include "core/mending/body_labels.h"
#include "core/mending/preparation.h"
#include "core/mending/resolution.h"
#include "core/mending/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"
#include "core/output/candidate.h"
#include "core/output/detail_stage.h"
#include "core/output/face_labels.h"
#include "core/output/face_source.h"
#include "core/output/many_faces.h"
#include "core/output/output_form.h"
#include "core/output/report.h"
#include "core/output/volume_ready.h"
#include "core/output/warnings.h"
#include "core/patches/coplanar_regions.h"
#include "core/patches/curved_stage.h"
#include "core/patches/input_intersections.h"
#include "core/patches/ladder.h"
#include "core/patches/partition.h"
#include "core/patches/patch_meshing.h"
#include "core/refinement/chords.h"
#include "core/refinement/curved_prediction.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goal_refinement.h"
#include "core/refinement/lifting.h"
#include "core/refinement/rounds.h"
#include "core/refinement/separation.h"
#include "core/refinement/unrefined_reason.h"
#include "core/refinement/volume_fit.h"

namespace remesh {
namespace {

/// The outcome of an attempt at the surface.
enum class AttemptOutcome {
  kVerified,          ///< the result passed verification
  kTooManyFaces,      ///< refinement made more faces than are allowed
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

/// The last correction of offsets changes angles by less than this, in degrees, in nearly all triangles.
constexpr double kAngleMarginOfFit = 0.1;

/// Predicts the faces for other numbers of elements per circle.
/// Input: `predicted` has the faces that are predicted for each patch; it is empty if nothing is refined.
std::map<int, std::uint64_t> predict_by_circles(const RecognisedFacets& facets, const Partition& partition,
                                                const CurveCuts& cuts, const PatchMeshes& meshes,
                                                const std::vector<float>& predicted, const Options& options,
                                                RunControl& control) {
  PresentPatches present{partition.patches, partition.essential, cuts, {}, {}};
  for (std::size_t p = 0; p < partition.patches.count(); ++p) {
    present.triangles.push_back(static_cast<double>(meshes[PatchId(p)].mesh.triangle_count()));
    present.faces.push_back(!predicted.empty() ? predicted[p]
                                               : static_cast<double>(partition.summaries.patches[p].output_faces));
  }
  return predict_by_elements_per_circle(facets, present, options, control);
}

/// Returns the number of faces for the bounds on memory. Polygons count as their triangles, and three vertices count as
/// a face, whether or not a face has them.
template <class Polygons>
std::uint64_t counted_faces(const Polygons& mesh) {
  return std::max(mesh.corners.size() - 2 * mesh.face_count(), mesh.vertex_count() / 3 + 1);
}

/// Returns whether the options allow boundaries to be cut anew, so that patches have more vertices than the input.
bool may_cut_curves(const Options& options) {
  return options.elements_per_circle || options.surface_tolerance || options.surface_tolerance_fraction;
}

/// Takes the distances that were proven into the report.
/// Input: `of_details` is the distance between the surface and the one from which no details had been removed.
void take_bounds(Report& report, double of_details) {
  report.distance_bound = {report.verified.distance_bound.output_to_input + of_details,
                           report.verified.distance_bound.input_to_output + of_details};
  report.verified.deviation += of_details;
  for (std::size_t p = 0; p < report.patches.size(); ++p) {
    report.patches[p].bound = report.verified.patch_bounds[p] + of_details;
    double& of_surface = report.surfaces.surfaces[report.surfaces.of_patch[PatchId(p)]].bound;
    of_surface = std::max(of_surface, report.patches[p].bound);
  }
}

/// One run on one surface. Its members are what the stages pass on to each other.
/// This class is larger than the bound because it has a short function for each step of the pipeline, so that the whole
/// can be read in one place.
class Run {
 public:
  Run(const PolygonMesh& input, const Options& options, RunControl& control, std::vector<Diagnostic> diagnostics)
      : input_(input),
        options_(options),
        control_(control),
        diagnostics_of_reader_(std::move(diagnostics)),
        watch_(control) {
    report_.options = options;
  }

  Result remesh(const RunSettings& settings) {
    for (Step step = Step::kPrepare; step != Step::kFinish; step = step_after(attempt())) {
      // Weld, choose the tolerance, mend.
      if (step == Step::kPrepare) prepare();
      // Sections 2 to 4 of the 2018 report: find coplanar faces, their patches, edge loops and essential vertices.
      if (step <= Step::kPartition) find_patches();
      // Section 5, for every patch: projection, lexicographic triangulation, flips, recovery of the loops, carving.
      // Vertices that were moved to keep a volume have changed the triangles.
      if (step <= Step::kTriangulate || curves_.outside() != nullptr)
        triangulate();
      else
        candidate_.undo_refinement();
    }
    complete_report();
    return finish(settings);
  }

  Report analyze() {
    prepare();
    find_patches();
    // The triangles are not part of the report, but they predict what refinement would make of the patches.
    triangulate();
    examine_input();
    report_.surfaces.join_bands();
    watch_.enter(Stage::kRefinement);
    refiner_->predict_before(patched(), candidate_.triangulated);
    report_.min_edge_length = refiner_->goals().min_edge_length;
    tell_curves({[&](PatchId p) {
                   return goals() != nullptr ? refiner_->predicted_of_patch()[p.value]
                                             : static_cast<double>(partition_.summaries.patches[p.value].output_faces);
                 },
                 RefinedFaces::Are::kPredicted});
    report_.predicted_faces_by_elements_per_circle = predict_for_circles(refiner_->predicted_of_patch());
    tell_many_faces(RefinedFaces::Are::kPredicted, refiner_->predicted_of_patch());
    // Facets count, not the patches that were joined from them, so proximity does not change the answer.
    if (curves_.curved() == nullptr) report_.smallest_gap = refiner_->smallest_gap();
    if (!report_.smallest_gap)
      report_.smallest_gap = GapSearch(surface(), adjacency(), curves_.facets(partition_), report_.plane_tolerance,
                                       control_, curves_.curved() != nullptr ? nullptr : &candidate_.triangulated)
                                 .smallest(control_, refiner_->goals().max_faces);
    summarise();
    if (details_.is_any_removed()) report_.diagnostics.push_back(details_.removal());
    report_.timing_ms = watch_.finish();
    return std::move(report_);
  }

 private:
  const Surface& surface() const { return prepared_.surface; }
  /// The surface with the vertices between which boundaries were cut anew.
  const Surface& with_cuts() const { return curves_.with_cuts(surface()); }
  const Adjacency& adjacency() { return prepared_.adjacency(control_); }
  PatchedSurface patched() { return {with_cuts(), adjacency(), partition_.patches, report_.plane_tolerance}; }
  const Goals* goals() const { return refiner_->has_goals() ? &refiner_->goals() : nullptr; }
  /// The goals that the options ask for, if any. Curved patches are refined without any as well.
  const Goals* asked_goals() const { return options_.refine ? goals() : nullptr; }

  void prepare() {
    // Nothing of the last attempt is needed any more.
    const AttemptEffort::Taken taken = refiner_ ? refiner_->work_taken() : AttemptEffort::Taken();
    const double floor = refiner_ ? refiner_->goals().min_edge_length : 0;
    refiner_.reset();
    candidate_.clear();
    control_.memory().set_input(counted_faces(input_));
    InputSummary summary;
    summary.diagnostics = diagnostics_of_reader_;
    prepared_ = remesh::prepare(input_, options_, limits_, summary, watch_, control_);
    // Polygons have got new corners where vertices lay on their edges.
    control_.memory().set_input(std::max(counted_faces(input_), counted_faces(surface())));
    report_.input = std::move(summary.statistics);
    report_.plane_tolerance = report_.first_plane_tolerance = summary.plane_tolerance;
    report_.plane_tolerance_is_automatic = summary.plane_tolerance_is_automatic;
    report_.rounding_step = summary.rounding_step;
    report_.diagnostics = std::move(summary.diagnostics);
    const double diagonal = report_.input.bounding_box.diagonal();
    check_options(options_, diagonal);
    details_.reset(options_, report_.plane_tolerance);
    Goals goals = goals_of(options_, diagonal);
    keep_in_proportion(goals, options_, diagonal, triangles_of_input());
    refiner_.emplace(goals, control_, taken, floor);
    regions_ = {};
    ladder_.emplace(surface(), prepared_.without_area);
    if (options_.keep_boundary_vertices) ladder_->forced().assign(surface().vertex_count(), 1);
    input_intersections_.reset();
    curves_.reset();
  }

  void find_patches() {
    candidate_.clear();
    const PatchSet before = curves_.take_facets(partition_);
    divide();
    while (details_.is_wanted() && remove_details()) divide();
    // Beyond the 2018 report: find curved surfaces, and join their facets as far as that is asked for.
    watch_.enter(Stage::kSurfaces);
    if (may_cut_curves(options_)) control_.memory().set_output(options_.max_output_faces.value_or(MemoryBound::kNone));
    curves_.run(partition_, before, prepared_, *ladder_, options_,
                {report_.plane_tolerance, report_.input.bounding_box.diagonal(),
                 options_.refine ? refiner_->goals().min_angle_deg : 0},
                control_);
    refiner_->set_curved(curves_.curved() != nullptr);
    refiner_->set_angle_margin(curves_.outside() != nullptr ? kAngleMarginOfFit : 0);
    report_.surfaces = curves_.take_surfaces();
    freeze_marked(stays_frozen_);
  }

  void divide() {
    partition_ = make_partition(prepared_, report_.plane_tolerance, options_, *ladder_, regions_, watch_, control_);
  }

  /// Looks for details in the triangles of the patches, before facets are joined, and makes the triangles without them
  /// the surface.
  /// Output: false if all stays as it is.
  bool remove_details() {
    // It is still needed which curved patches have failed, if nothing is removed.
    curves_.forget_joined();
    triangulate();
    // The ladder comes first, and changes the patches.
    if (!find_failed_patches(candidate_.triangulated.meshes).empty()) return false;
    if (!details_.are_there(candidate_.triangulated, surface(), adjacency(), control_)) {
      details_.stop();
      return false;
    }
    if (!input_intersections_) find_input_intersections(Triangulated(surface(), control_));
    if (!details_.run({input_, partition_.patches, intersections(), report_.plane_tolerance, options_.weld_tolerance,
                       limits_.keep_verbatim},
                      candidate_, prepared_, watch_, control_))
      return false;
    control_.memory().set_input(std::max(counted_faces(input_), counted_faces(surface())));
    report_.plane_tolerance = details_.plane_tolerance();
    curves_.reset();
    regions_ = {};
    ladder_.emplace(surface(), prepared_.without_area);
    if (options_.keep_boundary_vertices) ladder_->forced().assign(surface().vertex_count(), 1);
    input_intersections_.reset();
    return true;
  }

  /// Returns the mesh as read, or null if the surface has lost its details since.
  const PolygonMesh* read_input() const { return details_.is_any_removed() ? nullptr : &input_; }

  void triangulate() {
    watch_.enter(Stage::kTriangulation);
    candidate_.clear();
    const std::optional<CurvedBoundaries> curves = curves_.boundaries();
    candidate_.triangulated =
        mesh_patches(with_cuts(), adjacency(), partition_.patches, partition_.loops, partition_.essential,
                     {options_.reference_axis, options_.reference_direction}, control_, curves ? &*curves : nullptr);
    count_output();
  }

  /// Goes from the patches' triangles to a verdict.
  AttemptOutcome attempt() {
    if (!input_intersections_) find_input_intersections(Triangulated(surface(), control_));
    refiner_->begin_attempt();
    watch_.enter(Stage::kAssembly);
    std::vector<FailedPatch> failed = find_failed_patches(candidate_.triangulated.meshes);
    if (!failed.empty()) return step_up(failed);
    // No edge inside a patch may be the edge of another patch. (If refinement is tried again, this changes nothing.)
    if (!candidate_.has_chords)
      candidate_.has_chords = !flip_chords(candidate_.triangulated.meshes, with_cuts().vertex_count(), control_);
    // All patches together: improve angles and sizes, and resolve the remaining conflicts between patches.
    refine();
    if (!keep_volumes()) {
      // The patches may be others after this. What is known of these must not be taken for theirs.
      refiner_->forget_patches();
      return AttemptOutcome::kOffsetsChanged;
    }
    watch_.enter(Stage::kAssembly);
    assemble(candidate_, with_cuts(), asked_goals(), control_);
    if (refiner_->is_over_budget(candidate_.assembled.faces.size())) return AttemptOutcome::kTooManyFaces;
    refuse_if_too_large();
    check_candidate();
    if (report_.verified.all_true()) {
      if (!refiner_->goes_on_with_the_rest()) return AttemptOutcome::kVerified;
      freeze_marked(has_failed_);
      return AttemptOutcome::kRestUnrefined;
    }
    mark_faces(report_.verified.failed_patches, has_failed_);
    for (const PatchId p : report_.verified.failed_patches) failed.push_back({p, PatchReason::kVerificationFailed});
    // If the result as a whole is wrong, no single patch is at fault, so all patches take a step.
    if (failed.empty())
      for (std::size_t p = 0; p < partition_.patches.count(); ++p)
        failed.push_back({PatchId(p), PatchReason::kVerificationFailed});
    // A curved patch cannot be left as it was triangulated: that is too far from its surface.
    if (curved_at_fault(failed).empty() &&
        (refiner_->freeze(report_.verified.failed_patches, partition_.patches.count()) ||
         refiner_->gives_up_the_rest()))
      return AttemptOutcome::kRefinementFailed;
    return step_up(failed);
  }

  /// Counts the faces of the output for the bounds on memory, as far as there are any. A sample of sizes takes less
  /// than a face.
  void count_output() {
    const std::uint64_t samples = refiner_->sample_count();
    control_.memory().set_output(std::max(candidate_.triangulated.triangle_count(), samples));
  }

  void refine() {
    Refinement& refinement = candidate_.refinement;
    if (goals() == nullptr && !candidate_.has_chords) return;
    watch_.enter(Stage::kRefinement);
    if (goals() == nullptr) return separate_chords();
    refinement = refiner_->refine(patched(), *ladder_, intersections().patches, candidate_.triangulated);
    lift();
    report_.refinement_rounds = refinement.rounds;
    report_.min_edge_length = refiner_->goals().min_edge_length;
    if (refiner_->smallest_gap()) report_.smallest_gap = refiner_->smallest_gap();
  }

  /// Puts points into edges that exist twice.
  void separate_chords() {
    split_chords(with_cuts(), candidate_.triangulated, candidate_.refinement, {}, UnrefinedReason::kSizeFloor,
                 control_);
    lift();
  }

  void lift() {
    count_output();
    Refinement& refinement = candidate_.refinement;
    lift_new_vertices(with_cuts(), partition_.patches, candidate_.triangulated, refinement.first_inner,
                      report_.plane_tolerance, refinement.new_positions, control_);
  }

  /// Moves vertices so that the volumes of curved surfaces are kept, if that is asked for.
  /// Output: false if the surfaces have to be moved by other offsets first, on which everything is done again.
  bool keep_volumes() {
    VolumeOffsets* const outside = curves_.outside();
    if (outside == nullptr) return true;
    const FitInput input{with_cuts(), partition_.patches, *curves_.curved(), *outside, asked_goals() != nullptr};
    const FittedVolumes fitted =
        fit_volumes(input, candidate_.triangulated, candidate_.refinement.new_positions, control_);
    if (!fitted.impossible.empty()) {
      curves_.step_up(curves_.patches_of(fitted.impossible), partition_.patches);
      return false;
    }
    if (!fitted.is_near && outside->is_better_estimate_worth_while()) {
      outside->take_offsets(fitted.better);
      return false;
    }
    // A triangle that just meets a goal may miss it by a little after this last correction.
    if (asked_goals() != nullptr) assemble(candidate_, with_cuts(), asked_goals(), control_);
    FittedVertices moved =
        move_to_fit(input, fitted, candidate_.triangulated, candidate_.refinement.new_positions, control_);
    if (asked_goals() != nullptr) replace_reasons(candidate_, moved.is_moved, UnrefinedReason::kEffort);
    candidate_.moved = std::move(moved.places);
    for (SurfaceId s(0); s.value < fitted.offsets.size(); ++s.value)
      if (outside->goals()[s].is_wanted) report_.surfaces.surfaces[s].outside = fitted.outside[s];
    return true;
  }

  void refuse_if_too_large() const {
    const std::uint64_t faces = candidate_.assembled.faces.size(), max = options_.max_output_faces.value_or(faces);
    if (faces > max)
      throw Error(Code::kOutputTooLarge, Stage::kAssembly,
                  "the result has " + std::to_string(faces) + " faces, more than allowed")
          .for_option("max_output_faces")
          .with_limit(max);
  }

  /// Checks the result once, and counts the work of the check.
  void run_check(const CheckedAgainst& against) {
    report_.verified = check(candidate_, against, control_);
    refiner_->take_check(report_.verified.search_steps);
  }

  /// Runs the independent check of the promises. The check computes what it needs of the surface itself, or verifies
  /// it. New vertices that have the same place are moved apart first, or if the check has failed.
  void check_candidate() {
    prepared_.release_all_but_order();
    watch_.enter(Stage::kVerify);
    const InputIntersections known = intersections();
    CheckedAgainst against{read_input(),
                           surface(),
                           partition_.patches,
                           known,
                           report_.plane_tolerance,
                           options_.weld_tolerance,
                           asked_goals(),
                           curves_.curved(),
                           refiner_->frozen().items(),
                           prepared_.order()};
    const auto run = [&] {
      against.measure_sizes = nullptr;
      if (refiner_->are_sizes_unmeasured())
        against.measure_sizes = [&](Candidate& candidate) {
          refiner_->measure_sizes(patched(), known.patches, candidate.triangulated, candidate.refinement);
          prepared_.release_adjacency();
        };
      run_check(against);
      return report_.verified.all_true();
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
        separate_new_vertices(with_cuts(), candidate_.triangulated, candidate_.refinement, of, control_);
    if (is_moved.empty()) return false;
    refiner_->note_separated_vertices();
    assemble_again(candidate_, with_cuts(), asked_goals(), is_moved, UnrefinedReason::kEffort, control_);
    return true;
  }

  /// Marks for each face of the input, or empty as long as none is marked. They outlast a step of the ladder, after
  /// which the patches are others, and mending, after which the faces of the surface are others.
  using FaceMarks = std::vector<std::uint8_t>;

  /// Marks the faces from which these patches are made.
  void mark_faces(const std::vector<PatchId>& patches, FaceMarks& marks) const {
    marks.resize(input_.face_count(), 0);
    for (const PatchId p : patches)
      for (const FaceId f : partition_.patches.faces_of(p)) marks[surface().face_source[f].value] = 1;
  }
  /// Freezes the patches all of whose faces are marked.
  void freeze_marked(const FaceMarks& marks) {
    if (marks.empty()) return;
    std::vector<PatchId> marked;
    StopCheck check(control_);
    for (std::uint32_t p = 0; p < partition_.patches.count(); ++p) {
      check();
      const auto faces = partition_.patches.faces_of(PatchId(p));
      if (std::all_of(faces.begin(), faces.end(), [&](FaceId f) { return marks[surface().face_source[f].value] != 0; }))
        marked.push_back(PatchId(p));
    }
    refiner_->freeze(marked, partition_.patches.count());
  }

  std::vector<PatchId> curved_at_fault(const std::vector<FailedPatch>& failed) {
    return curves_.at_fault(failed, partition_.patches, surface(), adjacency(), control_);
  }

  /// Takes the patches that failed a step up the ladder. If curved ones may be at fault, they take a step of their own.
  AttemptOutcome step_up(const std::vector<FailedPatch>& failed) {
    keep_frozen();
    refiner_->thaw();
    watch_.enter(Stage::kPatches);
    if (const std::vector<PatchId> curved = curved_at_fault(failed); !curved.empty()) {
      curves_.step_up(curved, partition_.patches);
      return AttemptOutcome::kPatchesFailed;
    }
    const std::vector<FaceId> exhausted =
        ladder_->step(partition_.patches, partition_.loops, adjacency(), failed, regions_);
    if (exhausted.empty() || exhausted.size() != partition_.face_count_of(failed))
      return AttemptOutcome::kPatchesFailed;
    keep_verbatim(exhausted);
    return AttemptOutcome::kFacesFailed;
  }

  /// Remembers which faces are frozen if it took much work to find them.
  void keep_frozen() {
    const bool are_of_these = refiner_->frozen().size() == partition_.patches.count();
    if (refiner_->work_taken().triangles < kWorkBeforeFrozenStay || !are_of_these) return;
    std::vector<PatchId> frozen;
    for (std::uint32_t p = 0; p < partition_.patches.count(); ++p)
      if (refiner_->frozen()[PatchId(p)] != 0) frozen.push_back(PatchId(p));
    mark_faces(frozen, stays_frozen_);
  }

  /// Marks faces to be copied verbatim in the next attempt.
  /// Errors: kVerificationFailed - all of them have been copied before.
  void keep_verbatim(const std::vector<FaceId>& exhausted) {
    limits_.keep_verbatim.resize(input_.face_count(), 0);
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
    const std::vector<std::string>& failures = report_.verified.failures;
    const FaceId source = surface().face_source[exhausted.front()];
    throw Error(Code::kVerificationFailed, Stage::kVerify,
                "face " + std::to_string(source.value) +
                    " could not be reproduced in a result that passes verification: " +
                    (failures.empty() ? "the result failed its own check" : failures.front()))
        .at_element(source.value);
  }

  /// Gives up splitting edges at T-junctions and closing seams. Where sheets nearly touch, new vertices in faces or
  /// closed seams may be the reason why a result fails verification.
  /// Output: whether there were any. Both are left alone from now on.
  bool give_up_joining() {
    const auto is_joining = [&](const Diagnostic& d) {
      return (d.code == DiagnosticCode::kTJunction && options_.repair.t_junctions) ||
             (d.code == DiagnosticCode::kSeam && options_.repair.seams);
    };
    const bool were_joined =
        limits_.is_joining_allowed && std::any_of(report_.diagnostics.begin(), report_.diagnostics.end(), is_joining);
    limits_.is_joining_allowed = false;
    return were_joined;
  }

  /// Finds the faces that intersect before anything is done to them. They are looked for between patches.
  void find_input_intersections(const Triangulated& faces) {
    watch_.enter(Stage::kVerify);
    // Intersections that are found after details were removed have been told before.
    std::vector<Diagnostic> told_before;
    std::vector<Diagnostic>& diagnostics = details_.is_any_removed() ? told_before : report_.diagnostics;
    input_intersections_ = find_intersections(surface(), faces, partition_.patches,
                                              find_simple_patches(partition_, candidate_.triangulated.meshes),
                                              report_.plane_tolerance, diagnostics, control_);
    if (!details_.is_any_removed()) report_.input.intersecting_pairs = input_intersections_->pairs.size();
  }
  InputIntersections intersections() const { return intersecting_patches(*input_intersections_, partition_.patches); }

  void examine_input() {
    const Triangulated faces(surface(), control_);
    if (!input_intersections_) find_input_intersections(faces);
    // The first triangle of a polygon stands for the polygon.
    std::vector<std::pair<FaceId, FaceId>> pairs;
    for (const auto& [f, g] : input_intersections_->pairs)
      pairs.push_back({FaceId(faces.first_of(f)), FaceId(faces.first_of(g))});
    const auto begins = triangle_begins(faces.corners().size() / 3, control_);
    const Adjacency edges(surface().vertex_count(), begins, faces.corners(), control_);
    std::vector<FaceId> source;
    source.reserve(faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t) source.push_back(surface().face_source[faces.face(t)]);
    const BodyLabels labels = labels_of_sources(input_.labels, source, control_);
    report_.volume_obstacles = find_volume_obstacles(surface().positions.items(), faces.corners(), edges, labels, pairs,
                                                     report_.plane_tolerance, control_);
    add_incomplete_check(input_intersections_->searched, faces.size(), report_.volume_obstacles);
  }

  /// Tells which curved surfaces are refined facet by facet.
  void tell_curves(const RefinedFaces& refined) {
    if (!options_.refine) return;
    if (options_.feature_angle_deg > 0)
      warn_of_curved_surfaces(surface(), partition_.patches, report_.surfaces, refined, report_.diagnostics,
                              curves_.curved());
    else
      warn_of_curves(surface(), partition_.patches, report_.diagnostics);
  }

  /// Input: the faces that there are, or that are predicted, of each patch; empty if nothing is refined.
  std::map<int, std::uint64_t> predict_for_circles(const std::vector<float>& faces) {
    return predict_by_circles({surface(), adjacency(), curves_.facets(partition_), curves_.recognised(),
                               report_.plane_tolerance, report_.input.bounding_box.diagonal()},
                              partition_, curves_.cuts(), candidate_.triangulated.meshes, faces, options_, control_);
  }

  /// Tells why there are far more faces than in the input, if so.
  /// Input: the patches' triangles as they were before refinement; surfaces before bands were joined.
  void tell_many_faces(RefinedFaces::Are are, const std::vector<float>& faces) {
    if (asked_goals() == nullptr) return;
    const std::vector<UnrefinedReason>& reasons = candidate_.unrefined.reasons;
    const auto is_left_by_floor = [](UnrefinedReason r) {
      return r == UnrefinedReason::kSizeFloor || r == UnrefinedReason::kMinEdgeLength;
    };
    const CurvedPatches* const curved = curves_.curved();
    warn_of_many_faces(
        {surface(),
         partition_.patches,
         {[&](PatchId p) { return faces[p.value]; }, are},
         triangles_of_input(),
         report_.input.bounding_box.diagonal(),
         options_,
         refiner_->goals(),
         static_cast<std::uint64_t>(std::count_if(reasons.begin(), reasons.end(), is_left_by_floor)),
         [&](PatchId p) {
           const SurfaceKind kind = report_.surfaces.surfaces[report_.surfaces.of_patch[p]].shape.kind;
           const bool is_joined = curved != nullptr && curved->of(p) != nullptr;
           return !is_joined && kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree;
         },
         [&](const Goals& goals) { return refiner_->predict_with(goals, patched(), candidate_.triangulated); },
         [&] { return predict_for_circles(faces); }},
        report_.diagnostics);
  }
  std::uint64_t triangles_of_input() const { return input_.corners.size() - 2 * input_.face_count(); }

  void summarise() {
    report_.patches = std::move(partition_.summaries.patches);
    if (details_.is_any_removed()) count_input_faces();
    report_.predicted_faces = goals() != nullptr ? refiner_->predicted_faces() : partition_.summaries.triangles;
    report_.volume_bound = partition_.summaries.volume_bound;
  }

  /// Counts the input's faces of each patch, where the surface has others.
  void count_input_faces() {
    for (PatchSummary& patch : report_.patches) patch.input_faces = 0;
    for (const PatchId p : patches_of_input())
      if (p.is_valid()) ++report_.patches[p.value].input_faces;
  }

  /// Completes the report after the result has passed verification.
  void complete_report() {
    std::vector<float> faces;
    for (const PatchMesh& patch : candidate_.triangulated.meshes)
      faces.push_back(static_cast<float>(patch.mesh.triangle_count()));
    // Other options are predicted for the triangles as they were before refinement.
    candidate_.refinement.before.exchange_with(candidate_.triangulated.meshes);
    refiner_->predict_after(patched(), candidate_.triangulated);
    tell_many_faces(RefinedFaces::Are::kCounted, faces);
    candidate_.refinement.before.exchange_with(candidate_.triangulated.meshes);
    candidate_.refinement.before.clear();
    summarise();
    report_.volume_bound = report_.verified.volume_bound + details_.volume_bound();
    take_bounds(report_, details_.bound());
    details_.tell(candidate_, partition_.patches, surface(), report_.diagnostics, control_);
    report_.surfaces.join_bands();
    for (std::size_t p = 0; p < candidate_.triangulated.meshes.size(); ++p)
      report_.patches[p].output_faces = candidate_.triangulated.meshes[PatchId(p)].mesh.triangle_count();
    prepared_.release();
    tell_curves({[&](PatchId p) { return static_cast<double>(report_.patches[p.value].output_faces); }});
    if (!report_.verified.are_all_intersections_known) warn_of_many_intersections(report_.diagnostics);
  }

  /// Makes the result of what is verified, rounds it for its format, and measures the rounded result.
  Result finish(const RunSettings& settings) {
    Result result;
    result.mesh.positions = std::move(candidate_.positions);
    result.basis = output_basis(result.mesh.positions);
    result.mesh.faces = std::move(candidate_.assembled.faces);
    result.face_patch = std::move(candidate_.assembled.face_patch);
    result.report = std::move(report_);
    // Everything from here on is about the coordinates that the output format holds.
    round_output(settings.storage, options_.local_origin, result, control_);
    watch_.enter(Stage::kQuality);
    const bool are_sources_needed =
        settings.want_face_source || do_labels_need_sources(input_.labels, options_.barriers);
    IdVector<FaceId, FaceId> source;
    // The two tasks have serial parts that do not depend on each other, so they run at the same time.
    do_all([&] { measure_output(result, control_); },
           [&] {
             // The source of each output face is the input face under its centroid.
             source = are_sources_needed ? face_source(surface(), partition_.patches, candidate_.triangulated, control_)
                                         : first_faces(surface(), partition_.patches, result.face_patch);
             candidate_.clear();
           });
    watch_.enter(Stage::kAssembly);
    result.mesh.labels = labels_from(input_.labels, source);
    if (settings.want_face_source) {
      result.face_source = source;
      result.input_face_patch = patches_of_input();
    }
    result.report.timing_ms = watch_.finish();
    return result;
  }

  IdVector<FaceId, PatchId> patches_of_input() const {
    if (details_.is_any_removed()) return details_.patches_of_input(partition_.patches);
    return remesh::patches_of_input(surface(), partition_.patches, input_.face_count());
  }

  OutputBasis output_basis(const IdVector<VertexId, Vec3>& positions) {
    OutputBasis basis;
    basis.normals = candidate_.triangulated.charts.normals(control_);
    if (const CurvedPatches* curved = curves_.curved())
      for (const std::uint32_t at : curved->at) basis.is_curved.push_back(at == kNone ? 0 : 1);
    // The input's bounding box may have corners of faces that were dropped.
    Box3 box;
    for (const Vec3& p : positions) box.add(p);
    basis.allowed_move = std::max(report_.plane_tolerance, kAllowedRounding * box.diagonal());
    basis.is_refined = asked_goals() != nullptr;
    basis.goals = refiner_->goals();
    basis.unrefined = std::move(candidate_.unrefined);
    basis.intersections =
        patches_that_still_intersect(intersections(), report_.verified, candidate_.assembled.face_patch);
    basis.patch_labels = labels_of_patches(input_.labels, surface(), partition_.patches, control_);
    return basis;
  }

  const PolygonMesh& input_;
  const Options& options_;
  RunControl& control_;
  const std::vector<Diagnostic> diagnostics_of_reader_;
  Stopwatch watch_;
  Report report_;
  MendingLimits limits_;
  Prepared prepared_;
  std::optional<Ladder> ladder_;                           ///< belongs to the prepared surface
  std::optional<GoalRefinement> refiner_;                  ///< belongs to the prepared surface
  std::optional<FoundIntersections> input_intersections_;  ///< belongs to the prepared surface; empty until known
  Regions regions_;
  DetailStage details_;     ///< belongs to the prepared surface
  CurvedStage curves_;      ///< belongs to the prepared surface
  FaceMarks has_failed_;    ///< the faces of patches that have failed the check
  FaceMarks stays_frozen_;  ///< the faces of patches that stay frozen after a step of the ladder
  Partition partition_;
  Candidate candidate_;
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
  return in_arena(thread_count(input, options, settings),
                  [&] { return Run(input, options, control, std::move(diagnostics)).remesh(settings); });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(thread_count(input, options, settings),
                  [&] { return Run(input, options, control, std::move(diagnostics)).analyze(); });
}

}  // namespace remesh
