#include "core/remesh.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/diagnostic.h"
#include "core/base/drop.h"
#include "core/base/parallel.h"
#include "core/base/stoppable.h"
#include "core/base/stopwatch.h"
#include "core/base/tolerance.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_reason.h"
#include "core/geometry/patch_set.h"
#include "core/mending/body_labels.h"
#include "core/mending/preparation.h"
#include "core/mending/resolution.h"
#include "core/mending/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"
#include "core/output/assembly.h"
#include "core/output/face_source.h"
#include "core/output/output_form.h"
#include "core/output/volume_ready.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/coplanar_regions.h"
#include "core/patches/essential_vertices.h"
#include "core/patches/input_intersections.h"
#include "core/patches/ladder.h"
#include "core/patches/patch_meshing.h"
#include "core/patches/patches.h"
#include "core/refinement/chords.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goal_refinement.h"
#include "core/refinement/lifting.h"
#include "core/refinement/rounds.h"
#include "core/refinement/separation.h"
#include "core/refinement/unrefined.h"
#include "core/refinement/unrefined_reason.h"
#include "core/verify/verdict.h"
#include "core/verify/verify.h"

namespace remesh {
namespace {

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
  ~Run() { drop_all(meshes_); }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  Result remesh(const RunSettings& settings) {
    prepare();
    // Where even single faces fail, they are taken as they are: triangles, and zero-area faces beside them left alone.
    while (!climb()) prepare();
    return finish(settings);
  }

  Report analyze() {
    prepare();
    Ladder ladder = make_ladder();
    find_patches(ladder);
    // Triangulated, but not kept: what refinement would make of it is told by its triangles.
    watch_.enter(Stage::kTriangulation);
    mesh_all_patches();
    examine_input();
    warn_of_curves();
    watch_.enter(Stage::kRefinement);
    refiner_->predict_faces(patched(), meshes_);
    report_.smallest_gap = refiner_->smallest_gap();
    if (!report_.smallest_gap)
      report_.smallest_gap =
          GapSearch(surface(), adjacency(), patches_, report_.plane_tolerance, control_, meshes_).smallest(control_);
    summarise();
    report_.timing_ms = watch_.finish();
    return std::move(report_);
  }

 private:
  const Surface& surface() const { return prepared_.surface; }
  const Adjacency& adjacency() { return prepared_.adjacency(control_); }
  const FaceGeometries& geometry() { return prepared_.geometry(control_); }
  PatchedSurface patched() { return {surface(), adjacency(), patches_, report_.plane_tolerance}; }

  void prepare() {
    InputSummary summary;
    summary.diagnostics = diagnostics_of_reader_;
    prepared_ = remesh::prepare(input_, options_, limits_, summary, watch_, control_);
    report_.input = std::move(summary.statistics);
    report_.plane_tolerance = summary.plane_tolerance;
    report_.plane_tolerance_is_automatic = summary.plane_tolerance_is_automatic;
    report_.rounding_step = summary.rounding_step;
    report_.diagnostics = std::move(summary.diagnostics);
    regions_ = {};
    const double diagonal = report_.input.bounding_box.diagonal();
    check_options(options_, diagonal);
    refiner_.emplace(goals_of(options_, diagonal), control_);
  }

  Ladder make_ladder() {
    Ladder ladder(surface(), prepared_.without_area);
    if (options_.keep_boundary_vertices) ladder.forced().assign(surface().vertex_count(), 1);
    return ladder;
  }

