#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "core/base/tolerance.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/quality.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/prediction.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"
#include "core/stages/assembly.h"
#include "core/stages/boundary_loops.h"
#include "core/stages/chords.h"
#include "core/stages/coplanar_regions.h"
#include "core/stages/duplicate_faces.h"
#include "core/stages/essential_vertices.h"
#include "core/stages/face_source.h"
#include "core/stages/findings.h"
#include "core/stages/ladder.h"
#include "core/stages/lifting.h"
#include "core/stages/mend_faces.h"
#include "core/stages/patch_meshing.h"
#include "core/stages/patch_summary.h"
#include "core/stages/patches.h"
#include "core/stages/refinement.h"
#include "core/stages/separation.h"
#include "core/stages/t_junctions.h"
#include "core/stages/unrefined.h"
#include "core/stages/weld.h"
#include "core/stages/winding.h"
#include "core/verify.h"
#include "core/volume_ready.h"

namespace remesh {
namespace {

/// Says where the run is, and keeps the time of each stage. A stage that is entered again adds to its time.
class Stopwatch {
 public:
  explicit Stopwatch(RunControl& control) : control_(control) {}

  void enter(Stage stage) {
    leave();
    control_.enter(stage);
    stage_ = stage;
    started_ = Clock::now();
  }
  std::vector<StageTime> finish() {
    leave();
    std::vector<StageTime> times;
    for (int s = 0; s < kStageCount; ++s)
      if (is_entered_[s]) times.push_back({static_cast<Stage>(s), ms_[s]});
    return times;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void leave() {
    if (stage_ == Stage::kQueued) return;
    ms_[static_cast<int>(stage_)] += std::chrono::duration<double, std::milli>(Clock::now() - started_).count();
    is_entered_[static_cast<int>(stage_)] = true;
    stage_ = Stage::kQueued;
  }

  RunControl& control_;
  Stage stage_ = Stage::kQueued;
  Clock::time_point started_;
  std::array<double, kStageCount> ms_{};
  std::array<bool, kStageCount> is_entered_{};
};

/// One run over one surface: what the stages hand to each other.
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

  Result remesh(bool want_face_source) {
    prepare();
    // Where even single faces fail, they are taken as they are: triangles, and zero-area faces beside them left alone.
    while (!climb()) prepare();
    return finish(want_face_source);
  }

  Report analyze() {
    prepare();
    Ladder ladder = make_ladder();
    find_patches(ladder);
    // Triangulated, but not kept: what refinement would make of it is told by its triangles.
    watch_.enter(Stage::kTriangulation);
    mesh_all_patches();
    examine_input();
    watch_.enter(Stage::kRefinement);
    const SizeField sizes = size_field();
    if (is_refined()) predicted_faces_ = static_cast<std::uint64_t>(predict(meshes_, goals_, sizes, control_).expected);
    if (goals_.proximity == 0)
      report_.smallest_gap =
          GapSearch(surface_, *adjacency_, patches_, report_.plane_tolerance, control_, meshes_).smallest(control_);
    summarise(ladder);
    report_.timing_ms = watch_.finish();
    return std::move(report_);
  }

 private:
  Ladder make_ladder() const {
    Ladder ladder(surface_);
    if (options_.keep_boundary_vertices) ladder.forced().assign(surface_.vertex_count(), 1);
    return ladder;
  }

