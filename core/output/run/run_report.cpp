#include "core/output/run/run_report.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/parallel.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"
#include "core/output/report/face_count_explanation.h"
#include "core/output/report/volume_mesher_check.h"
#include "core/output/report/warnings.h"
#include "core/output/result/face_labels.h"
#include "core/output/result/face_source.h"
#include "core/output/result/round_for_format.h"
#include "core/output/run/free_part.h"
#include "core/output/run/free_stage.h"
#include "core/output/run/free_tolerance.h"
#include "core/patches/curved/curved_goals.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/prediction/curved_prediction.h"
#include "core/refinement/sizes/gap_search.h"

namespace remesh {
namespace {

/// Takes the distances that were proven into the report.
/// Input: `of_stages` is the distance that stages have spent which replaced the whole surface; `unit` is the number of
///        model units in a local one.
void take_bounds(Report& report, double of_stages, const Coarsening& coarsening, const PatchSet& patches, double unit) {
  DistanceBound bound{report.verified.distance_bound.output_to_input + of_stages,
                      report.verified.distance_bound.input_to_output + of_stages};
  report.verified.deviation += of_stages;
  for (std::size_t p = 0; p < report.patches.size(); ++p) {
    report.patches[p].bound = report.verified.patch_bounds[p] + of_stages;
    // Faces that were made coarser are farther away by that. They are flat, and their borders were not cut again. (The
    // border of a plane may have been, but only where it is still that of the input.)
    const auto faces = patches.faces_of(PatchId(p));
    if (coarsening.is_done() &&
        std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return coarsening.is_new[f] != 0; })) {
      const double coarser = of_stages + coarsening.distance + unit * patches.deviation[PatchId(p)];
      report.patches[p].bound = std::max(report.patches[p].bound, coarser);
      bound = {std::max(bound.output_to_input, coarser), std::max(bound.input_to_output, coarser)};
      report.verified.deviation = std::max(report.verified.deviation, coarser);
    }
    double& of_surface = report.surfaces.surfaces[report.surfaces.of_patch[PatchId(p)]].bound;
    of_surface = std::max(of_surface, report.patches[p].bound);
  }
  report.distance_bound = bound;
}

/// Writes the report of a run.
class RunReporter {
 public:
  explicit RunReporter(std::unique_ptr<RunProducts> run) : products_(std::move(run)), run_(*products_) {}

  Report analysis(std::optional<MadeFaces> made) {
    examine_input();
    run_.report.surfaces.join_bands();
    run_.watch.enter(Stage::kRefinement);
    crossing_ = run_.intersections();
    const Prediction predicted =
        run_.refinement->predict_before(run_.patched(crossing_), run_.choices, run_.candidate.triangulated, made);
    run_.report.min_edge_length = run_.choices.min_edge.min_edge_length();
    run_.report.largest_edge_for_target = run_.goals().has_target() ? run_.goals().max_edge_length : 0;
    predict_free();
    report_curves({[&](PatchId p) {
                     return run_.has_goals()
                                ? predicted.of_patch[p.value]
                                : static_cast<double>(run_.partition.summaries.patches[p.value].output_faces);
                   },
                   RefinedFaces::Are::kPredicted});
    report_coarsened_surfaces(run_.surface(), run_.partition.patches, run_.joined.curved(),
                              RefinedFaces::Are::kPredicted, run_.report);
    run_.report.predicted_faces_by_elements_per_circle = predict_for_circles(predicted.of_patch);
    report_face_count(RefinedFaces::Are::kPredicted, predicted.of_patch);
    // Facets count, not the patches that were joined from them, so proximity does not change the answer.
    if (run_.joined.curved() == nullptr) run_.report.smallest_gap = run_.refinement->smallest_gap();
    if (!run_.report.smallest_gap)
      run_.report.smallest_gap =
          GapSearch(run_.surface(), run_.adjacency(), run_.facets(), run_.report.plane_tolerance, run_.control,
                    run_.joined.curved() != nullptr ? nullptr : &run_.candidate.triangulated)
              .smallest(run_.control, run_.goals().max_faces_looked_for());
    run_.report.predicted_faces = made || run_.has_goals()
                                      ? static_cast<std::uint64_t>(std::min(std::round(predicted.expected), 0x1p62))
                                      : run_.partition.summaries.triangles;
    summarise();
    report_removal();
    run_.report.timing_ms = run_.watch.finish();
    return std::move(run_.report);
  }

