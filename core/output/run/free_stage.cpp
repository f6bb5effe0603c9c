#include "core/output/run/free_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/grouping.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/free_form/sheet_trial.h"
#include "core/output/report/surface_words.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh {
namespace {

/// The share of the tolerance that rounding to model units may take.
constexpr double kShareOfRounding = 1e-9;

/// Returns the places of the new vertices in model units. Vertices that stay have their coordinates bit for bit.
std::vector<Vec3> model_places(const Coarsened& made, const FreePart& part, const Surface& before) {
  std::vector<Vec3> places;
  places.reserve(made.positions.size());
  for (VertexId v(0); v.value < made.positions.size(); ++v.value)
    places.push_back(made.source[v].is_valid() ? before.positions[part.vertex[made.source[v]]]
                                               : before.centre + before.unit * made.positions[v]);
  return places;
}

/// The volume under triangles, in cubed local units, with the sum of the sizes of its parts.
struct Volume {
  Volume(const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces) {
    for (const Triangle& t : faces) {
      const double part = dot(positions[t[0]], cross(positions[t[1]], positions[t[2]])) / 6;
      sum += part;
      magnitude += std::fabs(part);
    }
  }
  double sum = 0, magnitude = 0;
};

/// Returns a bound on the change of the volume, in cubed model units.
double volume_change(const FreePart& part, const Coarsened& made, const Surface& surface) {
  const Volume before(part.positions, part.faces), after(made.positions, made.faces);
  const double rounding =
      0x1p-50 * static_cast<double>(part.faces.size() + made.faces.size() + 16) * (before.magnitude + after.magnitude);
  return (std::fabs(after.sum - before.sum) + rounding) * surface.unit * surface.unit * surface.unit;
}

/// Where refinement needs so many times fewer triangles, faces may be below the bound on angles, but hardly any below
/// the second number.
constexpr double kFarFewer = 3, kNarrowDegrees = 10;

/// Returns whether far more free triangles have a small angle than plane patches had before. Needles side by side, as
/// of twisted strips, may be planes of two triangles each: these have good corners, and their triangles have not.
bool is_much_sharper(const FreeContext& context, const FreePart& part, const Coarsened& made, double min_angle_deg,
                     RunControl& control) {
  constexpr double kShare = 0.1;
  const double bound = std::cos(min_angle_deg * M_PI / 180);
  std::size_t sharp = 0, free_faces = 0;
  for (FaceId f(0); f.value < made.faces.size(); ++f.value) {
    if (!part.is_free(made.origin[f])) continue;
    const Triangle& t = made.faces[f];
    ++free_faces;
    if (max_cosine({made.positions[t[0]], made.positions[t[1]], made.positions[t[2]]}) > bound) ++sharp;
  }
  const double more = kShare * static_cast<double>(free_faces);
  return static_cast<double>(sharp) > more &&
         static_cast<double>(sharp) > more + static_cast<double>(sharp_patches(context, part, min_angle_deg, control));
}

/// Puts the faces that were made in the place of those of the part.
class SurfaceMaker {
 public:
  SurfaceMaker(const FreeContext& context, const FreePart& part, const Coarsened& made,
               const FilledIdVector<FaceId, FaceRole>& roles, RunControl& control)
      : context_(context), before_(context.surface), part_(part), made_(made), roles_(roles), control_(control) {}

  Coarser make(std::vector<Vec3>&& places) {
    find_what_stays();
    order_faces();
    add_vertices(std::move(places));
    add_faces();
    cover();
    coarser_.done.is_whole = part_.is_whole();
    coarser_.done.faces_before = part_.free_faces;
    return std::move(coarser_);
  }

 private:
  /// A face of the new surface: one of the surface before, or one that was made.
  struct NewFace {
    FaceId source;  ///< the input's face
    FaceId face;
    bool is_made;
  };

  /// Returns the surface's face from which a made face comes: the nearest one, if that is of the same region.
  FaceId source_face(FaceId f) const {
    const FaceId nearest = made_.nearest[f], origin = made_.origin[f];
    return part_.face[part_.region[nearest] == part_.region[origin] ? nearest : origin];
  }

