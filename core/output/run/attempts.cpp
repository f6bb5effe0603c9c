#include "core/output/run/attempts.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/largest_coordinate.h"
#include "core/base/rounded_to_float.h"
#include "core/base/stoppable.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mending/weld/resolution.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/refinement/adjustment/lifting.h"
#include "core/refinement/adjustment/volume_fit.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/chords.h"

namespace remesh {
namespace {

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

/// Returns whether mending has split edges at T-junctions, closed seams or holes, or divided polygons that have copies.
bool was_any_joined(const Options& options, const std::vector<Diagnostic>& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) {
    return (d.code == DiagnosticCode::kTJunction && options.repair.t_junctions) ||
           (d.code == DiagnosticCode::kSeam && options.repair.seams) || d.code == DiagnosticCode::kClosedHole ||
           (d.code == DiagnosticCode::kDuplicateFace && options.repair.duplicates);
  });
}

/// Returns the median length of the sides of all faces.
double median_side(const Candidate& candidate) {
  std::vector<double> lengths;
  lengths.reserve(3 * candidate.assembled.faces.size());
  for (const auto& face : candidate.assembled.faces)
    for (std::size_t k = 0; k < 3; ++k)
      lengths.push_back(norm(candidate.positions[face[(k + 1) % 3]] - candidate.positions[face[k]]));
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Returns the length of the shortest edge with a vertex that refinement has made; 0 if there is none.
/// Input: the number of vertices before refinement. The vertices of the candidate are in the order of the surface.
double shortest_made(const Candidate& candidate, std::size_t vertices_before, const RunControl& control) {
  double shortest_squared = HUGE_VAL;
  StopCheck check(control);
  for (const auto& face : candidate.assembled.faces) {
    check();
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = face[k], b = face[(k + 1) % 3];
      if (candidate.assembled.vertex[std::max(a, b)].value < vertices_before) continue;
      shortest_squared = std::min(shortest_squared, norm_squared(candidate.positions[b] - candidate.positions[a]));
    }
  }
  return std::isfinite(shortest_squared) ? std::sqrt(shortest_squared) : 0;
}

/// Returns what is reached of a target: see RefinementFacts.
std::optional<double> over_target(const Candidate& candidate, const Goals& goals) {
  if (!goals.has_target()) return std::nullopt;
  const double over = goals.target_faces > 0 ? static_cast<double>(candidate.assembled.faces.size()) /
                                                   static_cast<double>(goals.target_faces)
                                             : median_side(candidate) / goals.target_edge_length;
  // Without a largest edge, nothing is left that would make fewer faces.
  return over > 0 && (over < 1 || std::isfinite(goals.max_edge_length)) ? std::optional(over) : std::nullopt;
}

}  // namespace

Attempts::Attempts(const PolygonMesh& input, const Options& options, Storage storage,
                   std::vector<Diagnostic> diagnostics, RunControl& control)
    : products_(std::make_unique<RunProducts>(input, options, control)),
      diagnostics_of_reader_(std::move(diagnostics)),
      storage_(storage) {}

Decisions Attempts::first_decisions() {
  prepare({});
  return Decisions(MinEdgeSearch(goals_));
}

Outcome Attempts::divide(const Decisions& decisions) {
  products_->choices = decisions.refinement;
  Outcome outcome;
  make_surface(decisions);
  if (const auto end = make_patches(decisions, outcome))
    outcome.end = *end;
  else
    triangulate();
  return outcome;
}

Outcome Attempts::attempt(const Decisions& decisions, const Effort& effort) {
  products_->choices = decisions.refinement;
  make_surface(decisions);
  Outcome outcome;
  outcome.input_faces = products_->input.face_count();
  outcome.are_elements_automatic = curved_goals_.is_automatic;
  if (divided_for_ != Division{decisions.rungs, decisions.curved})
    if (const auto end = make_patches(decisions, outcome)) {
      outcome.end = *end;
      return outcome;
    }
  // Section 5 of the 2018 report, for every patch: projection, lexicographic triangulation, flips, recovery of the
  // loops, carving. Vertices that were moved to keep a volume have changed the triangles.
  if (products_->joined.outside) products_->candidate.clear();
  triangulate();
  outcome.end = make_result(decisions, effort, outcome);
  return outcome;
}