  /// From patches to a verified mesh, by as many steps of the ladder as it takes. Output: false if some face fails
  /// alone; it is marked in `as_it_is_` then, and the surface has to be prepared again.
  bool climb() {
    Ladder ladder = make_ladder();
    bool is_first = true;
    while (true) {
      find_patches(ladder);
      // Every patch, in parallel: projection, lexicographic triangulation, flips, recovery of the loops, carving.
      watch_.enter(Stage::kTriangulation);
      mesh_all_patches();
      if (is_first) find_input_intersections(triangulated(surface_, control_));
      is_first = false;
      std::vector<FailedPatch> failed = failed_meshes();
      // The patches' triangles become one mesh, in which no edge inside a patch is the edge of another one.
      watch_.enter(Stage::kAssembly);
      if (failed.empty()) {
        has_chords_ = !flip_chords(meshes_, surface_.vertex_count(), control_);
        // All patches together: angles, sizes, what is left of conflicts between them.
        refine_patches(ladder);
        watch_.enter(Stage::kAssembly);
        assemble();
        if (is_over_budget()) continue;
        refuse_if_too_large();
        // The independent check of the promises.
        watch_.enter(Stage::kVerify);
        report_.verified = check();
        if (!report_.verified.all_true() && separate_new_vertices(surface_, meshes_, refinement_, control_)) {
          assemble();
          report_.verified = check();
        }
        if (report_.verified.all_true()) {
          if (is_as_manifold_as_input()) break;
          if (!give_up_t_junctions())
            throw Error(Code::kVerificationFailed, Stage::kVerify,
                        "faces on the same vertices have no triangulations that keep them apart");
          return false;
        }
        if (freeze(report_.verified.failed_patches)) continue;
        for (const PatchId p : report_.verified.failed_patches) failed.push_back({p, PatchReason::kVerificationFailed});
        // What is wrong with the whole is no single patch's: all of them take a step.
        if (failed.empty())
          for (std::size_t p = 0; p < patches_.count(); ++p)
            failed.push_back({PatchId(p), PatchReason::kVerificationFailed});
      }
      // A patch that failed takes a step of the ladder, and the round begins again.
      frozen_.clear();
      watch_.enter(Stage::kPatches);
      const std::vector<FaceId> stuck = ladder.step(patches_, loops_, *adjacency_, failed, regions_);
      if (!stuck.empty() && stuck.size() == count_faces(failed)) {
        take_as_they_are(stuck);
        return false;
      }
    }
    summarise(ladder);
    if (options_.refine) warn_of_curves();
    for (std::size_t p = 0; p < meshes_.size(); ++p) report_.patches[p].output_faces = meshes_[p].mesh.triangle_count();
    return true;
  }

  void mesh_all_patches() {
    meshes_ = mesh_patches(surface_, *adjacency_, patches_, loops_, essential_,
                           {options_.reference_axis, options_.reference_direction}, control_);
  }

  std::size_t count_faces(const std::vector<FailedPatch>& failed) const {
    std::size_t faces = 0;
    for (const FailedPatch& f : failed) faces += patches_.faces_of(f.patch).size();
    return faces;
  }

  /// Errors: kVerificationFailed - they have been taken so before.
  void take_as_they_are(const std::vector<FaceId>& stuck) {
    as_it_is_.resize(input_.face_count(), 0);
    bool is_new = false;
    for (const FaceId f : stuck) {
      const FaceId source = surface_.face_source[f];
      is_new = is_new || as_it_is_[source.value] == 0;
      as_it_is_[source.value] = 1;
    }
    if (is_new || give_up_t_junctions()) return;
    const FaceId source = surface_.face_source[stuck.front()];
    throw Error(
        Code::kVerificationFailed, Stage::kVerify,
        "face " + std::to_string(source.value) + " cannot be brought back so that the result holds: " + first_failure())
        .at_element(source.value);
  }

  /// Vertices that were put into faces where sheets nearly touch may be what keeps a result from holding. Output:
  /// whether there were such; they are left alone from now on.
  bool give_up_t_junctions() {
    const bool were_split = options_.repair.t_junctions && are_t_junctions_split_ &&
                            std::any_of(report_.diagnostics.begin(), report_.diagnostics.end(),
                                        [](const Diagnostic& d) { return d.code == DiagnosticCode::kTJunction; });
    are_t_junctions_split_ = false;
    return were_split;
  }

