#include "core/output/run/detail_stage.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/output/result/face_labels.h"
#include "core/output/result/face_source.h"
#include "core/refinement/adjustment/lifting.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/chords.h"
#include "core/refinement/rounds/rounds.h"
#include "core/verify/detail_check.h"

namespace remesh {
namespace {

/// Refinement makes no edge shorter than this part of the size.
constexpr double kShareOfSize = 1.0 / 3;
/// Rounding must not lead to a bound above the size.
constexpr double kRoundingShare = 1e-9;

std::string text(double x) {
  std::array<char, 32> digits{};
  char* const end = digits.data() + digits.size();
  return {digits.data(), std::to_chars(digits.data(), end, x, std::chars_format::general, 6).ptr};
}

/// The candidate's triangles as remove_details takes them.
struct Triangles {
  Triangles(const Candidate& candidate, const PatchSet& patches, const Surface& surface,
            const std::vector<std::uint8_t>& kept, const IdVector<FaceId, FaceId>& source, RunControl& control) {
    StopCheck check(control);
    local.reserve(candidate.positions.size());
    for (const Vec3& p : candidate.positions) {
      check();
      local.push_back(surface.to_local(p));
    }
    if (!surface.face_label.empty())
      for (const PatchId p : candidate.assembled.face_patch) {
        check();
        label.push_back(surface.label(patches.faces_of(p).front()));
      }
    if (kept.empty()) return;
    is_fixed.assign(local.size(), 0);
    for (FaceId f(0); f.value < source.size(); ++f.value) {
      check();
      if (kept[source[f].value] == 0) continue;
      for (const VertexId v : candidate.assembled.faces[f]) is_fixed[v.value] = 1;
    }
  }

  std::vector<Vec3> local;
  std::vector<std::uint32_t> label;
  std::vector<std::uint8_t> is_fixed;
};

/// Returns the places of the nodes in model units. Vertices that stay have their coordinates bit for bit.
std::vector<Vec3> model_places(const WithoutDetails& without, const Candidate& candidate, const Surface& surface) {
  std::vector<Vec3> places;
  places.reserve(without.positions.size());
  for (std::size_t i = 0; i < without.positions.size(); ++i) {
    const VertexId v = without.vertex[i];
    places.push_back(v.is_valid() ? candidate.positions[v] : surface.centre + surface.unit * without.positions[i]);
  }
  return places;
}

bool are_different(std::vector<Vec3> places, const RunControl& control) {
  sort_stoppable(places.begin(), places.end(), control);
  return std::adjacent_find(places.begin(), places.end()) == places.end();
}

/// Returns whether an edge has another length in local units, as it may have if a corner of the model is very far away.
bool are_edges_distorted(const Candidate& candidate, std::span<const Vec3> local, double unit, RunControl& control) {
  constexpr double kDistorted = 0.25;  // of its length
  StopCheck check(control);
  for (const Triangle& t : candidate.assembled.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      check();
      const VertexId v = t[k], w = t[(k + 1) % 3];
      const double length = norm(candidate.positions[w] - candidate.positions[v]);
      if (!(std::fabs(unit * norm(local[w.value] - local[v.value]) - length) <= kDistorted * length)) return true;
    }
  return false;
}

/// Returns whether faces intersect whose patches are not known to intersect in the input.
bool do_others_intersect(std::span<const Vec3> places, const WithoutDetails& without,
                         const IdVector<FaceId, PatchId>& patch, const InputIntersections& known, RunControl& control) {
  if (!known.is_complete) return true;
  SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(without.faces.size()));
  limits.is_expected = [&](FaceId f, FaceId g) {
    return known.has(patch[without.source[f.value]], patch[without.source[g.value]]);
  };
  limits.max_unexpected = 0;
  const SelfIntersections found = self_intersections(places, without.faces, {}, limits, control);
  return !found.is_complete || std::any_of(found.pairs.begin(), found.pairs.end(), [&](const auto& pair) {
    return !limits.is_expected(pair.first, pair.second);
  });
}

/// Returns how far planes are bent: the largest distance of a moved corner from the plane of its face, in the unit of
/// the rules. Faces that are details themselves have no plane.
double find_bend(const DetailRules& rules, const WithoutDetails& without, RunControl& control) {
  double bend = 0;
  StopCheck check(control);
  for (const Triangle& t : rules.faces) {
    check();
    const Vec3 &a = rules.positions[t[0].value], &b = rules.positions[t[1].value], &c = rules.positions[t[2].value];
    const Vec3 normal = cross(b - a, c - a);
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)}), twice_area = norm(normal);
    if (!(twice_area >= rules.size * longest)) continue;
    for (const VertexId v : t) {
      if (!without.map.image[v].is_valid()) continue;
      const Vec3 move = without.positions[without.map.image[v].value] - rules.positions[v.value];
      bend = std::max(bend, std::fabs(dot(normal, move)) / twice_area);
    }
  }
  return bend;
}