  /// From patches to a verified mesh, by as many steps of the ladder as it takes. Output: false if some face fails
  /// alone; it is marked in `limits_` then, and the surface has to be prepared again.
  bool climb() {
    Ladder ladder = make_ladder();
    bool is_first = true;
    while (true) {
      find_patches(ladder);
      // Every patch, in parallel: projection, lexicographic triangulation, flips, recovery of the loops, carving.
      watch_.enter(Stage::kTriangulation);
      mesh_all_patches();
      if (is_first) find_input_intersections(Triangulated(surface(), control_));
      is_first = false;
      std::vector<FailedPatch> failed = failed_meshes();
      // The patches' triangles become one mesh, in which no edge inside a patch is the edge of another one.
      watch_.enter(Stage::kAssembly);
      if (failed.empty()) {
        has_chords_ = !flip_chords(meshes_, surface().vertex_count(), control_);
        // All patches together: angles, sizes, what is left of conflicts between them.
        refine_patches(ladder);
        watch_.enter(Stage::kAssembly);
        assemble();
        if (refiner_->is_over_budget(assembled_.faces.size())) continue;
        refuse_if_too_large();
        summarise();
        // The independent check of the promises. It makes what it needs of the surface itself, or checks it.
        prepared_.release_all_but_order();
        watch_.enter(Stage::kVerify);
        report_.verified = check();
        if (!report_.verified.all_true() && separate_new_vertices(surface(), meshes_, refinement_, control_)) {
          assemble();
          report_.verified = check();
        }
        if (report_.verified.all_true()) break;
        if (refiner_->freeze(report_.verified.failed_patches)) continue;
        for (const PatchId p : report_.verified.failed_patches) failed.push_back({p, PatchReason::kVerificationFailed});
        // What is wrong with the whole is no single patch's: all of them take a step.
        if (failed.empty())
          for (std::size_t p = 0; p < patches_.count(); ++p)
            failed.push_back({PatchId(p), PatchReason::kVerificationFailed});
      }
      // A patch that failed takes a step of the ladder, and the round begins again.
      refiner_->thaw();
      watch_.enter(Stage::kPatches);
      const std::vector<FaceId> stuck = ladder.step(patches_, loops_, adjacency(), failed, regions_);
      if (!stuck.empty() && stuck.size() == count_faces(failed)) {
        take_as_they_are(stuck);
        return false;
      }
    }
    report_.volume_bound = report_.verified.volume_bound;
    prepared_.release();
    warn_of_curves();
    warn_of_many_intersections();
    for (std::size_t p = 0; p < meshes_.size(); ++p) report_.patches[p].output_faces = meshes_[p].mesh.triangle_count();
    return true;
  }

  void mesh_all_patches() {
    meshes_ = mesh_patches(surface(), adjacency(), patches_, loops_, essential_,
                           {options_.reference_axis, options_.reference_direction}, control_);
  }

  std::size_t count_faces(const std::vector<FailedPatch>& failed) const {
    std::size_t faces = 0;
    for (const FailedPatch& f : failed) faces += patches_.faces_of(f.patch).size();
    return faces;
  }

  /// Errors: kVerificationFailed - they have been taken so before.
  void take_as_they_are(const std::vector<FaceId>& stuck) {
    limits_.as_it_is.resize(input_.face_count(), 0);
    bool is_new = false;
    for (const FaceId f : stuck) {
      const FaceId source = surface().face_source[f];
      is_new = is_new || limits_.as_it_is[source.value] == 0;
      limits_.as_it_is[source.value] = 1;
    }
    if (is_new || give_up_joining()) return;
    // What cannot be told apart at the mesh's scale is the input's fault, everything else is ours.
    for (const FaceId f : stuck)
      if (is_unresolved(surface(), f)) throw unresolved(surface(), f);
    const FaceId source = surface().face_source[stuck.front()];
    throw Error(
        Code::kVerificationFailed, Stage::kVerify,
        "face " + std::to_string(source.value) + " cannot be brought back so that the result holds: " + first_failure())
        .at_element(source.value);
  }

  /// Vertices that were put into faces where sheets nearly touch, or seams that were closed there, may be what keeps a
  /// result from holding.
  /// Output: whether there were such; both are left alone from now on.
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

  /// Faces that intersect before anything is done to them, seen by patch.
  void find_input_intersections(const Triangulated& faces) {
    watch_.enter(Stage::kVerify);
    input_intersections_ = find_intersections(surface(), faces, patches_, simple_patches(), report_.plane_tolerance,
                                              report_.diagnostics, control_);
    report_.input.intersecting_pairs = input_intersections_.pairs.size();
  }

