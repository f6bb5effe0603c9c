#include "core/output/run/solid_stage.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/geometry/shells/shells.h"
#include "core/mending/common/body_labels.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_marks.h"
#include "core/mesh/triangle_corners.h"
#include "core/output/report/surface_words.h"
#include "core/output/result/face_source.h"
#include "core/solids/arrangement.h"
#include "core/solids/solid_union.h"
#include "core/verify/arrangement_check.h"

namespace remesh {
namespace {

/// Corners may be off their planes by half of the plane tolerance, on both sides.
constexpr double kToleranceOfMoves = 2;

/// The volume that triangles enclose with the origin, and the sum of the absolute volumes of its parts.
struct SignedVolume {
  SignedVolume(const Surface& surface, std::span<const Vec3> positions, std::span<const Triangle> faces) {
    for (const Triangle& t : faces) {
      const Vec3 a = surface.to_local(positions[t[0].value]), b = surface.to_local(positions[t[1].value]),
                 c = surface.to_local(positions[t[2].value]);
      const double part = dot(a, cross(b, c)) / 6;
      sum += part;
      magnitude += std::fabs(part);
    }
  }
  double sum = 0, magnitude = 0;
};

/// Returns a bound on the change of the volume, in cubed model units.
double change_of_volume(const Surface& before, const Candidate& candidate, const Arrangement& arranged) {
  const SignedVolume old_volume(before, candidate.positions.items(), candidate.assembled.faces.items());
  const SignedVolume new_volume(before, arranged.positions, arranged.faces);
  const double rounding = 0x1p-50 * static_cast<double>(candidate.assembled.faces.size() + arranged.faces.size() + 16);
  const double change =
      std::fabs(new_volume.sum - old_volume.sum) + rounding * (old_volume.magnitude + new_volume.magnitude);
  return std::min(change * before.unit * before.unit * before.unit, DBL_MAX / 4);
}

/// Makes the surface of the triangles that were arranged.
class ArrangedSurface {
 public:
  ArrangedSurface(const Surface& before, const PatchSet& patches, const Candidate& candidate,
                  const Arrangement& arranged, RunControl& control)
      : before_(before),
        patches_(patches),
        candidate_(candidate),
        arranged_(arranged),
        control_(control),
        source_(face_source(before, patches, candidate.triangulated, control)) {}

  Surface make() const {
    Surface after;
    after.centre = before_.centre;
    after.unit = before_.unit;
    StopCheck check(control_);
    for (const Vec3& p : arranged_.positions) {
      check();
      after.local.push_back(before_.to_local(p));
    }
    after.positions = arranged_.positions;
    take_vertex_sources(after);
    std::vector<std::uint32_t> order(arranged_.faces.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t f, std::uint32_t g) { return source_of(f) < source_of(g); });
    FaceList faces;
    for (const std::uint32_t f : order) {
      check();
      faces.add_face(arranged_.faces[f], source_of(f), before_.label(patches_.faces_of(patch_of(f)).front()));
    }
    after.take_faces(std::move(faces));
    after.covers = covers_of(order);
    return after;
  }

  /// Adds the input's faces under the patches some of whose triangles are marked.
  /// Output: the number of these patches.
  template <class IsMarked>
  std::size_t add_faces(const IsMarked& is_marked, Diagnostic& told) const {
    std::vector<std::uint8_t> is_of_patch(patches_.count(), 0);
    for (FaceId f(0); f.value < candidate_.assembled.faces.size(); ++f.value)
      if (is_marked(f)) is_of_patch[candidate_.assembled.face_patch[f].value] = 1;
    std::vector<FaceId> faces;
    for (PatchId p(0); p.value < patches_.count(); ++p.value) {
      if (is_of_patch[p.value] == 0) continue;
      const std::vector<FaceId> covered = covered_by(before_, patches_.faces_of(p));
      faces.insert(faces.end(), covered.begin(), covered.end());
    }
    sort_unique(faces);
    for (const FaceId f : faces) told.add(f.value);
    return static_cast<std::size_t>(std::count(is_of_patch.begin(), is_of_patch.end(), 1));
  }