/// Welds the mesh, chooses the tolerance and mends faces. Nothing of earlier attempts is needed any more.
void Attempts::prepare(const MendingLimits& mending) {
  RunProducts& made = *products_;
  Report& report = made.report;
  made.candidate.clear();
  control().memory().set_input(counted_faces(made.input));
  InputSummary summary;
  summary.diagnostics = diagnostics_of_reader_;
  made.prepared = remesh::prepare(made.input, options(), mending, summary, made.watch, control());
  // Polygons have got new corners where vertices lay on their edges.
  control().memory().set_input(std::max(counted_faces(made.input), counted_faces(surface())));
  report.input = std::move(summary.statistics);
  report.plane_tolerance = report.first_plane_tolerance = summary.plane_tolerance;
  report.plane_tolerance_is_automatic = summary.plane_tolerance_is_automatic;
  report.rounding_step = summary.rounding_step;
  report.diagnostics = std::move(summary.diagnostics);
  const double diagonal = report.input.bounding_box.diagonal();
  check_options(options(), diagonal);
  curved_goals_ = curved_goals_of(options(), diagonal);
  goals_ = goals_in_proportion();
  made.spent = {};
  made.arranged = {};
  made.removed = {};
  made.coarsening = {};
  made.detail_limits = detail_limits(options(), report.plane_tolerance);
  prepared_for_ = mending;
  arranged_for_.reset();
  replaced_for_.clear();
  forget_surface();
}

/// Forgets what was made of the surface, since it is another one.
void Attempts::forget_surface() {
  products_->input_intersections.reset();
  products_->joined = {};
  divided_for_.reset();
  regions_ = {};
  is_recognised_ = false;
}

Goals Attempts::goals_in_proportion() const {
  const double diagonal = products_->report.input.bounding_box.diagonal();
  Goals goals = goals_of(options(), diagonal);
  keep_in_proportion(goals, options(), diagonal, products_->triangles_of_input());
  if (storage_ == Storage::kFloat) keep_apart_in_storage(goals, options(), step_of_storage());
  return goals;
}

/// Returns the distance between floats at the part's largest coordinate, or at the largest from an origin near it.
double Attempts::step_of_storage() const {
  const Box3& box = products_->report.input.bounding_box;
  if (box.is_empty()) return 0;
  const double largest = std::max(largest_coordinate(box.min), largest_coordinate(box.max));
  const double longest = largest_coordinate(box.max - box.min);
  return step_of_floats(options().local_origin ? std::min(largest, longest) : largest);
}

/// Makes the surface that the decisions name, if the last attempt had another one.
void Attempts::make_surface(const Decisions& decisions) {
  const bool is_coarsened = products_->coarsening.is_done();
  if (prepared_for_ == decisions.mending && arranged_for_ == decisions.details.arranged &&
      replaced_for_ == decisions.details.replaced && is_coarsened == decisions.details.is_coarsened)
    return;
  prepare(decisions.mending);
  if (decisions.details.arranged) {
    divide_by(*decisions.details.arranged);
    triangulate();
    arrange_faces();
    arranged_for_ = decisions.details.arranged;
  }
  for (const FaceRungs& rungs : decisions.details.replaced) {
    divide_by(rungs);
    triangulate();
    remove_details(decisions.mending.keep_verbatim);
    replaced_for_.push_back(rungs);
  }
  if (!decisions.details.is_coarsened) return;
  divide_by({});
  recognise({}, {});
  coarsen_surface();
}