/// A volume that faces enclose with the origin, and the sum of the absolute volumes from which it was computed.
struct EnclosedVolume {
  EnclosedVolume(std::span<const Vec3> positions, std::span<const Triangle> faces) {
    for (const Triangle& t : faces) {
      const double six_times = dot(positions[t[0].value], cross(positions[t[1].value], positions[t[2].value]));
      volume += six_times / 6;
      magnitude += std::fabs(six_times) / 6;
    }
  }
  double volume = 0, magnitude = 0;
};

/// Returns by how much the volume changes at most, in the cubed unit of the rules.
double volume_change(const DetailRules& rules, const WithoutDetails& without) {
  const EnclosedVolume before(rules.positions, rules.faces), after(without.positions, without.faces);
  // Each sum is rounded as often as there are faces, though errors hardly ever add up like that.
  const double rounding = 0x1p-50 * static_cast<double>(rules.faces.size() + 16);
  return std::fabs(after.volume - before.volume) + rounding * (before.magnitude + after.magnitude);
}

/// Makes the surface of the faces that are left.
Surface make_surface(const WithoutDetails& without, std::vector<Vec3>&& places, const Candidate& candidate,
                     const PatchSet& patches, const Surface& before, const IdVector<FaceId, FaceId>& source,
                     std::vector<std::uint32_t>& order) {
  Surface after;
  after.centre = before.centre;
  after.unit = before.unit;
  for (const Vec3& p : places) after.local.push_back(before.to_local(p));
  after.positions = std::move(places);
  const auto source_of = [&](std::uint32_t f) { return source[without.source[f]]; };
  order.resize(without.faces.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t f, std::uint32_t g) { return source_of(f) < source_of(g); });
  FaceList faces;
  for (const std::uint32_t f : order) {
    const PatchId patch = candidate.assembled.face_patch[without.source[f]];
    faces.add_face(without.faces[f], source_of(f), before.label(patches.faces_of(patch).front()));
  }
  const auto source_of_vertex = [&](VertexId node) {
    const VertexId v = without.vertex[node.value];
    if (!v.is_valid()) return VertexId();
    const VertexId of_surface = candidate.assembled.vertex[v];
    return of_surface.value < before.vertex_count() ? before.vertex_source[of_surface] : VertexId();
  };
  after.vertex_source.resize(without.positions.size());
  for (VertexId node(0); node.value < without.positions.size(); ++node.value)
    after.vertex_source[node] = source_of_vertex(node);
  // New vertices have the source of a neighbour. One of the faces around such a vertex has another one, or any will do.
  for (const Triangle& t : without.faces)
    for (const VertexId node : t) {
      if (after.vertex_source[node].is_valid()) continue;
      for (const VertexId other : t)
        if (after.vertex_source[other].is_valid()) after.vertex_source[node] = after.vertex_source[other];
    }
  for (VertexId& v : after.vertex_source)
    if (!v.is_valid()) v = VertexId(0);
  after.take_faces(std::move(faces));
  return after;
}

}  // namespace

void DetailStage::reset(const Options& options, double plane_tolerance) {
  *this = {};
  limits_.plane_tolerance = plane_tolerance;
  limits_.is_size_given = options.defeature_size.has_value();
  if (!options.keep_boundary_vertices || limits_.is_size_given)
    limits_.size = options.defeature_size.value_or(plane_tolerance);
}

bool DetailStage::are_there(const TriangulatedPatches& triangulated, const Surface& surface, const Adjacency& adjacency,
                            RunControl& control) const {
  const auto is_open = [&](EdgeId e) { return adjacency.half_edges(e).size() == 1; };
  const auto odd = adjacency.odd_edges();
  if (limits_.is_size_given && std::any_of(odd.begin(), odd.end(), is_open)) return true;
  StopCheck check(control);
  const double size = limits_.size / surface.unit;
  for (const PatchMesh& patch : triangulated.meshes) {
    const Triangulation2d& mesh = patch.mesh;
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
      check();
      Vec3 p[3];
      for (std::uint32_t k = 0; k < 3; ++k) p[k] = surface.local[patch.vertices[mesh.from(h + k)]];
      const double a = norm(p[1] - p[0]), b = norm(p[2] - p[1]), c = norm(p[0] - p[2]);
      if (std::min({a, b, c}) < size || norm(cross(p[1] - p[0], p[2] - p[0])) < size * std::max({a, b, c})) return true;
    }
  }
  return false;
}