  /// Completes the report after the result has passed verification.
  void remeshing() {
    crossing_ = run_.intersections();
    std::vector<float> faces;
    for (const PatchMesh& patch : run_.candidate.triangulated.meshes)
      faces.push_back(static_cast<float>(patch.mesh.triangle_count()));
    // Other options are predicted for the triangles as they were before refinement.
    run_.candidate.refinement.before.exchange_with(run_.candidate.triangulated.meshes);
    report_face_count(RefinedFaces::Are::kCounted, faces);
    run_.candidate.refinement.before.exchange_with(run_.candidate.triangulated.meshes);
    run_.candidate.refinement.before.clear();
    summarise();
    run_.report.volume_bound = run_.report.verified.volume_bound + run_.spent.volume;
    take_bounds(run_.report, run_.spent.distance, run_.coarsening, run_.partition.patches, run_.surface().unit);
    report_removal();
    report_details_left(run_.detail_limits, run_.candidate, run_.partition.patches, run_.surface(),
                        run_.report.diagnostics, run_.control);
    run_.report.surfaces.join_bands();
    for (std::size_t p = 0; p < run_.candidate.triangulated.meshes.size(); ++p)
      run_.report.patches[p].output_faces = run_.candidate.triangulated.meshes[PatchId(p)].mesh.triangle_count();
    run_.prepared.free_derived();
    report_curves({[&](PatchId p) { return static_cast<double>(run_.report.patches[p.value].output_faces); }});
    if (!run_.report.verified.are_all_intersections_known) warn_of_many_intersections(run_.report.diagnostics);
  }

  /// Makes the result of what is verified, rounds it for its format, and measures the rounded result.
  Result result(const RunSettings& settings) {
    Result result;
    result.mesh.positions = std::move(run_.candidate.positions);
    result.rounding_input = rounding_input_of(result.mesh.positions);
    result.mesh.faces = std::move(run_.candidate.assembled.faces);
    result.face_patch = std::move(run_.candidate.assembled.face_patch);
    result.report = std::move(run_.report);
    // Everything from here on is about the coordinates that the output format holds.
    if (settings.rounding != OutputRounding::kLater)
      result.is_not_held = round_for_format(settings.storage, run_.options.local_origin, settings.rounding, result,
                                            run_.control) == Rounded::kNotHeld;
    run_.watch.enter(Stage::kQuality);
    const bool are_sources_needed =
        settings.want_face_source || do_labels_need_sources(run_.input.labels, run_.options.barriers);
    IdVector<FaceId, FaceId> source;
    // The two tasks have serial parts that do not depend on each other, so they run at the same time.
    do_all(
        result.mesh.faces.size(), [&] { measure_output(result, run_.control); },
        [&] {
          // The source of each output face is the input face under its centroid.
          source = are_sources_needed
                       ? face_source(run_.surface(), run_.partition.patches, run_.candidate.triangulated, run_.control)
                       : first_faces(run_.surface(), run_.partition.patches, result.face_patch);
          run_.candidate.clear();
        });
    run_.watch.enter(Stage::kAssembly);
    report_coarsened_surfaces(run_.surface(), run_.partition.patches, run_.joined.curved(), RefinedFaces::Are::kCounted,
                              result.report);
    result.mesh.labels = labels_from(run_.input.labels, source);
    if (settings.want_face_source) {
      result.face_source = source;
      result.input_face_patch = patches_of_input(run_.surface(), run_.partition.patches, run_.input.face_count());
    }
    result.report.timing_ms = run_.watch.finish();
    return result;
  }

 private:
  void examine_input() {
    const Triangulated faces(run_.surface(), run_.control);
    if (!run_.input_intersections) run_.find_input_intersections(faces);
    // The first triangle of a polygon stands for the polygon.
    std::vector<std::pair<FaceId, FaceId>> pairs;
    for (const auto& [f, g] : run_.input_intersections->pairs)
      pairs.push_back({FaceId(faces.first_of(f)), FaceId(faces.first_of(g))});
    const auto begins = triangle_begins(faces.corners().size() / 3, run_.control);
    const Adjacency edges(run_.surface().vertex_count(), begins, faces.corners(), run_.control);
    std::vector<FaceId> source;
    source.reserve(faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t) source.push_back(run_.surface().face_source[faces.face(t)]);
    const BodyLabels labels = labels_of_sources(run_.input.labels, source, run_.control);
    run_.report.volume_obstacles = find_volume_obstacles(run_.surface().positions.items(), faces.corners(), edges,
                                                         labels, pairs, run_.report.plane_tolerance, run_.control);
    add_incomplete_check(run_.input_intersections->searched, faces.size(), run_.report.volume_obstacles);
  }