/// Finds the patches of the surface.
/// Output: how the attempt ends if another one has to begin before; empty if the patches are there.
std::optional<Outcome::End> Attempts::make_patches(const Decisions& decisions, Outcome& outcome) {
  RunProducts& made = *products_;
  divided_for_.reset();
  const PatchSet before =
      made.joined.curved() != nullptr ? std::move(made.joined.facets) : std::move(made.partition.patches);
  made.joined = {};
  // Sections 2 to 4 of the 2018 report: find coplanar faces, their patches, edge loops and essential vertices.
  divide_by(decisions.rungs);
  // The ladder comes before the stages that replace the surface, and changes the patches. Faces are cut before they are
  // made coarser, since what is recognised of a coarser surface holds for no other one.
  bool is_cut_later = false;
  const Repair& repair = options().repair;
  if ((repair.self_intersections || repair.make_union) && !decisions.details.is_arranging_done) {
    triangulate();
    is_cut_later = !find_failed_patches(made.candidate.triangulated.meshes).empty();
    if (!is_cut_later) {
      outcome.is_arranged = arrange_faces();
      outcome.is_arranging_in_vain = !outcome.is_arranged;
      if (outcome.is_arranged) arranged_for_ = decisions.rungs;
      if (outcome.is_arranged) return Outcome::End::kSurfaceReplaced;
      if (decisions.rungs.are_any() && may_become_coarser(decisions)) {
        is_recognised_ = false;  // what was recognised has the numbers of patches that are gone
        return Outcome::End::kNothingCut;
      }
    }
  }
  const bool are_details_wanted = made.detail_limits.size > 0 && !decisions.details.are_done &&
                                  decisions.details.replaced.size() < kMaxDetailPasses;
  if (are_details_wanted) {
    triangulate();
    if (find_failed_patches(made.candidate.triangulated.meshes).empty()) {
      if (remove_details(decisions.mending.keep_verbatim)) {
        replaced_for_.push_back(decisions.rungs);
        return Outcome::End::kSurfaceReplaced;
      }
      outcome.are_details_done = true;
    }
  }
  // Beyond the 2018 report: find curved surfaces, and join their facets as far as that is asked for.
  made.watch.enter(Stage::kSurfaces);
  recognise(decisions.rungs, before);
  // Surfaces stay as they are once the ladder has begun.
  if (!is_cut_later && !decisions.rungs.are_any() && may_become_coarser(decisions)) {
    outcome.is_coarsened = coarsen_surface();
    if (outcome.is_coarsened) return Outcome::End::kSurfaceReplaced;
    outcome.is_coarsening_in_vain = true;
  }
  join(decisions.curved);
  // Triangles of facets stay if no facets were joined.
  if (made.joined.curved() != nullptr) made.candidate.clear();
  divided_for_ = Division{decisions.rungs, decisions.curved};
  return std::nullopt;
}

void Attempts::divide_by(const FaceRungs& rungs) {
  RunProducts& made = *products_;
  made.candidate.clear();
  rungs_ =
      SurfaceRungs(surface(), made.adjacency(), made.prepared.without_area, rungs, options().keep_boundary_vertices);
  if (!rungs.are_any()) {
    made.partition =
        make_partition(made.prepared, made.report.plane_tolerance, options(), rungs_, regions_, made.watch, control());
    return;
  }
  if (regions_.of_face.empty()) {
    divide_by({});
    return divide_by(rungs);
  }
  // Only faces on a rung get another region.
  Regions regions = regions_;
  for (FaceId f(0); f.value < surface().face_count(); ++f.value)
    if (std::any_of(surface().covered(f).begin(), surface().covered(f).end(),
                    [&](FaceId source) { return rungs.rung[source.value] > 0; }))
      regions.of_face[f] = RegionId();
  made.partition =
      make_partition(made.prepared, made.report.plane_tolerance, options(), rungs_, regions, made.watch, control());
}