  /// Finds the faces of the surface before that are still there: those of planes whose triangles are as they were. That
  /// all corners are there is not enough: where faces are split, lost corners may come back, and a face may have
  /// several others in its place, one of which has the same corners.
  void find_what_stays() {
    enum class State : std::uint8_t { kGone, kThere, kChanged };
    IdVector<FaceId, State> state(part_.faces.size(), State::kGone);
    StopCheck check(control_);
    for (FaceId f(0); f.value < made_.faces.size(); ++f.value) {
      check();
      const Triangle &corners = made_.faces[f], &before = part_.faces[made_.origin[f]];
      const Triangle now{made_.source[corners[0]], made_.source[corners[1]], made_.source[corners[2]]};
      const bool is_same = now == before || now == Triangle{before[1], before[2], before[0]} ||
                           now == Triangle{before[2], before[0], before[1]};
      State& of_origin = state[made_.origin[f]];
      of_origin = is_same && of_origin == State::kGone ? State::kThere : State::kChanged;
    }
    stays_.assign(before_.face_count(), 1);
    for (FaceId f(0); f.value < part_.faces.size(); ++f.value) {
      check();
      if (part_.is_free(f) || state[f] != State::kThere) stays_[part_.face[f]] = 0;
    }
  }

  void order_faces() {
    std::vector<NewFace> kept, made;
    StopCheck check(control_);
    for (FaceId f(0); f.value < before_.face_count(); ++f.value) {
      check();
      if (stays_[f] != 0) kept.push_back({before_.face_source[f], f, false});
    }
    for (FaceId f(0); f.value < made_.faces.size(); ++f.value)
      if (stays_[part_.face[made_.origin[f]]] == 0) made.push_back({before_.face_source[source_face(f)], f, true});
    const auto is_before = [](const NewFace& a, const NewFace& b) { return a.source < b.source; };
    std::stable_sort(made.begin(), made.end(), is_before);
    order_.resize(kept.size() + made.size());
    std::merge(kept.begin(), kept.end(), made.begin(), made.end(), order_.begin(), is_before);
  }

  /// Numbers the vertices: those of the surface before that are still used, then those that were moved.
  void add_vertices(std::vector<Vec3>&& places) {
    Surface& after = coarser_.replaced.surface;
    after.centre = before_.centre;
    after.unit = before_.unit;
    number_.resize(before_.vertex_count());
    std::vector<std::uint8_t> is_used(before_.vertex_count(), 0);
    for (const NewFace& face : order_) {
      if (!face.is_made) {
        for (const VertexId v : before_.face(face.face)) is_used[v.value] = 1;
        continue;
      }
      for (const VertexId v : made_.faces[face.face])
        if (made_.source[v].is_valid()) is_used[part_.vertex[made_.source[v]].value] = 1;
    }
    std::vector<Vec3> positions;
    for (VertexId v(0); v.value < before_.vertex_count(); ++v.value) {
      if (is_used[v.value] == 0) continue;
      number_[v] = VertexId(positions.size());
      positions.push_back(before_.positions[v]);
      after.vertex_source.push_back(before_.vertex_source[v]);
    }
    for (VertexId v(0); v.value < made_.positions.size(); ++v.value) {
      const VertexId source = made_.source[v];
      made_number_.push_back(source.is_valid() ? number_[part_.vertex[source]] : VertexId(positions.size()));
      if (source.is_valid()) continue;
      positions.push_back(places[v.value]);
      after.vertex_source.push_back(VertexId());
    }
    for (const Vec3& p : positions) after.local.push_back(before_.to_local(p));
    after.positions = std::move(positions);
  }