  FreeAdvice free_advice() const {
    FreeAdvice advice{!run_.coarsening.is_done(), false, std::nullopt};
    if (free_ && free_->predicted.contains(kAdvisedElements)) advice.faces = free_->predicted.at(kAdvisedElements);
    const double diagonal = run_.report.input.bounding_box.diagonal();
    advice.may_be_coarser = may_become_coarser() &&
                            !free_goals_of(curved_goals_of(run_.options, diagonal), run_.options) &&
                            free_goals_with(kAdvisedElements).has_value();
    return advice;
  }

  /// Returns whether nothing keeps free faces from becoming coarser but the options, as far as is known.
  bool may_become_coarser() const {
    return !run_.coarsening.is_done() && run_.coarsening.fault == CoarseningFault::kNone &&
           run_.input_intersections->is_complete && run_.prepared.without_area.empty();
  }

  /// Returns the goals for free faces with another number of elements per circle; empty if it changes nothing.
  std::optional<FreeGoals> free_goals_with(int elements) const {
    Options with_circles = run_.options;
    with_circles.elements_per_circle = elements;
    return free_goals_of(curved_goals_of(with_circles, run_.report.input.bounding_box.diagonal()), with_circles);
  }

  /// Tells which curved surfaces are refined facet by facet.
  void report_curves(const RefinedFaces& refined) {
    if (run_.coarsening.is_done())
      run_.report.diagnostics.push_back(coarsening(run_.coarsening, run_.surface(), run_.options));
    else if (run_.coarsening.fault != CoarseningFault::kNone)
      run_.report.diagnostics.push_back(no_coarsening(run_.coarsening));
    if (!run_.options.refine) return;
    if (run_.options.feature_angle_deg > 0)
      warn_of_curved_surfaces(run_.surface(), run_.partition.patches, run_.report.surfaces, refined,
                              run_.report.diagnostics, run_.joined.curved(), free_advice());
    else
      warn_of_curves(run_.surface(), run_.partition.patches, run_.report.diagnostics);
  }

  /// Predicts the faces for other numbers of elements per circle.
  /// Input: the faces that there are, or that are predicted, of each patch; empty if nothing is refined.
  std::map<int, std::uint64_t> predict_for_circles(const std::vector<float>& faces) {
    PresentPatches present{run_.partition.patches,
                           run_.partition.essential,
                           run_.joined.cuts,
                           {},
                           {},
                           run_.choices.min_edge.min_edge_length()};
    for (PatchId p(0); p.value < present.patches.count(); ++p.value) {
      present.triangles.push_back(static_cast<double>(run_.candidate.triangulated.meshes[p].mesh.triangle_count()));
      present.faces.push_back(!faces.empty()
                                  ? faces[p.value]
                                  : static_cast<double>(run_.partition.summaries.patches[p.value].output_faces));
    }
    const FreeFaces& free = predict_free();
    double present_free = 0;
    for (PatchId p(0); p.value < present.patches.count() && !free.predicted.empty(); ++p.value) {
      if (free.roles[present.patches.faces_of(p)[0]] != FaceRole::kFree) continue;
      present_free += present.faces[p.value];
      present.faces[p.value] = present.triangles[p.value] = 0;
    }
    std::map<int, std::uint64_t> predicted =
        predict_by_elements_per_circle({run_.surface(), run_.adjacency(), run_.facets(), run_.recognised,
                                        run_.report.plane_tolerance, run_.report.input.bounding_box.diagonal()},
                                       present, run_.options, run_.control);
    if (free.predicted.empty() || !(present_free > 0)) return predicted;
    const double others = std::accumulate(present.faces.begin(), present.faces.end(), 0.0);
    const double beside = faces_beside_free(present, free.roles);
    for (const auto& [elements, faces] : free.predicted) {
      const auto entry = predicted.try_emplace(elements, static_cast<std::uint64_t>(others)).first;
      // Borders of free faces get as much coarser as their edges.
      const double now = std::min(present_free, faces), less = beside * (1 - std::sqrt(now / present_free));
      entry->second = static_cast<std::uint64_t>(std::max(1.0, static_cast<double>(entry->second) - less + now));
    }
    return predicted;
  }