/// Cuts faces that intersect, before details are looked for.
/// Output: false if all stays as it is.
bool Attempts::arrange_faces() {
  RunProducts& made = *products_;
  if (!made.input_intersections) made.find_input_intersections(Triangulated(surface(), control()));
  std::optional<Replaced> replaced =
      arranged_surface({made.read_input(), surface(), patches(), made.input.labels, made.report.plane_tolerance,
                        options().weld_tolerance, options().repair.make_union},
                       made.candidate, made.arranged, made.watch, control());
  if (!replaced) return false;
  made.report.plane_tolerance = replaced->plane_tolerance;
  made.detail_limits = detail_limits(options(), made.report.plane_tolerance);
  replace_surface(*std::move(replaced));
  return true;
}

/// Looks for details in the triangles of the patches, before facets are joined, and makes the triangles without them
/// the surface.
/// Output: false if all stays as it is.
bool Attempts::remove_details(const FaceMarks& kept) {
  RunProducts& made = *products_;
  if (!are_details_there(made.detail_limits, made.candidate.triangulated, surface(), made.adjacency(), control()))
    return false;
  if (!made.input_intersections) made.find_input_intersections(Triangulated(surface(), control()));
  std::optional<Replaced> replaced =
      without_details({made.read_input(), surface(), patches(), made.intersections(), made.report.plane_tolerance,
                       options().weld_tolerance, kept, made.spent.distance - made.arranged.distance},
                      made.candidate, made.detail_limits, made.removed, made.watch, control());
  if (!replaced) return false;
  const double plane_tolerance = replaced->plane_tolerance;
  replace_surface(*std::move(replaced));
  made.report.plane_tolerance = made.detail_limits.plane_tolerance = plane_tolerance;
  return true;
}

void Attempts::replace_surface(Replaced&& replaced) {
  RunProducts& made = *products_;
  made.candidate.clear();
  made.spent.add(replaced);
  made.prepared.change([&](Surface& surface) {
    surface = std::move(replaced.surface);
    return true;
  });
  made.prepared.without_area = std::move(replaced.without_area);
  control().memory().set_input(std::max(counted_faces(made.input), counted_faces(surface())));
  forget_surface();
}

/// Returns whether free surfaces may become coarser. They stay as they are where faces are copied verbatim.
bool Attempts::may_become_coarser(const Decisions& decisions) const {
  return free_goals_of(curved_goals_, options()) && !decisions.details.is_coarsening_done &&
         decisions.mending.keep_verbatim.empty() && products_->prepared.without_area.empty();
}

/// Makes the free faces of the surface coarser, if there are any.
/// Output: false if all stays as it is.
bool Attempts::coarsen_surface() {
  RunProducts& made = *products_;
  const auto& surfaces = made.recognised.surfaces;
  if (std::none_of(surfaces.begin(), surfaces.end(),
                   [](const RecognisedSurface& s) { return s.shape.kind == SurfaceKind::kFree; }))
    return false;
  if (!made.input_intersections) made.find_input_intersections(Triangulated(surface(), control()));
  if (!made.input_intersections->is_complete) return false;
  const FreeContext context{surface(),
                            made.adjacency(),
                            patches(),
                            made.recognised,
                            made.input_intersections->pairs,
                            options().feature_angle_deg};
  std::optional<Coarser> coarser =
      coarser_surface(context, *free_goals_of(curved_goals_, options()), made.coarsening, control());
  if (!coarser) return false;
  made.coarsening = std::move(coarser->done);
  replace_surface(std::move(coarser->replaced));
  return true;
}

/// Finds what the facets were made from. They are those of the input, before the ladder has split any.
/// Input: the facets before, for which the surfaces are known, if any are.
void Attempts::recognise(const FaceRungs& rungs, const PatchSet& before) {
  RunProducts& made = *products_;
  if (is_recognised_) return made.recognised.follow(before, patches());
  is_recognised_ = true;
  // Faces became coarser after surfaces were recognised, and these are still there.
  if (made.coarsening.is_done()) return made.recognised.follow(made.coarsening.surface_of, patches());
  if (rungs.are_any()) divide_by({});
  made.recognised = recognise_facets(made.partition, made.prepared, options(), made.report.plane_tolerance, control());
  if (!rungs.are_any()) return;
  const PatchSet facets = std::move(made.partition.patches);
  divide_by(rungs);
  made.recognised.follow(facets, patches());
}