  /// Patches that cover nothing twice in their plane: their loops do not cross, and none of their faces is so thin that
  /// it may be turned over.
  std::vector<std::uint8_t> simple_patches() {
    std::vector<std::uint8_t> is_simple;
    for (const PatchMesh& mesh : meshes_) is_simple.push_back(mesh.reason == PatchReason::kNone);
    for (const PatchId p : patches_of_thin_faces_) is_simple[p.value] = 0;
    return is_simple;
  }

  void examine_input() {
    const Triangulated faces(surface(), control_);
    find_input_intersections(faces);
    // Of a polygon one triangle stands for all.
    std::vector<std::pair<FaceId, FaceId>> pairs;
    for (const auto& [f, g] : input_intersections_.pairs)
      pairs.push_back({FaceId(faces.first_of(f)), FaceId(faces.first_of(g))});
    const auto begins = triangle_begins(faces.corners().size() / 3, control_);
    const Adjacency edges(surface().vertex_count(), begins, faces.corners(), control_);
    std::vector<FaceId> source;
    source.reserve(faces.size());
    for (std::size_t t = 0; t < faces.size(); ++t) source.push_back(surface().face_source[faces.face(t)]);
    const BodyLabels labels = labels_of_sources(input_.labels, source, control_);
    report_.volume_obstacles = find_volume_obstacles(surface().positions.items(), faces.corners(), edges, labels, pairs,
                                                     report_.plane_tolerance, control_);
  }

  InputIntersections intersecting_patches() const {
    InputIntersections known{{}, input_intersections_.is_complete};
    for (const auto& [f, g] : input_intersections_.pairs)
      known.patches.push_back(std::minmax({patches_.of_face[f], patches_.of_face[g]}));
    std::sort(known.patches.begin(), known.patches.end());
    known.patches.erase(std::unique(known.patches.begin(), known.patches.end()), known.patches.end());
    return known;
  }

  /// Faces of one plane, their patches, the patches' loops, and the vertices that stay.
  void find_patches(Ladder& ladder) {
    watch_.enter(Stage::kRegions);
    coplanar_regions(surface(), adjacency(), geometry(),
                     {local_tolerance(), options_.normal_tolerance, &ladder.zone(), &ladder.rung(),
                      (1 / surface().unit) * prepared_.printed_steps},
                     regions_, control_);
    watch_.enter(Stage::kPatches);
    patches_ = patches(surface(), adjacency(), regions_, control_);
    const std::vector<double> areas = patch_areas(patches_, geometry(), control_);
    find_thin_faces();
    // Most runs do not come back here, and it is as large as all the rest of the surface.
    prepared_.release_geometry();
    watch_.enter(Stage::kLoops);
    loops_ = boundary_loops(surface(), adjacency(), patches_, control_);
    watch_.enter(Stage::kEssentialVertices);
    essential_ = essential_vertices(surface(), adjacency(), loops_, ladder.forced(), prepared_.pinched(control_),
                                    local_tolerance(), control_);
    summaries_ = summarise_patches(surface(), adjacency(), areas, patches_, loops_, essential_, ladder, control_);
  }

  void find_thin_faces() {
    const FaceGeometries& of_face = geometry();
    const auto is_thin = [&](std::size_t f) { return of_face[FaceId(f)].height < kThinFace * local_tolerance(); };
    patches_of_thin_faces_.clear();
    for (const FaceId f : select_ids<FaceId>(surface().face_count(), kItemsPerBlock, control_, is_thin))
      patches_of_thin_faces_.push_back(patches_.of_face[f]);
  }

  double local_tolerance() const { return report_.plane_tolerance / surface().unit; }

  std::vector<FailedPatch> failed_meshes() const {
    std::vector<FailedPatch> failed;
    for (std::size_t p = 0; p < meshes_.size(); ++p)
      if (meshes_[p].reason != PatchReason::kNone) failed.push_back({PatchId(p), meshes_[p].reason});
    return failed;
  }