  /// From the mesh as read to a surface of which every face has a plane, and the tolerance that its coordinates ask
  /// for.
  void prepare() {
    // Vertices with equal coordinates, or nearly equal ones, become one.
    watch_.enter(Stage::kWeld);
    report_.diagnostics = diagnostics_of_reader_;
    regions_ = {};
    surface_ = weld(input_, options_.barriers, report_.diagnostics, control_, options_.weld_tolerance);
    find_edges();
    watch_.enter(Stage::kQuality);
    measure_input();
    watch_.enter(Stage::kWeld);
    choose_tolerance();
    goals_ = goals_of(options_, report_.input.bounding_box.diagonal());
    budget_ = goals_.max_faces;
    watch_.enter(Stage::kWeld);
    mend();
    geometry_ = face_geometry(surface_, control_);
    regions_.of_face.resize(surface_.face_count());
  }

  void mend() {
    const Repair& repair = options_.repair;
    std::vector<Diagnostic>& found = report_.diagnostics;
    // Faces that repeat others go, edges are split at the vertices that lie on them.
    if (drop_duplicate_faces(surface_, *adjacency_, mend_if(repair.duplicates), found, control_)) find_edges();
    if (split_t_junctions(surface_, *adjacency_, local_tolerance(), as_it_is_,
                          mend_if(repair.t_junctions && are_t_junctions_split_), found, control_))
      find_edges();
    count_edges();
    // Faces without a plane are split, faces without an area dropped; nothing opens. Where the cut of a polygon is
    // already an edge of others, whichever way it is cut, that edge has more faces now.
    if (mend_faces(surface_, local_tolerance(), as_it_is_, mend_if(repair.degenerate), found, control_)) {
      find_edges();
      non_manifold_edges_ = std::max(non_manifold_edges_, count_non_manifold_edges());
    }
    // Neighbours look the same way, closed pieces outwards if that is asked for.
    if (unify_winding(surface_, *adjacency_, mend_if(repair.winding), found, control_)) find_edges();
    if (turn_inside_out(surface_, *adjacency_, mend_if(repair.inside_out), found, control_)) find_edges();
  }

  /// What the faces' later mending must not make worse.
  void count_edges() {
    non_manifold_edges_ = count_non_manifold_edges();
    is_closed_ = true;
    for (std::uint32_t e = 0; e < adjacency_->edge_count(); ++e)
      is_closed_ = is_closed_ && (is_repeated_corner(EdgeId(e)) || adjacency_->half_edges(EdgeId(e)).size() == 2);
  }
  std::uint64_t count_non_manifold_edges() const {
    std::uint64_t count = 0;
    for (std::uint32_t e = 0; e < adjacency_->edge_count(); ++e)
      count += !is_repeated_corner(EdgeId(e)) && adjacency_->half_edges(EdgeId(e)).size() > 2;
    return count;
  }
  /// Such a corner is no edge.
  bool is_repeated_corner(EdgeId e) const {
    const std::uint32_t h = adjacency_->half_edges(e)[0];
    return adjacency_->from(h) == adjacency_->to(h);
  }

  /// Faces that intersect before anything is done to them, seen by patch.
  void find_input_intersections(const Triangulated& faces) {
    watch_.enter(Stage::kVerify);
    input_intersections_ = find_intersections(surface_, faces, patches_, simple_patches(), report_.plane_tolerance,
                                              report_.diagnostics, control_);
    report_.input.intersecting_pairs = input_intersections_.pairs.size();
  }

  /// Patches that cover nothing twice in their plane: their loops do not cross, and none of their faces is so thin that
  /// it may be turned over.
  std::vector<std::uint8_t> simple_patches() const {
    std::vector<std::uint8_t> is_simple;
    for (const PatchMesh& mesh : meshes_) is_simple.push_back(mesh.reason == PatchReason::kNone);
    for (std::size_t f = 0; f < surface_.face_count(); ++f)
      if (geometry_[FaceId(f)].height < kThinFace * local_tolerance()) is_simple[patches_.of_face[FaceId(f)].value] = 0;
    return is_simple;
  }