 private:
  FaceId first_cover(std::uint32_t f) const { return arranged_.covers_of(f).front().face; }
  PatchId patch_of(std::uint32_t f) const { return candidate_.assembled.face_patch[first_cover(f)]; }
  FaceId source_of(std::uint32_t f) const { return source_[first_cover(f)]; }

  /// Vertices that stay keep their source, and new ones have that of a corner of a triangle of which a face at them is
  /// a piece.
  void take_vertex_sources(Surface& after) const {
    const auto source_of_vertex = [&](VertexId v) {
      const VertexId of_surface = candidate_.assembled.vertex[v];
      return of_surface.value < before_.vertex_count() ? before_.vertex_source[of_surface] : VertexId();
    };
    after.vertex_source.resize(arranged_.positions.size());
    for (VertexId v(0); v.value < arranged_.positions.size(); ++v.value) {
      const VertexId old = arranged_.vertex[v.value];
      after.vertex_source[v] = old.is_valid() ? source_of_vertex(old) : VertexId();
    }
    for (std::uint32_t f = 0; f < arranged_.faces.size(); ++f) {
      const VertexId near = before_.vertex_source[before_.face(patches_.faces_of(patch_of(f)).front())[0]];
      for (const VertexId v : arranged_.faces[f])
        if (!after.vertex_source[v].is_valid()) after.vertex_source[v] = near;
    }
  }

  /// The first piece of each patch covers all input faces that the patch covered, and any other its source.
  CoveredFaces covers_of(const std::vector<std::uint32_t>& order) const {
    CoveredFaces covers;
    covers.begin.push_back(0);
    std::vector<std::uint8_t> is_found(patches_.count(), 0);
    StopCheck check(control_);
    std::vector<FaceId> of_face;
    for (const std::uint32_t f : order) {
      check();
      of_face.assign(1, source_of(f));
      for (const Cover& cover : arranged_.covers_of(f)) {
        const PatchId patch = candidate_.assembled.face_patch[cover.face];
        if (std::exchange(is_found[patch.value], 1) != 0) continue;
        const std::vector<FaceId> covered = covered_by(before_, patches_.faces_of(patch));
        of_face.insert(of_face.end(), covered.begin(), covered.end());
      }
      sort_unique(of_face);
      covers.faces.insert(covers.faces.end(), of_face.begin(), of_face.end());
      covers.begin.push_back(covers.faces.size());
    }
    return covers;
  }

  const Surface& before_;
  const PatchSet& patches_;
  const Candidate& candidate_;
  const Arrangement& arranged_;
  RunControl& control_;
  const IdVector<FaceId, FaceId> source_;
};

/// Returns by how much each triangle changes the winding number.
std::vector<std::int32_t> weights_of_triangles(const Shells& shells, const UnionFaces& found) {
  std::vector<std::int32_t> of_shell;
  for (const Shell& shell : shells.all) of_shell.push_back(shell.is_closed ? 1 : 0);
  for (const std::uint32_t s : found.turned_shells) of_shell[s] = -1;
  std::vector<std::int32_t> weights;
  for (const std::uint32_t s : shells.of_face) weights.push_back(of_shell[s]);
  return weights;
}

/// Triangles that were arranged with a share of the distance, and what is known of them.
struct ArrangingAttempt {
  Arrangement arranged;
  ArrangementFault fault = ArrangementFault::kNone;
  bool is_judged = false;
  double moved_too_far = 0;  ///< how far points have moved, if that is further than they may
  double distance = 0;       ///< proven
  ArrangedFaces told;
  std::vector<std::uint8_t> is_shared;   ///< by triangle of the candidate: pieces of it lie on others
  std::vector<std::uint8_t> is_dropped;  ///< likewise: pieces of it were dropped or turned over; empty if none were

