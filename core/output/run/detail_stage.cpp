#include "core/output/run/detail_stage.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/mending/details/remove_details.h"
#include "core/mending/details/tiny_components.h"
#include "core/mending/polygons/faces_without_area.h"
#include "core/output/result/face_source.h"
#include "core/refinement/adjustment/lifting.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/chords.h"
#include "core/refinement/rounds/rounds.h"
#include "core/verify/claim/verdict.h"
#include "core/verify/detail_check.h"

namespace remesh {
namespace {

/// Refinement makes no edge shorter than this part of the size.
constexpr double kShareOfSize = 1.0 / 3;
/// Rounding must not lead to a bound above the size.
constexpr double kRoundingShare = 1e-9;

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
                     const PatchSet& patches, const Surface& before, const IdVector<FaceId, FaceId>& source) {
  Surface after;
  after.centre = before.centre;
  after.unit = before.unit;
  for (const Vec3& p : places) after.local.push_back(before.to_local(p));
  after.positions = std::move(places);
  const auto source_of = [&](std::uint32_t f) { return source[without.source[f]]; };
  std::vector<std::uint32_t> order(without.faces.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t f, std::uint32_t g) { return source_of(f) < source_of(g); });
  FaceList faces;
  IdVector<FaceId, PatchId> patch_of_new;
  for (const std::uint32_t f : order) {
    const PatchId patch = candidate.assembled.face_patch[without.source[f]];
    patch_of_new.push_back(patch);
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
  after.covers = covers_of_new_faces(before, patches, patch_of_new, after.face_source);
  return after;
}

/// Removes details from triangles that were proven to be the surface.
std::optional<Replaced> remove(const DetailContext& context, const Candidate& candidate, const Verdict& verdict,
                               const DetailLimits& limits, RemovedDetails& told, RunControl& control) {
  const Surface& before = context.surface;
  const PatchSet& patches = context.patches;
  const IdVector<FaceId, FaceId> source = face_source(before, patches, candidate.triangulated, control);
  const Triangles triangles(candidate, patches, before, context.kept, source, control);
  // All distances together are within the size. By default, that is the plane tolerance, which is shared out.
  const double left = limits.size - context.spent_distance - verdict.deviation;
  const double allowed = limits.is_size_given ? left - limits.plane_tolerance : left / 2;
  if (!(allowed > 0)) return std::nullopt;
  const DetailRules rules{triangles.local,
                          candidate.assembled.faces.items(),
                          candidate.assembled.face_patch.items(),
                          triangles.label,
                          triangles.is_fixed,
                          limits.size / before.unit,
                          allowed / before.unit * (1 - kRoundingShare),
                          limits.plane_tolerance / before.unit,
                          limits.is_size_given};
  WithoutDetails without = remove_details(rules, control);
  told.is_effort_spent = told.is_effort_spent || without.is_effort_spent;
  if (!without.is_changed() || without.faces.empty()) return std::nullopt;
  std::vector<Vec3> places = model_places(without, candidate, before);
  const std::optional<double> proven = prove_details(
      {candidate.positions.items(), candidate.assembled.faces.items(), places, without.faces, without.map}, control);
  if (!proven || !(*proven <= allowed) || !are_different(places, control)) return std::nullopt;
  // Details are removed in local units. Where these have lost lengths, they do not show all intersections either.
  if (are_edges_distorted(candidate, triangles.local, before.unit, control) &&
      do_others_intersect(places, without, candidate.assembled.face_patch, context.intersections, control))
    return std::nullopt;

  Replaced replaced;
  replaced.distance = *proven + verdict.deviation;
  replaced.volume = verdict.volume_bound +
                    std::min(volume_change(rules, without) * before.unit * before.unit * before.unit, DBL_MAX / 4);
  const double within_size = (limits.size - (context.spent_distance + replaced.distance)) * (1 - kRoundingShare);
  if (!limits.is_size_given) {
    replaced.plane_tolerance = within_size;
  } else {
    // A corner may be off its plane by half of the tolerance.
    const double bend = 2 * before.unit * find_bend(rules, without, control);
    replaced.plane_tolerance = std::max(limits.plane_tolerance, std::min(bend, within_size));
  }
  told.joined_edges += without.joined_edges;
  told.closed_slivers += without.closed_slivers;
  told.removed_tiny_components += without.removed_tiny_components;
  told.closed_narrow_notches += without.closed_narrow_notches;
  std::vector<FaceId> removed;
  for (const std::vector<FaceId>& some : {without.removed, without.at_narrow_notches})
    for (const FaceId f : some) removed.push_back(source[f]);
  sort_unique(removed);
  for (const FaceId f : removed) told.faces.add(f.value);

  replaced.surface = make_surface(without, std::move(places), candidate, patches, before, source);
  replaced.without_area = faces_without_area(replaced.surface, control);
  return replaced;
}

}  // namespace