  void examine_input() {
    const Triangulated faces = triangulated(surface_, control_);
    find_input_intersections(faces);
    // Of a polygon one triangle stands for all.
    std::vector<std::pair<FaceId, FaceId>> pairs;
    const auto triangle_of = [&](FaceId f) {
      return FaceId(
          static_cast<std::size_t>(std::lower_bound(faces.face.begin(), faces.face.end(), f) - faces.face.begin()));
    };
    for (const auto& [f, g] : input_intersections_.pairs) pairs.push_back({triangle_of(f), triangle_of(g)});
    report_.volume_obstacles =
        find_volume_obstacles(surface_.positions.items(), faces.triangles, pairs, report_.plane_tolerance, control_);
  }

  InputIntersections intersecting_patches() const {
    InputIntersections known{{}, input_intersections_.is_complete};
    for (const auto& [f, g] : input_intersections_.pairs)
      known.patches.push_back(std::minmax({patches_.of_face[f], patches_.of_face[g]}));
    std::sort(known.patches.begin(), known.patches.end());
    known.patches.erase(std::unique(known.patches.begin(), known.patches.end()), known.patches.end());
    return known;
  }

  void find_edges() {
    control_.check();
    adjacency_ = std::make_unique<Adjacency>(surface_.vertex_count(), surface_.face_begin, surface_.corners);
  }

  /// Faces of one plane, their patches, the patches' loops, and the vertices that stay.
  void find_patches(Ladder& ladder) {
    watch_.enter(Stage::kRegions);
    coplanar_regions(
        surface_, *adjacency_, geometry_,
        {local_tolerance(), options_.normal_tolerance, &ladder.zone(), &ladder.rung(), printed_step_ / surface_.unit},
        regions_, control_);
    watch_.enter(Stage::kPatches);
    patches_ = patches(surface_, *adjacency_, regions_, control_);
    watch_.enter(Stage::kLoops);
    loops_ = boundary_loops(surface_, *adjacency_, patches_, control_);
    watch_.enter(Stage::kEssentialVertices);
    essential_ = essential_vertices(surface_, *adjacency_, patches_, ladder.forced(), local_tolerance(), control_);
  }

  double local_tolerance() const { return report_.plane_tolerance / surface_.unit; }

  void measure_input() {
    const auto& positions = surface_.positions.items();
    report_.input = measure_surface(positions, surface_.face_begin, surface_.corners, *adjacency_, control_);
    report_.input.vertices = input_.vertex_count();
    report_.input.faces = input_.face_count();
    const std::vector<Triangle> triangles = triangulated(surface_, control_).triangles;
    const bool are_all_triangles = surface_.corners.size() == 3 * surface_.face_count();
    report_.input.quality = are_all_triangles ? measure_quality(positions, triangles, *adjacency_, control_)
                                              : measure_quality(positions, triangles, control_);
    find_defects(surface_, *adjacency_, report_.diagnostics, control_);
  }

  void choose_tolerance() {
    const double diagonal = report_.input.bounding_box.diagonal();
    const Rounding rounding = rounding_of(surface_.positions.items());
    report_.rounding_step = rounding.step;
    printed_step_ = 0;
    report_.plane_tolerance_is_automatic = !options_.plane_tolerance.has_value();
    if (options_.plane_tolerance) {
      report_.plane_tolerance = *options_.plane_tolerance;
      return;
    }
    const AutomaticTolerance automatic = automatic_tolerance(report_.rounding_step, diagonal);
    report_.plane_tolerance = automatic.value;
    if (automatic.if_noisy != automatic.value &&
        is_noise_present(surface_, *adjacency_, face_geometry(surface_, control_), automatic.value / surface_.unit,
                         automatic.if_noisy / surface_.unit))
      report_.plane_tolerance = automatic.if_noisy;
    if (rounding.is_decimal && report_.plane_tolerance == kToleranceSteps * rounding.step)
      printed_step_ = rounding.step;
  }