  bool is_better_than(const ArrangingAttempt& other) const {
    const auto faults = [](const ArrangingAttempt& a) {
      const bool is_in_vain = a.arranged.is_given_up || !a.told.reason_in_vain.empty();
      return std::tuple(is_in_vain, a.arranged.left.size(), !a.told.union_in_vain.empty(), a.moved_too_far);
    };
    return faults(*this) < faults(other);
  }
};

/// Drops the triangles that do not bound the union of the solids.
/// Output: by triangle of the candidate: whether pieces of it were dropped or turned over; empty if none were.
std::vector<std::uint8_t> drop_inner_faces(const SolidContext& context, const Candidate& candidate,
                                           ArrangingAttempt& attempt, RunControl& control) {
  Arrangement& arranged = attempt.arranged;
  ArrangedFaces& told = attempt.told;
  if (!arranged.left.empty()) {
    told.union_in_vain = "triangles still intersect";
    return {};
  }
  const std::span<const Triangle> faces = candidate.assembled.faces.items();
  const BodyLabels labels =
      labels_of_result(labels_of_patches(context.labels, context.surface, context.patches, control),
                       candidate.assembled.face_patch.items(), control);
  const std::vector<Vec3> scaled = scaled_for_predicates(candidate.positions.items(), control);
  const auto begins = triangle_begins(faces.size(), control);
  const Adjacency edges(scaled.size(), begins, corners_of(faces), control);
  const Shells shells = find_shells(scaled, corners_of(faces), edges, labels, control);
  const UnionFaces found = find_union(arranged, candidate.positions.items(), faces, shells, control);
  told.counts.cells = found.cells;
  if (!found.are_consistent) told.union_in_vain = "it is not clear what is inside";
  const bool is_any_turned = std::find(found.is_turned.begin(), found.is_turned.end(), 1) != found.is_turned.end();
  if (!found.are_consistent || (found.dropped == 0 && !is_any_turned)) return {};
  const std::vector<std::int32_t> weights = weights_of_triangles(shells, found);
  const std::string fault = find_fault_of_union(
      {candidate.positions.items(), faces, weights, arranged, found.stays, found.is_turned, context.plane_tolerance},
      control);
  if (!fault.empty()) {
    told.union_in_vain = "the check of the union failed: " + fault;
    if (arranged.is_changed) attempt.fault = ArrangementFault::kFails;
    return {};
  }
  told.counts.dropped = found.dropped;
  told.counts.turned = found.turned_shells.size();
  std::vector<std::uint8_t> is_dropped(faces.size(), 0);
  for (std::size_t f = 0; f < arranged.faces.size(); ++f)
    if (found.stays[f] == 0)
      for (const Cover& cover : arranged.covers_of(f)) is_dropped[cover.face.value] = 1;
  keep_union(arranged, found, control);
  arranged.is_changed = true;
  return is_dropped;
}

/// Counts what the arrangement has found and done.
/// Output: by triangle of the candidate: whether pieces of it lie on others.
std::vector<std::uint8_t> count_arranged(const Candidate& candidate, const PatchSet& patches,
                                         const Arrangement& arranged, SolidCounts& counts, RunControl& control) {
  std::vector<std::uint8_t> is_shared(candidate.assembled.faces.size(), 0);
  if (!arranged.is_changed) return is_shared;
  counts.curves = arranged.curves;
  counts.shared = arranged.shared;
  counts.rounds = arranged.rounds;
  counts.left = arranged.left.size();
  counts.moved = arranged.moved;
  const auto patch = [&](FaceId f) { return candidate.assembled.face_patch[f].value; };
  UnionFind classes(patches.count());
  StopCheck check(control);
  for (std::size_t f = 0; f < arranged.faces.size(); ++f) {
    check();
    const auto covers = arranged.covers_of(f);
    if (covers.size() < 2) continue;
    for (const Cover& cover : covers) {
      is_shared[cover.face.value] = 1;
      classes.join(patch(covers.front().face), patch(cover.face));
    }
  }
  std::vector<std::uint8_t> is_class(patches.count(), 0);
  for (FaceId f(0); f.value < is_shared.size(); ++f.value)
    if (is_shared[f.value] != 0) is_class[classes.find(patch(f))] = 1;
  counts.coplanar_classes = static_cast<std::size_t>(std::count(is_class.begin(), is_class.end(), 1));
  return is_shared;
}

/// Checks what was arranged, and drops what a union does not need.
void judge(const SolidContext& context, const Candidate& candidate, ArrangingAttempt& attempt, RunControl& control) {
  attempt.is_judged = true;
  Arrangement& arranged = attempt.arranged;
  const auto fail = [&](std::string reason) {
    attempt.told.reason_in_vain = std::move(reason);
    if (!arranged.is_given_up) attempt.fault = ArrangementFault::kFails;
  };
  if (arranged.is_given_up) return fail("too many faces cross or touch too many others");
  if (!are_different(arranged.positions, control)) return fail("points of the curves could not be told apart");
  if (arranged.left.size() > arranged.curves) return fail("more triangles would intersect than did before");
  if (arranged.is_changed) {
    const ArrangementProof proof = prove_arrangement(
        {candidate.positions.items(), candidate.assembled.faces.items(), arranged, context.plane_tolerance}, control);
    if (!proof.distance) return fail("the faces that were cut failed their check: " + proof.failure);
    attempt.distance = *proof.distance;
  }
  attempt.is_shared = count_arranged(candidate, context.patches, arranged, attempt.told.counts, control);
  if (context.is_union_wanted)
    attempt.is_dropped = drop_inner_faces(context, candidate, attempt, control);
  else if (arranged.is_changed && arranged.left.empty())
    attempt.told.counts.cells = count_cells(arranged, control);
}

/// Calls `work`, and returns false if it needs more memory than the run may take.
template <class Work>
bool fits_in_memory(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    if (error.code != Code::kOutOfMemory) throw;
    return false;
  }
  return true;
}