  void refine_patches(const Ladder& ladder) {
    refinement_ = {};
    if (!refiner_->has_goals() && !has_chords_) return;
    watch_.enter(Stage::kRefinement);
    if (refiner_->has_goals())
      refinement_ = refiner_->refine(patched(), ladder, intersecting_patches().patches, meshes_);
    else
      split_chords(surface(), patches_, meshes_, refinement_, {}, UnrefinedReason::kSizeFloor, control_);
    report_.refinement_rounds = refinement_.rounds;
    if (refiner_->smallest_gap()) report_.smallest_gap = refiner_->smallest_gap();
    lift_new_vertices(surface(), patches_, meshes_, refinement_.first_inner, report_.plane_tolerance,
                      refinement_.new_positions, control_);
  }

  void assemble() {
    assembled_ = assembly(surface().vertex_count() + refinement_.new_positions.size(), meshes_, control_);
    positions_.clear();
    positions_.reserve(assembled_.vertex.size());
    StopCheck stop(control_);
    for (const VertexId v : assembled_.vertex) {
      stop();
      positions_.push_back(v.value < surface().vertex_count()
                               ? surface().positions[v]
                               : refinement_.new_positions[v.value - surface().vertex_count()]);
    }
    if (refiner_->has_goals())
      unrefined_ = find_unrefined(positions_.items(), assembled_.faces.items(), refinement_.reason,
                                  refinement_.misses_sizes, refiner_->goals(), control_);
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
    StopCheck stop(control_);
    for (const PatchMesh& mesh : meshes_) {
      stop();
      frames.push_back(mesh.frame);
    }
    const RefinementClaim refined{refiner_->goals(), unrefined_.faces, unrefined_.reasons, refiner_->frozen()};
    const InputIntersections intersections = intersecting_patches();
    return verify({surface(), patches_.of_face, frames, positions_.items(), assembled_.faces.items(),
                   assembled_.face_patch.items(), assembled_.corner_uv, report_.plane_tolerance,
                   !refinement_.new_positions.empty(), refiner_->has_goals() ? &refined : nullptr, &intersections,
                   prepared_.order(), &input_, options_.weld_tolerance},
                  control_);
  }

  std::string first_failure() const {
    return report_.verified.failures.empty() ? "the result failed its own check" : report_.verified.failures.front();
  }

  void summarise() {
    report_.patches = std::move(summaries_.patches);
    report_.predicted_faces = refiner_->has_goals() ? refiner_->predicted_faces() : summaries_.triangles;
    report_.volume_bound = summaries_.volume_bound;
  }

  /// Where most facets are patches of their own, they stand for a curved surface, and a bound on angles or sizes in
  /// each of them makes many faces.
  void warn_of_curves() {
    if (!options_.refine) return;
    Diagnostic warning{DiagnosticCode::kCurvedSurface, 0, {}, ""};
    std::vector<FaceId> alone;  // ascending, as the patches' first faces do
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      const auto faces = patches_.faces_of(PatchId(p));
      if (faces.size() == 1) alone.push_back(faces[0]);
    }
    if (2 * alone.size() <= surface().face_count() || surface().face_count() < kFewFacets) return;
    surface().for_each_source(alone, [&](FaceId source) { warning.add(source.value); });
    warning.message = "most facets are patches of their own, as of a curved surface: refinement makes many faces there";
    report_.diagnostics.push_back(std::move(warning));
  }

  /// Then the verdict is not about all of them.
  void warn_of_many_intersections() {
    if (report_.verified.are_all_intersections_known) return;
    const auto is_of_them = [](const Diagnostic& d) {
      return d.code == DiagnosticCode::kSelfIntersection || d.code == DiagnosticCode::kOverlappingFaces;
    };
    auto& all = report_.diagnostics;
    auto found = std::find_if(all.begin(), all.end(), is_of_them);
    if (found == all.end())
      found = all.insert(all.end(), {DiagnosticCode::kSelfIntersection, 0, {}, "faces may intersect"});
    found->message += "; too many to test that the result has no others";
  }

  /// A dozen polygons are a polyhedron.
  static constexpr std::size_t kFewFacets = 50;