  std::vector<FailedPatch> failed_meshes() const {
    std::vector<FailedPatch> failed;
    for (std::size_t p = 0; p < meshes_.size(); ++p)
      if (meshes_[p].reason != PatchReason::kNone) failed.push_back({PatchId(p), meshes_[p].reason});
    return failed;
  }

  bool is_refined() const {
    return goals_.min_angle_deg > 0 || std::isfinite(goals_.max_edge_length) || std::isfinite(goals_.max_area) ||
           goals_.proximity > 0;
  }

  void refine_patches(const Ladder& ladder) {
    refinement_ = {};
    if (!is_refined() && !has_chords_) return;
    watch_.enter(Stage::kRefinement);
    if (is_refined())
      reach_goals(ladder);
    else
      split_chords(surface_, patches_, meshes_, refinement_, control_);
    lift_new_vertices(surface_, patches_, meshes_, refinement_.first_inner, report_.plane_tolerance,
                      refinement_.new_positions, control_);
  }

  void reach_goals(const Ladder& ladder) {
    frozen_.resize(patches_.count(), 0);
    for (std::size_t p = 0; p < patches_.count(); ++p)
      if (ladder.is_kept(patches_.faces_of(PatchId(p))[0])) frozen_[p] = 1;
    const SizeField sizes = size_field();
    const Prediction prediction = predict(meshes_, goals_, sizes, control_);
    refuse_if_hopeless(prediction);
    predicted_faces_ = static_cast<std::uint64_t>(prediction.expected);
    Goals within_budget = goals_;
    within_budget.max_faces = budget_;
    refinement_ = refine(surface_, patches_, frozen_, within_budget, sizes, meshes_, control_);
    if (is_budget_too_small())
      std::fill(refinement_.reason.begin(), refinement_.reason.end(), UnrefinedReason::kBudget);
    report_.refinement_rounds = refinement_.rounds;
  }

  /// Before anything is allocated by it: what must have more faces than allowed is not begun.
  void refuse_if_hopeless(const Prediction& prediction) const {
    // Half-edges are numbered in 31 bits.
    constexpr std::uint64_t kMostFaces = std::uint64_t{1} << 29;
    const std::uint64_t most = std::min(goals_.max_faces, kMostFaces);
    if (prediction.least > static_cast<double>(most))
      throw Error(
          Code::kOutputTooLarge, Stage::kRefinement,
          "with these sizes the result has at least " + count_text(prediction.least) + " faces, more than allowed")
          .for_option("max_output_faces")
          .with_limit(most);
  }
  static std::string count_text(double count) {
    return count < 1e15 ? std::to_string(static_cast<std::uint64_t>(count)) : "10^15";
  }

  SizeField size_field() {
    if (goals_.proximity == 0 && goals_.gradation == 0) return SizeField(goals_.max_edge_length);
    std::unique_ptr<GapSearch> gaps;
    if (goals_.proximity > 0) {
      gaps = std::make_unique<GapSearch>(surface_, *adjacency_, patches_, report_.plane_tolerance, control_, meshes_);
      report_.smallest_gap = gaps->smallest(control_);
    }
    // With proximity it is the gaps' sizes that grow; around short segments the bound on angles sees to it. Alone,
    // gradation is about these.
    std::vector<std::array<VertexId, 2>> segments;
    if (!gaps) segments = segment_ends(meshes_);
    return SizeField(surface_, gaps.get(), segments, goals_, report_.plane_tolerance, control_);
  }

  static constexpr int kMostRetries = 6;
  bool is_budget_too_small() const { return retries_ > kMostRetries; }

  /// A refinement may overshoot its budget by what patches do for each other at the end: then it gets less, once or
  /// twice more.
  bool is_over_budget() {
    const std::uint64_t faces = assembled_.faces.size();
    if (!is_refined() || faces <= goals_.max_faces || retries_ > kMostRetries) return false;
    // Sizes on boundaries alone may be too much: then nothing is refined at all.
    if (++retries_ > kMostRetries) frozen_.assign(patches_.count(), 1);
    budget_ -= std::min(budget_, (faces - goals_.max_faces) * (std::uint64_t{1} << retries_));
    return true;
  }