bool DetailStage::run(const Context& context, Candidate& candidate, Prepared& prepared, Stopwatch& watch,
                      RunControl& control) {
  const Surface& surface = prepared.surface;
  watch.enter(Stage::kAssembly);
  TriangulatedPatches& triangulated = candidate.triangulated;
  Refinement& refinement = candidate.refinement;
  candidate.has_chords = !flip_chords(triangulated.meshes, surface.vertex_count(), control);
  if (candidate.has_chords) {
    split_chords(surface, triangulated, refinement, {}, UnrefinedReason::kSizeFloor, control);
    lift_new_vertices(surface, context.patches, triangulated, refinement.first_inner, context.plane_tolerance,
                      refinement.new_positions, control);
  }
  assemble(candidate, surface, nullptr, control);
  watch.enter(Stage::kVerify);
  const Verdict verdict = check(candidate,
                                {is_any_removed() ? nullptr : &context.input, surface, context.patches,
                                 context.intersections, context.plane_tolerance, context.weld_tolerance},
                                control);
  watch.enter(Stage::kWeld);
  const bool is_removed = verdict.all_true() && remove(context, candidate, verdict, prepared, control);
  candidate.clear();
  if (!is_removed) stop();
  return is_removed;
}

bool DetailStage::remove(const Context& context, const Candidate& candidate, const Verdict& verdict, Prepared& prepared,
                         RunControl& control) {
  const Surface& before = prepared.surface;
  const PatchSet& patches = context.patches;
  const IdVector<FaceId, FaceId> source = face_source(before, patches, candidate.triangulated, control);
  const Triangles triangles(candidate, patches, before, context.kept, source, control);
  // All distances together are within the size. By default, that is the plane tolerance, which is shared out.
  const double left = limits_.size - bound_ - verdict.deviation;
  const double allowed = limits_.is_size_given ? left - limits_.plane_tolerance : left / 2;
  if (!(allowed > 0)) return false;
  const DetailRules rules{triangles.local,
                          candidate.assembled.faces.items(),
                          candidate.assembled.face_patch.items(),
                          triangles.label,
                          triangles.is_fixed,
                          limits_.size / before.unit,
                          allowed / before.unit * (1 - kRoundingShare),
                          limits_.plane_tolerance / before.unit,
                          limits_.is_size_given};
  WithoutDetails without = remove_details(rules, control);
  is_effort_spent_ = is_effort_spent_ || without.is_effort_spent;
  if (!without.is_changed() || without.faces.empty()) return false;
  std::vector<Vec3> places = model_places(without, candidate, before);
  const std::optional<double> proven = prove_details(
      {candidate.positions.items(), candidate.assembled.faces.items(), places, without.faces, without.map}, control);
  if (!proven || !(*proven <= allowed) || !are_different(places, control)) return false;
  // Details are removed in local units. Where these have lost lengths, they do not show all intersections either.
  if (are_edges_distorted(candidate, triangles.local, before.unit, control) &&
      do_others_intersect(places, without, candidate.assembled.face_patch, context.intersections, control))
    return false;

  bound_ += *proven + verdict.deviation;
  volume_bound_ += verdict.volume_bound +
                   std::min(volume_change(rules, without) * before.unit * before.unit * before.unit, DBL_MAX / 4);
  if (!limits_.is_size_given) {
    limits_.plane_tolerance = (limits_.size - bound_) * (1 - kRoundingShare);
  } else {
    // A corner may be off its plane by half of the tolerance.
    const double bend = 2 * before.unit * find_bend(rules, without, control);
    limits_.plane_tolerance =
        std::max(limits_.plane_tolerance, std::min(bend, (limits_.size - bound_) * (1 - kRoundingShare)));
  }
  joined_edges_ += without.joined_edges;
  closed_slivers_ += without.closed_slivers;
  removed_specks_ += without.removed_specks;
  closed_slits_ += without.closed_slits;
  std::vector<FaceId> removed;
  for (const std::vector<FaceId>& some : {without.removed, without.at_slits})
    for (const FaceId f : some) removed.push_back(source[f]);
  std::sort(removed.begin(), removed.end());
  removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
  for (const FaceId f : removed) removed_.add(f.value);

  if (!descent_) descent_ = Descent{remesh::patches_of_input(before, patches, context.input.face_count()), {}};
  std::vector<std::uint32_t> order;
  Surface after = make_surface(without, std::move(places), candidate, patches, before, source, order);
  if (passes_ == 0) {
    descent_->face_of_patch.resize(patches.count());
    for (std::size_t f = order.size(); f-- > 0;)
      descent_->face_of_patch[candidate.assembled.face_patch[without.source[order[f]]]] = FaceId(f);
  } else {
    // The faces of the surface before became patches, and these became faces.
    IdVector<PatchId, FaceId> now(patches.count());
    for (std::size_t f = order.size(); f-- > 0;)
      now[candidate.assembled.face_patch[without.source[order[f]]]] = FaceId(f);
    for (FaceId& f : descent_->face_of_patch)
      if (f.is_valid()) f = now[patches.of_face[f]];
  }
  prepared.release();
  prepared.surface = std::move(after);
  prepared.without_area = faces_without_area(prepared.surface, control);
  ++passes_;
  return true;
}