void Attempts::join(const CurvedChoices& choices) {
  RunProducts& made = *products_;
  if (curved_goals_.tolerance || curved_goals_.may_have_elements())
    control().memory().set_output(options().max_output_faces.value_or(MemoryBound::kNone));
  made.joined = join_facets(
      made.partition, made.prepared, made.recognised, rungs_, choices, curved_goals_,
      {made.report.plane_tolerance, options().refine ? goals_.min_angle_deg : 0, goals_.faces_without_min_edge},
      control());
  const CurvedFacts curved{made.joined.curved() != nullptr, made.joined.finer_share(curved_goals_) > kMajority,
                           made.joined.outside ? kAngleMarginOfFit : 0};
  made.report.surfaces = std::move(made.joined.surfaces);
  made.refinement.emplace(goals_, curved, control());
}

/// Triangulates the patches, or brings their triangles back as they were before refinement.
void Attempts::triangulate() {
  RunProducts& made = *products_;
  made.watch.enter(Stage::kTriangulation);
  if (made.candidate.is_triangulated()) {
    made.candidate.undo_refinement();
  } else {
    const std::optional<CurvedBoundaries> boundaries = made.joined.boundaries();
    made.candidate.triangulated = mesh_patches(
        made.with_cuts(), made.adjacency(), patches(), made.partition.loops, made.partition.essential,
        {options().reference_axis, options().reference_direction}, control(), boundaries ? &*boundaries : nullptr);
  }
  count_output();
}

/// Counts the faces of the output for the bounds on memory, as far as there are any. A sample of sizes takes less room
/// than a face.
void Attempts::count_output() {
  const std::uint64_t samples = products_->refinement ? products_->refinement->sample_count() : 0;
  control().memory().set_output(std::max(products_->candidate.triangulated.triangle_count(), samples));
}

/// Tells which input faces the patches cover that failed, and which curved patches may be at fault.
void Attempts::report_failed(const std::vector<FailedPatch>& failed, Outcome& outcome) {
  RunProducts& made = *products_;
  for (const FailedPatch& patch : failed) {
    const auto faces = patches().faces_of(patch.patch);
    const bool is_single = faces.size() == 1;
    outcome.failed.push_back(
        {covered_by(surface(), faces), patch.reason, is_single, is_single && rungs_.is_face_kept(faces.front())});
    outcome.was_frozen.push_back(refined_.frozen.empty() ? 0 : refined_.frozen[patch.patch]);
  }
  outcome.are_any_crossing = !made.intersections().patches.empty();
  outcome.are_any_moved = made.joined.outside.has_value();
  outcome.was_any_joined = was_any_joined(options(), made.report.diagnostics);
  outcome.faults = made.joined.faults(failed, patches(), surface(), made.adjacency(), control());
}