  /// Patches whose refinement failed the check stay as they were before it. Returns whether that is a change.
  bool freeze(const std::vector<PatchId>& failed) {
    if (!is_refined()) return false;
    bool is_new = false;
    for (const PatchId p : failed) {
      is_new = is_new || frozen_[p.value] == 0;
      frozen_[p.value] = 1;
    }
    return is_new;
  }

  void assemble() {
    assembled_ = assembly(surface_.vertex_count() + refinement_.new_positions.size(), meshes_, control_);
    positions_.clear();
    positions_.reserve(assembled_.vertex.size());
    for (const VertexId v : assembled_.vertex)
      positions_.push_back(v.value < surface_.vertex_count()
                               ? surface_.positions[v]
                               : refinement_.new_positions[v.value - surface_.vertex_count()]);
    if (is_refined())
      unrefined_ = find_unrefined(positions_.items(), assembled_.faces.items(), refinement_.reason, goals_, control_);
  }

  void refuse_if_too_large() const {
    const std::uint64_t most = options_.max_output_faces.value_or(assembled_.faces.size());
    if (assembled_.faces.size() > most)
      throw Error(Code::kOutputTooLarge, Stage::kAssembly,
                  "the result has " + std::to_string(assembled_.faces.size()) + " faces, more than allowed")
          .for_option("max_output_faces")
          .with_limit(most);
  }

  Verdict check() {
    IdVector<PatchId, Frame> frames;
    frames.reserve(meshes_.size());
    for (const PatchMesh& mesh : meshes_) frames.push_back(mesh.frame);
    const RefinementClaim refined{goals_, unrefined_.faces, unrefined_.reasons};
    const InputIntersections intersections = intersecting_patches();
    return verify({surface_, patches_.of_face, frames, positions_.items(), assembled_.faces.items(),
                   assembled_.face_patch.items(), assembled_.corner_uv, report_.plane_tolerance,
                   !refinement_.new_positions.empty(), is_refined() ? &refined : nullptr, &intersections},
                  control_);
  }

  /// What is verified is the mended surface. Its mending must not have joined what the input keeps apart: a polygon
  /// that had to be split may have no diagonal that is not the edge of another face.
  bool is_as_manifold_as_input() const {
    const bool had_zero_area = std::any_of(report_.diagnostics.begin(), report_.diagnostics.end(),
                                           [](const Diagnostic& d) { return d.code == DiagnosticCode::kZeroAreaFace; });
    std::uint64_t non_manifold = 0;
    bool is_closed = true;
    for (std::uint32_t e = 0; e < adjacency_->edge_count(); ++e) {
      const std::size_t faces = adjacency_->half_edges(EdgeId(e)).size();
      non_manifold += faces > 2;
      is_closed = is_closed && faces == 2;
    }
    // A zero-area face hands vertices to edges, and so may divide one with three faces.
    return is_closed >= is_closed_ && (had_zero_area || non_manifold <= non_manifold_edges_);
  }

  std::string first_failure() const {
    return report_.verified.failures.empty() ? "the result failed its own check" : report_.verified.failures.front();
  }

  void summarise(const Ladder& ladder) {
    PatchSummaries summaries =
        summarise_patches(surface_, *adjacency_, geometry_, patches_, loops_, essential_, ladder, control_);
    report_.patches = std::move(summaries.patches);
    report_.predicted_faces = is_refined() ? predicted_faces_ : summaries.triangles;
    report_.volume_bound = summaries.volume_bound;
  }

