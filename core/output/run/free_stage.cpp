#include "core/output/run/free_stage.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/free_form/free_form.h"
#include "core/geometry/intersections/self_intersections.h"
#include "core/output/report/surface_words.h"
#include "core/output/run/proven_coarsening.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh {
namespace {

/// A plane with more than this many times the area of the median facet is a plane that somebody has made.
constexpr double kLargePlane = 20;
/// The share of the tolerance that rounding to model units may take.
constexpr double kShareOfRounding = 1e-9;

bool is_of_triangles(const Surface& surface) { return surface.corners.size() == 3 * surface.face_count(); }

Vec3 twice_area(const Surface& surface, FaceId f) {
  const auto face = surface.face(f);
  const Vec3& a = surface.local[face[0]];
  return cross(surface.local[face[1]] - a, surface.local[face[2]] - a);
}

/// The surface as the engine takes it.
struct FreeTriangles {
  FreeTriangles(const FreeContext& context, RunControl& control) {
    const Surface& surface = context.surface;
    positions.items().assign(surface.local.items().begin(), surface.local.items().end());
    faces.resize(surface.face_count());
    twins.resize(surface.corners.size());
    edges.assign(surface.corners.size(), FreeForm::Edge::kSmooth);
    const double least_cosine = std::cos(context.feature_angle_deg * M_PI / 180);
    for_blocks(faces.size(), kItemsPerBlock, control, [&](std::size_t f, std::size_t end) {
      for (; f < end; ++f) {
        const auto face = surface.face(FaceId(f));
        faces[FaceId(f)] = {face[0], face[1], face[2]};
        const Vec3 normal = twice_area(surface, FaceId(f));
        for (auto h = static_cast<std::uint32_t>(3 * f); h < 3 * f + 3; ++h) {
          twins[h] = context.adjacency.twin(h);
          if (twins[h] == kNone) continue;
          const Vec3 other = twice_area(surface, FaceId(twins[h] / 3));
          if (dot(normal, other) < least_cosine * norm(normal) * norm(other)) edges[h] = FreeForm::Edge::kFeature;
        }
      }
    });
  }
  FreeForm form() const { return {positions, faces, twins, edges, {}}; }

  IdVector<VertexId, Vec3> positions;
  IdVector<FaceId, Triangle> faces;
  std::vector<std::uint32_t> twins;
  std::vector<FreeForm::Edge> edges;
};

/// Returns the places of the new vertices in model units. Vertices that stay have their coordinates bit for bit.
std::vector<Vec3> model_places(const Coarsened& made, const Surface& before) {
  std::vector<Vec3> places;
  places.reserve(made.positions.size());
  for (VertexId v(0); v.value < made.positions.size(); ++v.value)
    places.push_back(made.source[v].is_valid() ? before.positions[made.source[v]]
                                               : before.centre + before.unit * made.positions[v]);
  return places;
}

/// The volume under triangles, in cubed local units, with the sum of the sizes of its parts.
struct Volume {
  double sum = 0, magnitude = 0;
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double part = dot(a, cross(b, c)) / 6;
    sum += part;
    magnitude += std::fabs(part);
  }
};

/// Returns a bound on the change of the volume, in cubed model units.
double volume_change(const FreeTriangles& before, const Coarsened& made, const Surface& surface) {
  Volume old_volume, new_volume;
  for (const Triangle& t : before.faces)
    old_volume.add(before.positions[t[0]], before.positions[t[1]], before.positions[t[2]]);
  for (const Triangle& t : made.faces) new_volume.add(made.positions[t[0]], made.positions[t[1]], made.positions[t[2]]);
  const double rounding = 0x1p-50 * static_cast<double>(before.faces.size() + made.faces.size() + 16) *
                          (old_volume.magnitude + new_volume.magnitude);
  return (std::fabs(new_volume.sum - old_volume.sum) + rounding) * surface.unit * surface.unit * surface.unit;
}

/// Returns the input faces that the new faces cover, in the order of these: those for which each answers, or else the
/// one next to it.
CoveredFaces covers_of(const Coarsened& made, const std::vector<FaceId>& order, const Surface& before,
                       RunControl& control) {
  const std::size_t n = made.faces.size();
  const Grouping answered = group_by(
      made.answers.size(), n + 1,
      [&](std::uint32_t f) {
        const FaceId by = made.answers[FaceId(f)];
        return by.is_valid() ? std::size_t{by.value} : n;
      },
      control);
  CoveredFaces covers;
  covers.begin.push_back(0);
  const auto add = [&](FaceId f) {
    const auto covered = before.covered(f);
    covers.faces.insert(covers.faces.end(), covered.begin(), covered.end());
  };
  StopCheck check(control);
  for (const FaceId f : order) {
    for (const std::uint32_t g : answered[f.value]) {
      check();
      add(FaceId(g));
    }
    if (answered[f.value].empty()) add(made.nearest[f]);
    covers.begin.push_back(covers.faces.size());
  }
  return covers;
}