  void add_faces() {
    Surface& after = coarser_.replaced.surface;
    Coarsening& done = coarser_.done;
    FaceList faces;
    std::vector<FaceId> caps;
    std::vector<VertexId> loop;
    const SurfaceId free = any_free_surface();
    for (const NewFace& face : order_) {
      loop.clear();
      const FaceId origin = face.is_made ? source_face(face.face) : face.face;
      if (face.is_made) {
        for (const VertexId v : made_.faces[face.face]) {
          loop.push_back(made_number_[v]);
          // A new vertex has the source of a corner of the face that is nearest to one of its faces.
          VertexId& source = after.vertex_source[loop.back()];
          if (!source.is_valid()) source = before_.vertex_source[before_.face(origin)[0]];
        }
      } else {
        for (const VertexId v : before_.face(face.face)) loop.push_back(number_[v]);
        if (std::binary_search(before_.caps.begin(), before_.caps.end(), face.face))
          caps.push_back(FaceId(faces.face_count()));
      }
      faces.add_face(loop, face.source, before_.label(origin));
      SurfaceId surface = context_.recognised.of_patch[context_.patches.of_face[origin]];
      const bool is_free = roles_[origin] == FaceRole::kFree;
      if (is_free && context_.recognised.surfaces[surface].shape.kind != SurfaceKind::kFree) surface = free;
      done.surface_of.push_back(surface);
      done.is_new.push_back(face.is_made ? 1 : 0);
      done.faces_after += is_free ? 1 : 0;
    }
    after.take_faces(std::move(faces));
    after.caps = std::move(caps);
  }

  SurfaceId any_free_surface() const {
    const auto& surfaces = context_.recognised.surfaces;
    for (SurfaceId s(0); s.value < surfaces.size(); ++s.value)
      if (surfaces[s].shape.kind == SurfaceKind::kFree) return s;
    return {};
  }

  /// Tells which input faces the new faces cover: those for which each answers, or else the one next to it.
  void cover() {
    Surface& after = coarser_.replaced.surface;
    const std::size_t n = order_.size();
    // The places of faces among the new ones. What was made of a face that stays is not among them, but that face is.
    FilledIdVector<FaceId, std::uint32_t> of_made, of_kept;
    of_made.assign(made_.faces.size(), kNone);
    of_kept.assign(before_.face_count(), kNone);
    for (std::uint32_t i = 0; i < n; ++i) (order_[i].is_made ? of_made : of_kept)[order_[i].face] = i;
    const auto place_of = [&](FaceId f) -> std::size_t {
      return of_made[f] != kNone ? of_made[f] : of_kept[part_.face[made_.origin[f]]];
    };
    // A face without an answer is covered by the first one of its region.
    std::vector<FaceId> first_of_region;
    for (FaceId f(0); f.value < made_.faces.size(); ++f.value) {
      const std::uint32_t region = part_.region[made_.origin[f]];
      if (region >= first_of_region.size()) first_of_region.resize(region + 1);
      if (!first_of_region[region].is_valid()) first_of_region[region] = f;
    }
    const Grouping answered = group_by(
        part_.faces.size(), n + 1,
        [&](std::uint32_t g) -> std::size_t {
          const FaceId f(g);
          if (stays_[part_.face[f]] != 0) return n;
          const FaceId by = made_.answers[f];
          if (by.is_valid() && part_.region[made_.origin[by]] == part_.region[f]) return place_of(by);
          const FaceId first = first_of_region[part_.region[f]];
          return first.is_valid() ? place_of(first) : n;
        },
        control_);
    CoveredFaces covers;
    covers.begin.push_back(0);
    const auto add = [&](FaceId f) {
      const auto covered = before_.covered(f);
      covers.faces.insert(covers.faces.end(), covered.begin(), covered.end());
    };
    StopCheck check(control_);
    for (std::size_t i = 0; i < n; ++i) {
      const NewFace& face = order_[i];
      const std::size_t begin = covers.faces.size();
      if (!face.is_made) add(face.face);
      for (const std::uint32_t g : answered[i]) {
        check();
        add(part_.face[FaceId(g)]);
      }
      if (covers.faces.size() == begin) add(source_face(face.face));
      covers.begin.push_back(covers.faces.size());
    }
    after.covers = std::move(covers);
  }