/// Goes from the patches' triangles to a verdict.
Outcome::End Attempts::make_result(const Decisions& decisions, const Effort& effort, Outcome& outcome) {
  RunProducts& made = *products_;
  const RefinementChoices& choices = decisions.refinement;
  if (!made.input_intersections) made.find_input_intersections(Triangulated(surface(), control()));
  refined_ = {};
  outcome.facts = made.refinement->facts();
  if (const auto failed = find_failed_patches(made.candidate.triangulated.meshes); !failed.empty()) {
    report_failed(failed, outcome);
    return Outcome::End::kPatchesFailed;
  }
  if (choices.part == RefinedPart::kAll && made.joined.curved() == nullptr &&
      effort.is_in_vain(outcome.facts.expected_limit()))
    return Outcome::End::kWorkInVain;
  // No edge inside a patch may be the edge of another patch. (If refinement is tried again, this changes nothing.)
  made.candidate.flip_chords(made.with_cuts().vertex_count(), control());
  // All patches together: improve angles and sizes, and resolve the remaining conflicts between patches.
  if (const auto end = refine(choices, effort, outcome)) return *end;
  outcome.compared = made.joined.compare(
      triangles_of_patches(), patches(), surface(),
      made.joined.curved() != nullptr ? made.joined.patches.surfaces.of_patch : made.recognised.of_patch,
      decisions.curved, curved_goals_);
  if (outcome.compared.are_any()) return Outcome::End::kFacetsCoarser;
  if (const auto end = keep_volumes(decisions.curved, outcome)) return *end;
  made.watch.enter(Stage::kAssembly);
  const Goals goals = made.goals();
  assemble(made.candidate, made.with_cuts(), made.has_asked_goals() ? &goals : nullptr, control());
  const bool has_found_floor =
      goals.min_edge_length > choices.min_edge.asked() && outcome.facts.may_change_min_edge(choices);
  outcome.faces = made.candidate.assembled.faces.size();
  outcome.facts.over_target = over_target(made.candidate, goals);
  outcome.are_angles_worse = has_found_floor && has_worse_angles(made.candidate, surface(), made.with_cuts(),
                                                                 made.joined.curved(), goals, control());
  if (after_faces(choices, *outcome.faces, outcome.are_angles_worse, outcome.facts).is_repeated) {
    if (outcome.facts.may_change_min_edge(choices))
      outcome.facts.shortest_made = shortest_made(made.candidate, made.with_cuts().vertex_count(), control());
    return Outcome::End::kTooManyFaces;
  }
  refuse_if_too_large();
  check_candidate(choices, outcome);
  return report_check(outcome);
}

/// Improves angles and sizes, or only puts points into edges that exist twice.
/// Output: how the attempt ends, if that was all.
std::optional<Outcome::End> Attempts::refine(const RefinementChoices& choices, const Effort& effort, Outcome& outcome) {
  RunProducts& made = *products_;
  if (!made.has_goals() && !made.candidate.has_chords) return std::nullopt;
  made.watch.enter(Stage::kRefinement);
  if (!made.has_goals()) {
    separate_chords();
    return std::nullopt;
  }
  const InputIntersections crossing = made.intersections();
  refined_ = made.refinement->refine(made.patched(crossing), choices, effort, frozen_patches(choices.frozen),
                                     made.candidate.triangulated);
  made.size_steps = effort.size_steps + refined_.size_steps;
  outcome.size_steps = refined_.size_steps;
  outcome.max_in_vain = refined_.max_in_vain;
  outcome.facts = made.refinement->facts();
  outcome.facts.is_any_refined = std::find(refined_.frozen.begin(), refined_.frozen.end(), 0) != refined_.frozen.end();
  outcome.coarsest = refined_.coarsest;
  switch (refined_.end) {
    case RefinementAttempt::End::kRefined: break;
    case RefinementAttempt::End::kMinEdgeTooShort: return Outcome::End::kMinEdgeTooShort;
    case RefinementAttempt::End::kGapsTooFine: return Outcome::End::kGapsTooFine;
    case RefinementAttempt::End::kTooManyMade: return Outcome::End::kTooManyMade;
  }
  made.candidate.refinement = std::move(refined_.refinement);
  outcome.triangles = made.candidate.refinement.reason.size();
  lift();
  made.report.refinement_rounds = made.candidate.refinement.rounds;
  made.report.min_edge_length = choices.min_edge.min_edge_length();
  made.report.largest_edge_for_target = made.goals().has_target() ? made.goals().max_edge_length : 0;
  if (made.refinement->smallest_gap()) made.report.smallest_gap = made.refinement->smallest_gap();
  return std::nullopt;
}