  /// Where most facets are patches of their own, they stand for a curved surface, and a bound on angles or sizes in
  /// each of them makes many faces.
  void warn_of_curves() {
    Diagnostic warning{DiagnosticCode::kCurvedSurface, 0, {}, ""};
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      const auto faces = patches_.faces_of(PatchId(p));
      if (faces.size() == 1) warning.add(surface_.face_source[faces[0]].value);
    }
    if (2 * warning.count <= surface_.face_count() || surface_.face_count() < kFewFacets) return;
    warning.message = "most facets are patches of their own, as of a curved surface: refinement makes many faces there";
    report_.diagnostics.push_back(std::move(warning));
  }
  /// A dozen polygons are a polyhedron.
  static constexpr std::size_t kFewFacets = 50;

  Result finish(bool want_face_source) {
    Result result;
    watch_.enter(Stage::kQuality);
    result.mesh.positions = std::move(positions_);
    result.mesh.faces = std::move(assembled_.faces);
    result.face_patch = std::move(assembled_.face_patch);
    report_.output = measure_surface(result.mesh, control_);
    report_.output.intersecting_pairs = report_.verified.intersections.size();
    report_.volume_obstacles = find_volume_obstacles(result.mesh.positions.items(), result.mesh.faces.items(),
                                                     report_.verified.intersections, report_.plane_tolerance, control_);
    report_.unrefined = summarise_unrefined(unrefined_, result.mesh.positions.items(), result.mesh.faces.items());
    // Where each output face came from: the input face under its centroid, and what that one is labelled.
    watch_.enter(Stage::kAssembly);
    const IdVector<FaceId, FaceId> source =
        needs_source(want_face_source) ? face_source(surface_, patches_, meshes_, control_) : first_faces(result);
    result.mesh.labels = labels_of(input_.labels, source);
    if (want_face_source) {
      result.face_source = source;
      result.input_face_patch = patches_of_input();
    }
    report_.timing_ms = watch_.finish();
    result.report = std::move(report_);
    return result;
  }

  /// Where every label is a barrier, all faces of a patch are labelled alike, and any of them tells.
  bool needs_source(bool want_face_source) const {
    const FaceLabels& labels = input_.labels;
    const Barriers& barriers = options_.barriers;
    return want_face_source || (labels.object.is_used() && !barriers.object) ||
           (labels.group.is_used() && !barriers.group) || (labels.material.is_used() && !barriers.material);
  }

  IdVector<FaceId, FaceId> first_faces(const Result& result) const {
    IdVector<FaceId, FaceId> source;
    source.reserve(result.face_patch.size());
    for (const PatchId p : result.face_patch) source.push_back(surface_.face_source[patches_.faces_of(p)[0]]);
    return source;
  }

  IdVector<FaceId, PatchId> patches_of_input() const {
    IdVector<FaceId, PatchId> patch(input_.face_count());
    for (std::size_t f = surface_.face_count(); f-- > 0;)
      patch[surface_.face_source[FaceId(f)]] = patches_.of_face[FaceId(f)];
    return patch;
  }

  static FaceLabels labels_of(const FaceLabels& labels, const IdVector<FaceId, FaceId>& source) {
    FaceLabels out = labels;
    for (const auto set : {&FaceLabels::object, &FaceLabels::group, &FaceLabels::material}) {
      if (!(labels.*set).is_used()) continue;
      (out.*set).of_face.clear();
      (out.*set).of_face.reserve(source.size());
      for (const FaceId f : source) (out.*set).of_face.push_back((labels.*set).of_face[f]);
    }
    return out;
  }