  const FreeContext& context_;
  const Surface& before_;
  const FreePart& part_;
  const Coarsened& made_;
  const FilledIdVector<FaceId, FaceRole>& roles_;
  RunControl& control_;
  IdVector<FaceId, std::uint8_t> stays_;      ///< per face of the surface before
  std::vector<NewFace> order_;                ///< the new faces, ascending by source
  IdVector<VertexId, VertexId> number_;       ///< the new numbers of the vertices before
  IdVector<VertexId, VertexId> made_number_;  ///< those of the vertices that were made
  Coarser coarser_;
};

}  // namespace

namespace {

Topology topology_of(const Surface& surface, RunControl& control) {
  const Triangulated triangles(surface, control);
  control.memory().ask_for<Vec3>(surface.vertex_count());
  control.memory().ask_for<Triangle>(triangles.size());
  TriangleMesh mesh;
  mesh.positions.items() = {surface.local.items().begin(), surface.local.items().end()};
  for (std::size_t t = 0; t < triangles.size(); ++t) mesh.faces.push_back(triangles.triangle(t));
  return Topology(mesh, control);
}

/// Returns the option that has asked for a coarser surface, with its value.
std::string option_in_force(const Coarsening& done, const Options& options) {
  const std::string within = number_text(done.tolerance);
  if (!options.elements_per_circle) return "surface_tolerance=" + within;
  const bool is_limited = options.surface_tolerance || options.surface_tolerance_fraction;
  return "elements_per_circle=" + number_text(*options.elements_per_circle) +
         (is_limited ? " with surface_tolerance" : "") + " (within " + within +
         ", and less where the surface turns more)";
}

}  // namespace

std::optional<FreeGoals> free_goals_of(const CurvedGoals& curved, const Options& options) {
  constexpr double kMinAngleDeg = 25;  // unless one is asked for
  const bool is_asked = curved.tolerance ? *curved.tolerance > 0 : curved.elements_per_circle.has_value();
  if (!is_asked || !curved.may_cut_boundaries || options.keep_boundary_vertices || !(options.feature_angle_deg > 0))
    return std::nullopt;
  return FreeGoals{curved.tolerance, curved.elements_per_circle, options.min_angle_deg.value_or(kMinAngleDeg),
                   curved.keeps_volume, options.refine};
}

Diagnostic no_coarsening(const Coarsening& in_vain) {
  Diagnostic told{DiagnosticCode::kCurvedSurface, 1, {}, "faces of no kind stay as they are: "};
  const std::string coarser = "coarser ones within " + number_text(in_vain.tolerance);
  switch (in_vain.fault) {
    case CoarseningFault::kNone: break;
    case CoarseningFault::kDistance: told.message += coarser + " could not be proven"; break;
    case CoarseningFault::kTopology:
      told.message += coarser + " would have holes or parts that the input has not";
      break;
    case CoarseningFault::kIntersections: told.message += coarser + " would meet others"; break;
    case CoarseningFault::kAngles:
      told.message += "far more triangles of " + coarser + " would have small angles";
      break;
    case CoarseningFault::kAsManyFaces: told.message += coarser + " need no fewer triangles"; break;
  }
  if (in_vain.fault == CoarseningFault::kAngles) told.message += "; another surface_tolerance may help";
  return told;
}

Diagnostic coarsening(const Coarsening& done, const Surface& surface, const Options& options) {
  std::vector<FaceId> replaced;
  for (FaceId f(0); f.value < done.is_new.size(); ++f.value)
    if (done.is_new[f] != 0) replaced.insert(replaced.end(), surface.covered(f).begin(), surface.covered(f).end());
  std::sort(replaced.begin(), replaced.end());
  replaced.erase(std::unique(replaced.begin(), replaced.end()), replaced.end());
  Diagnostic told{DiagnosticCode::kCurvedSurface, 0, {}, ""};
  for (const FaceId f : replaced) told.add(f.value);
  told.message = std::string(done.is_whole ? "the surface" : "a part of the surface") + " is of no kind, so " +
                 option_in_force(done, options) + " made it coarser: " + grouped_digits(done.faces_before) +
                 " triangles became " + grouped_digits(done.faces_after) + " before refinement, at most " +
                 number_text(done.distance) + " apart (proven)" + "; surface_tolerance=0 keeps the facets";
  return told;
}