/// Returns for each patch whether it stays as it is: faces without area do, and patches all of whose faces are marked.
IdVector<PatchId, std::uint8_t> Attempts::frozen_patches(const FaceMarks& frozen) {
  IdVector<PatchId, std::uint8_t> is_frozen(patches().count(), 0);
  StopCheck check(control());
  for (PatchId p(0); p.value < is_frozen.size(); ++p.value) {
    check();
    const auto faces = patches().faces_of(p);
    const auto is_marked = [&](FaceId f) { return are_marked(frozen, surface().covered(f)); };
    if (rungs_.is_face_kept(faces.front()) || (!frozen.empty() && std::all_of(faces.begin(), faces.end(), is_marked)))
      is_frozen[p] = 1;
  }
  return is_frozen;
}

/// Puts points into edges that exist twice.
void Attempts::separate_chords() {
  split_chords(products_->with_cuts(), products_->candidate.triangulated, products_->candidate.refinement, {},
               UnrefinedReason::kSizeFloor, control());
  lift();
}

void Attempts::lift() {
  count_output();
  Refinement& refinement = products_->candidate.refinement;
  lift_new_vertices(products_->with_cuts(), patches(), products_->candidate.triangulated, refinement.first_inner,
                    products_->report.plane_tolerance, refinement.new_positions, control());
}

std::vector<std::uint64_t> Attempts::triangles_of_patches() const {
  std::vector<std::uint64_t> triangles;
  for (const PatchMesh& patch : products_->candidate.triangulated.meshes)
    triangles.push_back(patch.mesh.triangle_count());
  return triangles;
}

/// Moves vertices so that the volumes of curved surfaces are kept, if that is asked for.
/// Output: how the attempt ends, if the surfaces have to be moved by other offsets first.
std::optional<Outcome::End> Attempts::keep_volumes(const CurvedChoices& choices, Outcome& outcome) {
  RunProducts& made = *products_;
  if (!made.joined.outside) return std::nullopt;
  Candidate& candidate = made.candidate;
  const FitInput fit{made.with_cuts(), patches(), *made.joined.curved(), *made.joined.outside, made.has_asked_goals()};
  FittedVolumes fitted = fit_volumes(fit, candidate.triangulated, candidate.refinement.new_positions, control());
  if (!fitted.impossible.empty()) {
    outcome.are_any_moved = true;
    outcome.faults = made.joined.faults_of(fitted.impossible, patches(), surface());
    return Outcome::End::kOffsetsImpossible;
  }
  if (!fitted.is_near && choices.offsets.is_better_estimate_worth_while()) {
    outcome.offsets = std::move(fitted.better);
    return Outcome::End::kOffsetsChanged;
  }
  const Goals goals = made.goals();
  // A triangle that just meets a goal may miss it by a little after this last correction.
  if (made.has_asked_goals()) assemble(candidate, made.with_cuts(), &goals, control());
  FittedVertices moved =
      move_to_fit(fit, fitted, candidate.triangulated, candidate.refinement.new_positions, control());
  if (made.has_asked_goals()) replace_reasons(candidate, moved.is_moved, UnrefinedReason::kEffort);
  candidate.moved = std::move(moved.places);
  for (SurfaceId s(0); s.value < fitted.offsets.size(); ++s.value)
    if (made.joined.outside->goals()[s].is_wanted) made.report.surfaces.surfaces[s].outside = fitted.outside[s];
  return std::nullopt;
}

void Attempts::refuse_if_too_large() const {
  const std::uint64_t faces = products_->candidate.assembled.faces.size();
  const std::uint64_t max = options().max_output_faces.value_or(faces);
  if (faces > max)
    throw Error(Code::kOutputTooLarge, Stage::kAssembly,
                "the result has " + std::to_string(faces) + " faces, more than allowed")
        .for_option("max_output_faces")
        .with_limit(max);
}