/// Arranges triangles with the plane tolerance as the distance, and with shares of it as long as something is wrong.
/// Output: the best arrangement that passes its check, or one that does not if all fail.
ArrangingAttempt arrange_best(const SolidContext& context, const Candidate& candidate, RunControl& control) {
  std::vector<ArrangingAttempt> attempts;
  const auto give_up = [](ArrangingAttempt& attempt) {
    attempt = {};
    attempt.arranged.is_given_up = attempt.is_judged = true;
    attempt.fault = ArrangementFault::kTooMuch;
    attempt.told.reason_in_vain = "that would need more memory than is allowed for a mesh of this size";
  };
  const auto judge_if_it_fits = [&](ArrangingAttempt& attempt) {
    if (!fits_in_memory([&] { judge(context, candidate, attempt, control); })) give_up(attempt);
  };
  for (std::optional<double> share = 1; share;) {
    ArrangingAttempt& attempt = attempts.emplace_back();
    const bool fits = fits_in_memory([&] {
      attempt.arranged = arrange(candidate.positions.items(), candidate.assembled.faces.items(),
                                 context.plane_tolerance, control, *share);
    });
    if (!fits) give_up(attempt);
    attempt.fault = fault_of(attempt.arranged, context.plane_tolerance);
    if (attempt.fault == ArrangementFault::kMovesTooFar) attempt.moved_too_far = attempt.arranged.moved;
    // An attempt with a fault is judged only if nothing better is found.
    if (attempt.fault == ArrangementFault::kNone) judge_if_it_fits(attempt);
    // A smaller distance hardly needs less memory.
    const bool was_memory_lacking = attempt.is_judged && attempt.arranged.is_given_up;
    share = was_memory_lacking ? std::nullopt : next_share(*share, attempt.fault);
  }
  for (;;) {
    const auto best = std::min_element(attempts.begin(), attempts.end(),
                                       [](const auto& a, const auto& b) { return a.is_better_than(b); });
    if (best->is_judged) return std::move(*best);
    judge_if_it_fits(*best);
  }
}