  Result finish(const RunSettings& settings) {
    Result result;
    result.mesh.positions = std::move(positions_);
    Box3 box;
    for (const Vec3& p : result.mesh.positions) box.add(p);
    result.basis = output_basis(box.diagonal());
    result.mesh.faces = std::move(assembled_.faces);
    result.face_patch = std::move(assembled_.face_patch);
    result.report = std::move(report_);
    // Everything from here on is about the coordinates that the output format holds.
    round_output(settings.storage, options_.local_origin, result, control_);
    watch_.enter(Stage::kQuality);
    IdVector<FaceId, FaceId> source;
    // Each has its parts that wait for nothing but themselves.
    do_all([&] { measure_output(result, control_); },
           [&] {
             // Where each output face came from: the input face under its centroid.
             source = needs_source(settings.want_face_source) ? face_source(surface(), patches_, meshes_, control_)
                                                              : first_faces(result);
             drop_all(meshes_);
           });
    watch_.enter(Stage::kAssembly);
    result.mesh.labels = labels_of(input_.labels, source);
    if (settings.want_face_source) {
      result.face_source = source;
      result.input_face_patch = patches_of_input();
    }
    result.report.timing_ms = watch_.finish();
    return result;
  }

  /// `diagonal`: of the result's bounding box. That of the input may contain corners of faces that are gone.
  OutputBasis output_basis(double diagonal) {
    OutputBasis basis;
    basis.normals.reserve(meshes_.size());
    for (const PatchMesh& mesh : meshes_) basis.normals.push_back(mesh.frame.normal);
    basis.allowed_move = std::max(report_.plane_tolerance, kAllowedRounding * diagonal);
    basis.is_refined = refiner_->has_goals();
    basis.goals = refiner_->goals();
    basis.unrefined = std::move(unrefined_);
    basis.intersections = patches_that_still_intersect();
    basis.patch_labels = labels_of_patches(input_.labels, surface(), patches_, control_);
    return basis;
  }

  /// Those of the result; and patches that fold over themselves in the input, since the check has not looked into all
  /// of them.
  InputIntersections patches_that_still_intersect() const {
    InputIntersections known = intersecting_patches();
    std::erase_if(known.patches, [](const auto& pair) { return pair.first != pair.second; });
    for (const auto& [f, g] : report_.verified.intersections)
      known.patches.push_back(std::minmax({assembled_.face_patch[f], assembled_.face_patch[g]}));
    std::sort(known.patches.begin(), known.patches.end());
    known.patches.erase(std::unique(known.patches.begin(), known.patches.end()), known.patches.end());
    known.is_complete = report_.verified.are_all_intersections_known;
    return known;
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
    for (const PatchId p : result.face_patch) source.push_back(surface().face_source[patches_.faces_of(p)[0]]);
    return source;
  }

  IdVector<FaceId, PatchId> patches_of_input() const {
    IdVector<FaceId, PatchId> patch(input_.face_count());
    for (std::size_t f = surface().face_count(); f-- > 0;)
      patch[surface().face_source[FaceId(f)]] = patches_.of_face[FaceId(f)];
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
  Report report_;
  MendingLimits limits_;
  Prepared prepared_;
  std::optional<GoalRefinement> refiner_;  ///< of the surface as prepared
  bool has_chords_ = false;                ///< edges in patches that are edges of others too, whatever is flipped
  FoundIntersections input_intersections_;
  Regions regions_;
  PatchSet patches_;
  BoundaryLoops loops_;
  EssentialVertices essential_;
  PatchSummaries summaries_;
  std::vector<PatchId> patches_of_thin_faces_;
  std::vector<PatchMesh> meshes_;
  Refinement refinement_;
  Assembled assembled_;
  UnrefinedFaces unrefined_;
  IdVector<VertexId, Vec3> positions_;
};

/// One of so many threads, kept by the thread that calls. TBB (2021.8) keeps some KB of each arena whose workers did
/// not come in time, for ever: one for each run would fill the memory of a process that lives long.
tbb::task_arena& kept_arena(int threads) {
  thread_local std::map<int, tbb::task_arena> arenas;
  return arenas.try_emplace(threads, threads).first->second;
}

/// Runs `work` on so many threads; in the arena that the caller is in, if it has as many.
template <class Work>
auto in_arena(int threads, Work work) {
  if (tbb::this_task_arena::max_concurrency() == threads) return work();
  return kept_arena(threads).execute(work);
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