  /// Estimates how many faces of other patches there are because of borders with free faces. Their share of a patch is
  /// that of the vertices on these borders, of all vertices that stay on its border.
  double faces_beside_free(const PresentPatches& present, const FilledIdVector<FaceId, FaceRole>& roles) {
    const Adjacency& adjacency = run_.adjacency();
    const PatchSet& patches = present.patches;
    StopCheck check(run_.control);
    IdVector<PatchId, double> border(patches.count(), 0), beside_free = border;
    for (std::uint32_t h = 0; h < run_.surface().corners.size(); ++h) {
      check();
      if (!is_patch_boundary(adjacency, patches, h) || !present.essential[adjacency.from(h)]) continue;
      const PatchId p = patches.of_face[adjacency.face_of(h)];
      const std::uint32_t twin = adjacency.twin(h);
      border[p] += 1;
      if (twin != kNone && roles[adjacency.face_of(twin)] == FaceRole::kFree) beside_free[p] += 1;
    }
    double beside = 0;
    for (PatchId p(0); p.value < patches.count(); ++p.value)
      if (border[p] > 0) beside += present.faces[p.value] * beside_free[p] / border[p];
    return beside;
  }

  /// Holds what other numbers of elements per circle make of the free faces.
  struct FreeFaces {
    FilledIdVector<FaceId, FaceRole> roles;
    /// One number for each of kPredictedElements. It is empty if these make nothing coarser.
    std::map<int, double> predicted;
  };

  const FreeFaces& predict_free() {
    if (free_) return *free_;
    FreeFaces& free = free_.emplace();
    std::optional<FreeGoals> goals = free_goals_with(kPredictedElements.front());
    // Sizes that vary may ask for more faces than anything else.
    const bool are_sizes_known = !(run_.options.proximity > 0) && !run_.options.gradation;
    if (!goals || !may_become_coarser() || !are_sizes_known || run_.recognised.of_patch.empty()) return free;
    const double unit = run_.surface().unit;
    if (goals->tolerance) *goals->tolerance /= unit;
    const FreeContext context{run_.surface(),
                              run_.adjacency(),
                              run_.facets(),
                              run_.recognised,
                              run_.input_intersections->pairs,
                              run_.options.feature_angle_deg};
    const Triangulated triangles(run_.surface(), run_.control);
    free.roles = roles_of(context, triangles, run_.control);
    const FreePart part(context, triangles, free.roles, run_.control);
    if (part.is_empty()) return free;
    const Goals sizes = run_.goals();
    const double longest = std::min(sizes.max_edge_length, equilateral_edge(sizes.max_area)) / unit;
    const std::vector<double> faces = predicted_free_faces(part, *goals, kPredictedElements, longest, run_.control);
    for (std::size_t i = 0; i < faces.size(); ++i) free.predicted[kPredictedElements[i]] = faces[i];
    return free;
  }

  /// Tells why there are far more faces than in the input, if so.
  /// Input: the patches' triangles as they were before refinement; surfaces before bands were joined.
  void report_face_count(RefinedFaces::Are are, const std::vector<float>& faces) {
    if (!run_.has_asked_goals()) return;
    const Goals goals = run_.goals();
    const std::vector<UnrefinedReason>& reasons = run_.candidate.unrefined.reasons;
    const auto is_left_by_floor = [](UnrefinedReason r) {
      return r == UnrefinedReason::kSizeFloor || r == UnrefinedReason::kMinEdgeLength;
    };
    const CurvedPatches* const curved = run_.joined.curved();
    explain_face_count({run_.surface(),
                        run_.partition.patches,
                        {[&](PatchId p) { return faces[p.value]; }, are},
                        run_.triangles_of_input(),
                        run_.report.input.bounding_box.diagonal(),
                        run_.options,
                        goals,
                        static_cast<std::uint64_t>(std::count_if(reasons.begin(), reasons.end(), is_left_by_floor)),
                        [&](PatchId p) {
                          const SurfaceKind kind =
                              run_.report.surfaces.surfaces[run_.report.surfaces.of_patch[p]].shape.kind;
                          const bool is_joined = curved != nullptr && curved->of(p) != nullptr;
                          return !is_joined && kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree;
                        },
                        [&](const Goals& other) {
                          return run_.refinement->predict_with(other, run_.patched(crossing_), run_.size_steps,
                                                               run_.candidate.triangulated);
                        },
                        [&] { return predict_for_circles(faces); }},
                       run_.report.diagnostics);
  }