std::optional<Coarser> coarser_surface(const FreeContext& context, FreeGoals goals, Coarsening& in_vain,
                                       RunControl& control) {
  const Surface& before = context.surface;
  const Triangulated triangles(before, control);
  const FilledIdVector<FaceId, FaceRole> roles = roles_of(context, triangles, control);
  const FreePart part(context, triangles, roles, control);
  if (part.is_empty()) return std::nullopt;
  if (goals.tolerance) *goals.tolerance /= before.unit;
  const FreeTolerance allowed = tolerance_of(part, goals, control);
  if (!(allowed.largest > 0)) return std::nullopt;
  const double tolerance = before.unit * allowed.largest;
  FreeForm form = part.form();
  form.shares = allowed.shares;
  const FacesAround around{before.local.items(), part.kept, part.vertex.items()};
  in_vain.tolerance = tolerance;
  const auto needed = [&](const IdVector<VertexId, Vec3>& positions, const IdVector<FaceId, Triangle>& faces) {
    return triangles_needed(positions, faces, goals.is_refined ? goals.min_angle_deg : 0, control);
  };
  const double needed_before = needed(part.positions, part.faces);
  const auto is_wanted = [&](const Coarsened& made) {
    if (!is_much_sharper(context, part, made, goals.min_angle_deg, control)) return true;
    return goals.is_refined && kFarFewer * needed(made.positions, made.faces) <= needed_before &&
           !is_much_sharper(context, part, made, std::min(kNarrowDegrees, goals.min_angle_deg), control);
  };
  // The proof is repeated for the coordinates in model units, which were rounded. A bound near the tolerance may take
  // more work there than is allowed.
  std::vector<Vec3> old_places, places;
  for (const VertexId v : part.vertex) old_places.push_back(before.positions[v]);
  verification::TwoWayDistance measured;
  const auto last_faults = [&](const Coarsened& made) {
    places = model_places(made, part, before);
    measured = verification::distance_between({old_places, part.faces.items()}, {places, made.faces.items()}, tolerance,
                                              control);
    CoarseningFaults faults;
    for (const verification::FarFace& far : measured.a_to_b.far_faces) faults.far_input_faces.push_back(far.face);
    for (const verification::FarFace& far : measured.b_to_a.far_faces) faults.far_faces.push_back(far.face);
    return faults;
  };
  const std::optional<ProvenCoarsening> proven = coarsen_with_proof(
      form, around, {allowed.largest * (1 - kShareOfRounding), goals.min_angle_deg, goals.is_volume_kept}, is_wanted,
      last_faults, in_vain.fault, control);
  if (!proven) return std::nullopt;
  const Coarsened& made = proven->surface;
  in_vain.fault = CoarseningFault::kAsManyFaces;
  if (needed(made.positions, made.faces) >= needed_before) return std::nullopt;
  in_vain.fault = CoarseningFault::kAngles;
  if (!is_wanted(made)) return std::nullopt;
  in_vain.fault = CoarseningFault::kDistance;
  const double distance = std::max(measured.a_to_b.bound, measured.b_to_a.bound);
  if (!(distance <= tolerance)) return std::nullopt;
  const FacesAround in_model{before.positions.items(), part.kept, part.vertex.items()};
  const auto [crossing, are_all_known] = crossing_faces(part.form(), made, places, in_model, control);
  in_vain.fault = CoarseningFault::kIntersections;
  if (!crossing.empty() || !are_all_known) return std::nullopt;

  Coarser coarser = SurfaceMaker(context, part, made, roles, control).make(std::move(places));
  if (!are_different(std::vector<Vec3>(coarser.replaced.surface.positions.items().begin(),
                                       coarser.replaced.surface.positions.items().end()),
                     control))
    return std::nullopt;
  // Only the topology of the part has been compared so far.
  in_vain.fault = CoarseningFault::kTopology;
  if (!part.is_whole() && topology_of(coarser.replaced.surface, control) != topology_of(before, control))
    return std::nullopt;
  coarser.done.tolerance = tolerance;
  coarser.done.distance = distance;
  coarser.replaced.volume = volume_change(part, made, before);
  return coarser;
}

}  // namespace remesh