  const PolygonMesh& input_;
  const Options& options_;
  RunControl& control_;
  const std::vector<Diagnostic> diagnostics_of_reader_;
  Stopwatch watch_;
  std::vector<std::uint8_t> as_it_is_;  ///< per input face: see mend_faces
  Report report_;
  Surface surface_;
  std::unique_ptr<Adjacency> adjacency_;
  IdVector<FaceId, FaceGeometry> geometry_;
  double printed_step_ = 0;            ///< that the tolerance comes from; 0: it has another origin
  bool are_t_junctions_split_ = true;  ///< false: that went wrong
  bool has_chords_ = false;            ///< edges in patches that are edges of others too, whatever is flipped
  bool is_closed_ = false;             ///< of the surface with its repeated faces and T-junctions mended
  std::uint64_t non_manifold_edges_ = 0;
  FoundIntersections input_intersections_;
  Regions regions_;
  PatchSet patches_;
  BoundaryLoops loops_;
  IdVector<VertexId, std::uint8_t> essential_;
  std::vector<PatchMesh> meshes_;
  Goals goals_{};
  std::vector<std::uint8_t> frozen_;  ///< per patch: not refined
  std::uint64_t predicted_faces_ = 0;
  std::uint64_t budget_ = 0;  ///< faces that refinement may make it
  int retries_ = 0;
  Refinement refinement_;
  Assembled assembled_;
  UnrefinedFaces unrefined_;
  IdVector<VertexId, Vec3> positions_;
};

/// Runs `work` on as many threads as the settings and the process (tbb::global_control) allow.
template <class Work>
auto in_arena(const RunSettings& settings, Work work) {
  const auto most = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  tbb::task_arena arena(std::clamp(settings.workers, 1, most));
  return arena.execute(work);
}

[[noreturn]] void invalid(const char* option, const std::string& what) {
  throw Error(Code::kInvalidOption, Stage::kQueued, std::string("option ") + option + " " + what).for_option(option);
}

}  // namespace

const char* version() { return REMESHD_VERSION; }

void check_options(const Options& options) {
  const auto positive = [](const std::optional<double>& value, const char* option) {
    if (value && !(*value > 0 && std::isfinite(*value))) invalid(option, "must be a number above 0");
  };
  if (options.min_angle_deg && !(*options.min_angle_deg >= 0 && *options.min_angle_deg <= 33))
    invalid("min_angle_deg", "must be from 0 to 33");
  if (options.min_angle_deg && options.max_radius_edge_ratio)
    invalid("max_radius_edge_ratio", "excludes min_angle_deg: give one of them");
  if (options.max_edge_length && options.max_edge_fraction)
    invalid("max_edge_fraction", "excludes max_edge_length: give one of them");
  // 1 / (2 sin 33 degrees), the contract's figure.
  constexpr double kLeastRatio = 0.918;
  if (options.max_radius_edge_ratio && !(*options.max_radius_edge_ratio >= kLeastRatio))
    invalid("max_radius_edge_ratio", "must be a number of at least 0.918 (33 degrees)");
  positive(options.max_edge_length, "max_edge_length");
  positive(options.max_edge_fraction, "max_edge_fraction");
  positive(options.max_area, "max_area");
  positive(options.min_edge_length, "min_edge_length");
  if (options.min_edge_length && options.max_edge_length && *options.min_edge_length > *options.max_edge_length)
    invalid("min_edge_length", "must not be above max_edge_length");
  positive(options.plane_tolerance, "plane_tolerance");
  if (!(options.proximity >= 0 && std::isfinite(options.proximity))) invalid("proximity", "must not be negative");
  if (options.gradation && !(*options.gradation > 1 && std::isfinite(*options.gradation)))
    invalid("gradation", "must be a number above 1");
  if (!(options.normal_tolerance >= 0 && options.normal_tolerance < 1))
    invalid("normal_tolerance", "must be from 0 to below 1");
  if (!(options.weld_tolerance >= 0 && std::isfinite(options.weld_tolerance)))
    invalid("weld_tolerance", "must not be negative");
  if (options.reference_axis == ReferenceAxis::kGiven &&
      (!is_finite(options.reference_direction) || options.reference_direction == Vec3{}))
    invalid("reference_axis", "must be a direction of finite numbers, not all 0");
}

Result remesh_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                      RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(
      settings, [&] { return Run(input, options, control, std::move(diagnostics)).remesh(settings.want_face_source); });
}

Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics) {
  check_options(options);
  return in_arena(settings, [&] { return Run(input, options, control, std::move(diagnostics)).analyze(); });
}

}  // namespace remesh