DetailLimits detail_limits(const Options& options, double plane_tolerance) {
  DetailLimits limits;
  limits.plane_tolerance = plane_tolerance;
  limits.is_size_given = options.defeature_size.has_value();
  if (!options.keep_boundary_vertices || limits.is_size_given)
    limits.size = options.defeature_size.value_or(plane_tolerance);
  return limits;
}

bool are_details_there(const DetailLimits& limits, const TriangulatedPatches& triangulated, const Surface& surface,
                       const Adjacency& adjacency, RunControl& control) {
  const auto is_open = [&](EdgeId e) { return adjacency.half_edges(e).size() == 1; };
  const auto odd = adjacency.odd_edges();
  if (limits.is_size_given && std::any_of(odd.begin(), odd.end(), is_open)) return true;
  StopCheck check(control);
  const double size = limits.size / surface.unit;
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

std::optional<Replaced> without_details(const DetailContext& context, Candidate& candidate, const DetailLimits& limits,
                                        RemovedDetails& removed, Stopwatch& watch, RunControl& control) {
  const Verdict verdict = check_triangles(candidate,
                                          {context.input, context.surface, context.patches, context.intersections,
                                           context.plane_tolerance, context.weld_tolerance},
                                          watch, control);
  watch.enter(Stage::kWeld);
  std::optional<Replaced> replaced;
  if (verdict.all_true()) replaced = remove(context, candidate, verdict, limits, removed, control);
  candidate.undo_assembly();
  return replaced;
}

void report_details_left(const DetailLimits& limits, const Candidate& result, const PatchSet& patches,
                         const Surface& surface, std::vector<Diagnostic>& diagnostics, RunControl& control) {
  if (!limits.is_size_given || limits.size == 0) return;
  const double least = kShareOfSize * limits.size;
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
  const TinyComponents components = find_tiny_components(
      {result.positions.items(), result.assembled.faces.items(), {}, {}, {}, limits.size, 0, 0}, control);
  std::vector<std::uint8_t> is_told(components.count(), 0);
  for (FaceId f(0); f.value < result.assembled.faces.size(); ++f.value)
    if (components.has(f) && std::exchange(is_told[components.of_face[f.value]], 1) == 0) add_source(f);
  if (left.count == 0) return;
  left.elements.erase(std::unique(left.elements.begin(), left.elements.end()), left.elements.end());
  const std::string of_edges =
      std::to_string(edges) +
      " edges are shorter than a third of defeature_size, because they could not be removed without changing the "
      "topology, bending other faces too far or making faces intersect";
  const std::string of_components = std::to_string(components.count()) +
                                    " separate parts are no larger than defeature_size, but farther from the rest, or "
                                    "with labels that nothing else has";
  left.message = (edges > 0 ? of_edges : "") + (edges > 0 && components.count() > 0 ? "; " : "") +
                 (components.count() > 0 ? of_components : "") + "; the elements are faces of their patches";
  diagnostics.push_back(std::move(left));
}

Diagnostic removal(const RemovedDetails& removed, double size, double bound) {
  Diagnostic told = removed.faces;
  told.code = DiagnosticCode::kRemovedDetail;
  told.count =
      removed.joined_edges + removed.closed_slivers + removed.removed_tiny_components + removed.closed_narrow_notches;
  std::vector<std::string> details{std::to_string(removed.joined_edges) + " short edges",
                                   std::to_string(removed.closed_slivers) + " narrow faces"};
  if (removed.closed_narrow_notches > 0) details.push_back(std::to_string(removed.closed_narrow_notches) + " slits");
  if (removed.removed_tiny_components > 0)
    details.push_back(std::to_string(removed.removed_tiny_components) + " separate parts");
  std::string list = details.front();
  for (std::size_t i = 1; i < details.size(); ++i) list += (i + 1 < details.size() ? ", " : " and ") + details[i];
  told.message = "details smaller than " + number_text(size) + " were removed: " + list +
                 "; the surface moved by at most " + number_text(bound) + "; defeature_size=0 keeps them" +
                 (removed.is_effort_spent ? "; there were so many that some may be left" : "");
  return told;
}

}  // namespace remesh