/// Finds the parts of a result that are no larger than a detail.
Specks DetailStage::specks_left(const Candidate& result, RunControl& control) const {
  return find_specks({result.positions.items(), result.assembled.faces.items(), {}, {}, {}, limits_.size, 0, 0},
                     control);
}

void DetailStage::tell(const Candidate& result, const PatchSet& patches, const Surface& surface,
                       std::vector<Diagnostic>& diagnostics, RunControl& control) const {
  if (is_any_removed()) diagnostics.push_back(removal());
  if (!limits_.is_size_given || limits_.size == 0) return;
  const double least = kShareOfSize * limits_.size;
  Diagnostic left{DiagnosticCode::kSmallDetail, 0, {}, {}};
  const auto add_source = [&](FaceId f) {
    left.add(surface.face_source[patches.faces_of(result.assembled.face_patch[f]).front()].value);
  };
  StopCheck check(control);
  for (FaceId f(0); f.value < result.assembled.faces.size(); ++f.value) {
    const Triangle& t = result.assembled.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      check();
      const VertexId from = t[k], to = t[(k + 1) % 3];
      // The other face at the edge has it in the other direction. Where there is none, the edge may be missed.
      if (from < to && norm(result.positions[from] - result.positions[to]) < least) add_source(f);
    }
  }
  const std::uint64_t edges = left.count;
  const Specks specks = specks_left(result, control);
  std::vector<std::uint8_t> is_told(specks.count(), 0);
  for (FaceId f(0); f.value < result.assembled.faces.size(); ++f.value)
    if (specks.has(f) && std::exchange(is_told[specks.of_face[f.value]], 1) == 0) add_source(f);
  if (left.count == 0) return;
  left.elements.erase(std::unique(left.elements.begin(), left.elements.end()), left.elements.end());
  const std::string of_edges =
      std::to_string(edges) +
      " edges are shorter than a third of defeature_size, because they could not be removed without changing the "
      "topology, bending other faces too far or making faces intersect";
  const std::string of_specks = std::to_string(specks.count()) +
                                " separate parts are no larger than defeature_size, but farther from the rest, or "
                                "with labels that nothing else has";
  left.message = (edges > 0 ? of_edges : "") + (edges > 0 && specks.count() > 0 ? "; " : "") +
                 (specks.count() > 0 ? of_specks : "") + "; the elements are faces of their patches";
  diagnostics.push_back(std::move(left));
}

Diagnostic DetailStage::removal() const {
  Diagnostic told = removed_;
  told.code = DiagnosticCode::kRemovedDetail;
  told.count = joined_edges_ + closed_slivers_ + removed_specks_ + closed_slits_;
  std::vector<std::string> details{std::to_string(joined_edges_) + " short edges",
                                   std::to_string(closed_slivers_) + " narrow faces"};
  if (closed_slits_ > 0) details.push_back(std::to_string(closed_slits_) + " slits");
  if (removed_specks_ > 0) details.push_back(std::to_string(removed_specks_) + " separate parts");
  std::string list = details.front();
  for (std::size_t i = 1; i < details.size(); ++i) list += (i + 1 < details.size() ? ", " : " and ") + details[i];
  told.message = "details smaller than " + text(limits_.size) + " were removed: " + list +
                 "; the surface moved by at most " + text(bound_) + "; defeature_size=0 keeps them" +
                 (is_effort_spent_ ? "; there were so many that some may be left" : "");
  return told;
}

IdVector<FaceId, PatchId> DetailStage::patches_of_input(const PatchSet& patches) const {
  IdVector<FaceId, PatchId> patch(descent_->patch_of_input.size());
  for (FaceId f(0); f.value < patch.size(); ++f.value) {
    const PatchId before = descent_->patch_of_input[f];
    if (!before.is_valid()) continue;
    const FaceId now = descent_->face_of_patch[before];
    if (now.is_valid()) patch[f] = patches.of_face[now];
  }
  return patch;
}

}  // namespace remesh