  void summarise() {
    run_.report.patches = std::move(run_.partition.summaries.patches);
    if (run_.spent.stages > 0) count_input_faces();
    run_.report.volume_bound = run_.partition.summaries.volume_bound;
  }

  /// Counts the input's faces of each patch, where the surface has others.
  void count_input_faces() {
    for (PatchSummary& patch : run_.report.patches) patch.input_faces = 0;
    for (const PatchId p : patches_of_input(run_.surface(), run_.partition.patches, run_.input.face_count()))
      if (p.is_valid()) ++run_.report.patches[p.value].input_faces;
  }

  void report_removal() {
    if (run_.arranged.is_done) run_.report.solids = run_.arranged.counts;
    report_arrangement(run_.arranged, run_.report.diagnostics);
    const int others = (run_.coarsening.is_done() ? 1 : 0) + (run_.arranged.is_done ? 1 : 0);
    if (run_.spent.stages > others)
      run_.report.diagnostics.push_back(
          removal(run_.removed, run_.detail_limits.size, run_.spent.distance - run_.arranged.distance));
  }

  /// Where a surface was made coarser, its sharp corners are not those of the input.
  void excuse_by_tolerance(UnrefinedFaces& unrefined) const {
    if (!run_.coarsening.is_done()) return;
    const auto& surfaces = run_.report.surfaces;
    for (std::size_t i = 0; i < unrefined.faces.size(); ++i) {
      UnrefinedReason& reason = unrefined.reasons[i];
      if (reason != UnrefinedReason::kInputAngle && reason != UnrefinedReason::kAcrossInputAngle) continue;
      const PatchId p = run_.candidate.assembled.face_patch[unrefined.faces[i]];
      const auto faces = run_.partition.patches.faces_of(p);
      const bool is_new =
          std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return run_.coarsening.is_new[f] != 0; });
      if (is_new && surfaces.surfaces[surfaces.of_patch[p]].shape.kind == SurfaceKind::kFree)
        reason = UnrefinedReason::kSurfaceTolerance;
    }
  }

  RoundingInput rounding_input_of(const IdVector<VertexId, Vec3>& positions) {
    RoundingInput basis;
    basis.normals = run_.candidate.triangulated.charts.normals(run_.control);
    if (const CurvedPatches* curved = run_.joined.curved())
      for (const std::uint32_t at : curved->at) basis.is_curved.push_back(at == kNone ? 0 : 1);
    // The input's bounding box may have corners of faces that were dropped.
    Box3 box;
    for (const Vec3& p : positions) box.add(p);
    basis.allowed_move = std::max(run_.report.plane_tolerance, kAllowedRounding * box.diagonal());
    basis.is_refined = run_.has_asked_goals();
    basis.goals = run_.goals();
    basis.unrefined = std::move(run_.candidate.unrefined);
    excuse_by_tolerance(basis.unrefined);
    basis.intersections =
        patches_that_still_intersect(run_.intersections(), run_.report.verified, run_.candidate.assembled.face_patch);
    basis.patch_labels = labels_of_patches(run_.input.labels, run_.surface(), run_.partition.patches, run_.control);
    return basis;
  }

  const std::unique_ptr<RunProducts> products_;
  RunProducts& run_;               ///< the same
  InputIntersections crossing_;    ///< the patches that cross each other in the input
  std::optional<FreeFaces> free_;  ///< once they are predicted
};

}  // namespace

Report make_analysis(std::unique_ptr<RunProducts> run, std::optional<MadeFaces> made) {
  return RunReporter(std::move(run)).analysis(std::move(made));
}

Result make_result(std::unique_ptr<RunProducts> run, const RunSettings& settings) {
  RunReporter reporter(std::move(run));
  reporter.remeshing();
  return reporter.result(settings);
}

}  // namespace remesh