/// Runs the independent check of the promises. The check computes what it needs of the surface itself, or verifies it.
/// New vertices that have the same place are moved apart first, or if the check has failed.
void Attempts::check_candidate(const RefinementChoices& choices, Outcome& outcome) {
  RunProducts& made = *products_;
  made.prepared.free_all_but_order();
  made.watch.enter(Stage::kVerify);
  const InputIntersections known = made.intersections();
  const std::vector<CurvedClaim> curved_claims = claims_of(made.joined.curved(), curved_goals_);
  const Goals goals = made.goals();
  CheckedAgainst against{made.read_input(),
                         surface(),
                         patches(),
                         known,
                         made.report.plane_tolerance,
                         options().weld_tolerance,
                         made.has_asked_goals() ? &goals : nullptr,
                         made.joined.curved(),
                         curved_claims,
                         refined_.frozen.items(),
                         made.prepared.order()};
  const auto run = [&] {
    against.measure_sizes = nullptr;
    if (refined_.are_sizes_unmeasured)
      against.measure_sizes = [&](Candidate& candidate) {
        made.refinement->measure_sizes(made.patched(known), choices, refined_, candidate.refinement,
                                       candidate.triangulated);
        made.prepared.free_adjacency();
      };
    made.report.verified = check(made.candidate, against, control());
    outcome.search_steps += made.report.verified.search_steps;
    return made.report.verified.all_true();
  };
  // Vertices have the same place mostly where patches of the input cross or touch each other. The check takes too long
  // to find that out.
  if (!known.patches.empty()) separate_vertices(TwinsOf::kPatches);
  if (!run() && separate_vertices(TwinsOf::kSurface)) run();
}

/// Moves new vertices apart that have the same place.
/// Output: whether there are any that could be moved.
bool Attempts::separate_vertices(TwinsOf of) {
  RunProducts& made = *products_;
  const std::vector<std::uint8_t> is_moved =
      separate_new_vertices(made.with_cuts(), made.candidate.triangulated, made.candidate.refinement, of, control());
  if (is_moved.empty()) return false;
  refined_.are_sizes_unmeasured = refined_.may_measure_later;
  const Goals goals = made.goals();
  assemble_again(made.candidate, made.with_cuts(), made.has_asked_goals() ? &goals : nullptr, is_moved,
                 UnrefinedReason::kEffort, control());
  return true;
}

/// Tells what the check has found.
Outcome::End Attempts::report_check(Outcome& outcome) {
  const Verdict& verdict = products_->report.verified;
  if (verdict.all_true()) return Outcome::End::kVerified;
  std::vector<FailedPatch> failed;
  for (const PatchId p : verdict.failed_patches) failed.push_back({p, PatchReason::kVerificationFailed});
  // If the result as a whole is wrong, no single patch is at fault, so all patches are.
  outcome.is_whole_wrong = failed.empty();
  if (failed.empty())
    for (std::size_t p = 0; p < patches().count(); ++p)
      failed.push_back({PatchId(p), PatchReason::kVerificationFailed});
  if (!verdict.failures.empty()) outcome.reason = verdict.failures.front();
  report_failed(failed, outcome);
  return Outcome::End::kCheckFailed;
}

Error Attempts::failure(const Outcome& outcome) const {
  FaceMarks has_failed;
  for (const FailedFaces& patch : outcome.failed) mark(has_failed, patch.faces, outcome.input_faces);
  // If a face cannot be resolved at the mesh's scale, the input is at fault. Otherwise the fault is ours.
  FaceId first;
  for (FaceId f(0); f.value < surface().face_count(); ++f.value) {
    if (!are_marked(has_failed, surface().covered(f))) continue;
    if (is_unresolved(surface(), f)) return unresolved(surface(), f);
    if (!first.is_valid()) first = surface().covered(f).front();
  }
  const std::string reason = outcome.reason.empty() ? "the result failed its own check" : outcome.reason;
  if (!first.is_valid())
    return Error(Code::kVerificationFailed, Stage::kVerify, "no result passes verification: " + reason);
  return Error(Code::kVerificationFailed, Stage::kVerify,
               "face " + std::to_string(first.value) +
                   " could not be reproduced in a result that passes verification: " + reason)
      .at_element(first.value);
}

}  // namespace remesh