/// Makes the surface of triangles that were arranged, and tells what has changed.
/// Input: the verdict on the triangles as they were.
Replaced made_of(const ArrangingAttempt& best, const SolidContext& context, const Candidate& candidate,
                 const Verdict& verdict, ArrangedFaces& told, RunControl& control) {
  const Arrangement& arranged = best.arranged;
  const ArrangedSurface made(context.surface, context.patches, candidate, arranged, control);
  told.counts.cut_patches = made.add_faces([&](FaceId f) { return arranged.was_cut[f.value] != 0; }, told.faces);
  made.add_faces([&](FaceId f) { return best.is_shared[f.value] != 0; }, told.shared_faces);
  if (!best.is_dropped.empty())
    made.add_faces([&](FaceId f) { return best.is_dropped[f.value] != 0; }, told.dropped_faces);

  Replaced replaced;
  replaced.distance = best.distance + verdict.deviation;
  told.distance = replaced.distance;
  told.is_done = true;
  replaced.plane_tolerance = context.plane_tolerance + kToleranceOfMoves * arranged.moved;
  replaced.volume = verdict.volume_bound + change_of_volume(context.surface, candidate, arranged);
  replaced.surface = made.make();
  replaced.without_area = faces_without_area(replaced.surface, control);
  return replaced;
}

}  // namespace

std::optional<Replaced> arranged_surface(const SolidContext& context, Candidate& candidate, ArrangedFaces& told,
                                         Stopwatch& watch, RunControl& control) {
  // Intersections are what is looked for here, so they prove nothing against the triangles.
  const InputIntersections unknown{{}, false, false};
  const CheckedAgainst against{context.input, context.surface,         context.patches,
                               unknown,       context.plane_tolerance, context.weld_tolerance};
  assemble_triangles(candidate, against, watch, control);
  watch.enter(Stage::kWeld);
  ArrangingAttempt best = arrange_best(context, candidate, control);
  told = std::move(best.told);
  if (!told.reason_in_vain.empty() || !best.arranged.is_changed) {
    candidate.undo_assembly();
    return std::nullopt;
  }
  watch.enter(Stage::kVerify);
  const Verdict verdict = check(candidate, against, control);
  watch.enter(Stage::kWeld);
  if (verdict.all_true()) return made_of(best, context, candidate, verdict, told, control);
  told = {};
  told.reason_in_vain = "the triangles between the vertices that stay failed their check: " +
                        (verdict.failures.empty() ? std::string("no reason is known") : verdict.failures.front());
  candidate.undo_assembly();
  return std::nullopt;
}

void report_arrangement(const ArrangedFaces& told, std::vector<Diagnostic>& diagnostics) {
  if (!told.reason_in_vain.empty()) {
    diagnostics.push_back({DiagnosticCode::kCutIntersections,
                           0,
                           {},
                           "faces that intersect were not cut, because " + told.reason_in_vain});
    return;
  }
  if (told.faces.count > 0) {
    Diagnostic cut = told.faces;
    cut.code = DiagnosticCode::kCutIntersections;
    cut.message = "faces were cut along their intersections with others: " + grouped_digits(told.counts.curves) +
                  " pairs of triangles crossed each other at an angle; points have moved by at most " +
                  number_text(told.counts.moved);
    if (told.counts.left > 0)
      cut.message += "; " + grouped_digits(told.counts.left) +
                     " pairs of triangles still intersect, since the rounding of new points makes them cross; a larger "
                     "plane_tolerance or defeature_size may help";
    diagnostics.push_back(std::move(cut));
  }
  if (told.shared_faces.count > 0) {
    Diagnostic shared = told.shared_faces;
    shared.code = DiagnosticCode::kSharedFaces;
    shared.message = "faces lay on others within the plane tolerance, and are one surface there: " +
                     grouped_digits(told.counts.shared) + " triangles take the place of two or more";
    diagnostics.push_back(std::move(shared));
  }
  if (told.counts.dropped > 0 || told.counts.turned > 0 || !told.union_in_vain.empty()) {
    Diagnostic dropped = told.dropped_faces;
    dropped.code = DiagnosticCode::kDroppedPieces;
    if (told.union_in_vain.empty()) {
      dropped.message =
          "faces lay inside the union of the solids, at least in part: " + grouped_digits(told.counts.dropped) +
          " triangles were dropped";
      if (told.counts.turned > 0)
        dropped.message +=
            "; " + grouped_digits(told.counts.turned) + " closed shells that faced inwards were turned over";
    } else {
      dropped.message = "no face was dropped for a union, because " + told.union_in_vain;
    }
    diagnostics.push_back(std::move(dropped));
  }
}

}  // namespace remesh