Surface make_surface(const Coarsened& made, std::vector<Vec3>&& places, const Surface& before, RunControl& control) {
  Surface after;
  after.centre = before.centre;
  after.unit = before.unit;
  for (const Vec3& p : places) after.local.push_back(before.to_local(p));
  after.positions = std::move(places);
  const auto source_of = [&](FaceId f) { return before.face_source[made.nearest[f]]; };
  std::vector<FaceId> order(made.faces.size());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = FaceId(f);
  std::stable_sort(order.begin(), order.end(), [&](FaceId f, FaceId g) { return source_of(f) < source_of(g); });
  FaceList faces;
  after.vertex_source.resize(made.positions.size());
  for (const FaceId f : order) {
    faces.add_face(made.faces[f], source_of(f), 0);
    // A new vertex has the source of a corner of the face that is nearest to one of its faces.
    const VertexId near = before.vertex_source[before.face(made.nearest[f])[0]];
    for (const VertexId v : made.faces[f])
      after.vertex_source[v] = made.source[v].is_valid() ? before.vertex_source[made.source[v]] : near;
  }
  after.take_faces(std::move(faces));
  after.covers = covers_of(made, order, before, control);
  return after;
}

}  // namespace

bool is_free_as_a_whole(const FreeContext& context, RunControl& control) {
  const Surface& surface = context.surface;
  if (!is_of_triangles(surface) || !surface.face_label.empty() || surface.face_count() == 0) return false;
  const auto& surfaces = context.recognised.surfaces;
  const auto is_kind = [](SurfaceKind kind) {
    return [kind](const RecognisedSurface& s) { return s.shape.kind == kind; };
  };
  if (std::none_of(surfaces.begin(), surfaces.end(), is_kind(SurfaceKind::kFree))) return false;
  if (!std::all_of(surfaces.begin(), surfaces.end(), [&](const RecognisedSurface& s) {
        return s.shape.kind == SurfaceKind::kFree || s.shape.kind == SurfaceKind::kPlane;
      }))
    return false;
  std::vector<double> areas(surface.face_count());
  for_blocks(areas.size(), kItemsPerBlock, control, [&](std::size_t f, std::size_t end) {
    for (; f < end; ++f) areas[f] = norm(twice_area(surface, FaceId(f)));
  });
  std::vector<double> sorted = areas;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  StopCheck check(control);
  for (PatchId p(0); p.value < context.patches.count(); ++p.value) {
    const auto faces = context.patches.faces_of(p);
    if (faces.size() == 1) continue;
    double area = 0;
    for (const FaceId f : faces) {
      check();
      area += areas[f.value];
    }
    if (area > kLargePlane * *middle) return false;
  }
  return true;
}

Diagnostic coarsening(const Coarsening& done, std::size_t faces, std::size_t input_faces, double tolerance) {
  Diagnostic told{DiagnosticCode::kCurvedSurface, 0, {}, ""};
  for (FaceId f(0); f.value < input_faces; ++f.value) told.add(f.value);
  told.message = "the surface is of no kind, so surface_tolerance=" + number_text(tolerance) +
                 " made it coarser: " + grouped_digits(done.faces_before) + " triangles became " +
                 grouped_digits(faces) + " before refinement, at most " + number_text(done.distance) +
                 " apart (proven); surface_tolerance=0 keeps the facets";
  return told;
}

std::optional<Replaced> coarser_surface(const FreeContext& context, double tolerance, double min_angle_deg,
                                        RunControl& control) {
  const Surface& before = context.surface;
  const FreeTriangles triangles(context, control);
  CoarseningFault fault = CoarseningFault::kNone;
  const std::optional<ProvenCoarsening> proven = coarsen_with_proof(
      triangles.form(), {tolerance / before.unit * (1 - kShareOfRounding), min_angle_deg}, fault, control);
  if (!proven || proven->surface.faces.size() >= before.face_count()) return std::nullopt;
  const Coarsened& made = proven->surface;
  std::vector<Vec3> places = model_places(made, before);
  if (!are_different(places, control)) return std::nullopt;
  // The proof is repeated for the coordinates in model units, which were rounded.
  const verification::TwoWayDistance measured = verification::distance_between(
      {before.positions.items(), triangles.faces.items()}, {places, made.faces.items()}, tolerance, control);
  const double distance = std::max(measured.a_to_b.bound, measured.b_to_a.bound);
  if (!(distance <= tolerance)) return std::nullopt;
  const SearchLimits limits(SearchLimits::kEnoughPairs, SearchLimits::steps_for(made.faces.size()));
  const SelfIntersections found = self_intersections(places, made.faces.items(), {}, limits, control);
  if (!found.pairs.empty() || !found.is_complete) return std::nullopt;

  Replaced replaced;
  replaced.distance = distance;
  replaced.volume = volume_change(triangles, made, before);
  replaced.surface = make_surface(made, std::move(places), before, control);
  return replaced;
}

}  // namespace remesh
