#include "core/stages/findings.h"

#include <algorithm>
#include <compare>
#include <span>
#include <string>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/geometry/overlap.h"
#include "core/stages/polygon_split.h"
#include "core/stages/projection.h"

namespace remesh {
namespace {

/// A diagonal by which a polygon was split.
struct Diagonal {
  VertexId low, high;
  FaceId face;
  friend auto operator<=>(const Diagonal&, const Diagonal&) = default;
};

std::vector<Diagonal> diagonals_of(const Surface& surface, const Triangulated& faces, RunControl& control) {
  std::vector<Diagonal> all;
  std::vector<std::pair<VertexId, VertexId>> sides;
  StopCheck check(control);
  for (std::size_t begin = 0; begin < faces.size();) {
    check();
    const FaceId f = faces.face(begin);
    std::size_t end = begin;
    sides.clear();
    for (; end < faces.size() && faces.face(end) == f; ++end) {
      const Triangle t = faces.triangle(end);
      for (std::size_t i = 0; i < 3; ++i) sides.push_back(std::minmax({t[i], t[(i + 1) % 3]}));
    }
    begin = end;
    if (surface.face(f).size() == 3) continue;
    // Two of its triangles share it. So they do the bridge to a hole, which is no edge of another face.
    sort_stoppable(sides.begin(), sides.end(), control);
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i] == sides[i - 1]) all.push_back({sides[i].first, sides[i].second, f});
  }
  sort_stoppable(all.begin(), all.end(), control);
  return all;
}

/// Calls add(f, g) for each polygon f that has an edge of another face g for a diagonal: however it is split, they
/// touch. Ends with false when add says that it is enough.
template <class Add>
bool for_each_edge_on_a_diagonal(const Surface& surface, const Triangulated& faces, RunControl& control,
                                 const Add& add) {
  if (!faces.are_split()) return true;
  const std::vector<Diagonal> diagonals = diagonals_of(surface, faces, control);
  if (diagonals.empty()) return true;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    if (f % kItemsPerBlock == 0) control.check();
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto [low, high] = std::minmax({loop[i], loop[i + 1 == loop.size() ? 0 : i + 1]});
      auto d = std::lower_bound(diagonals.begin(), diagonals.end(), Diagonal{low, high, FaceId(0)});
      for (; d != diagonals.end() && d->low == low && d->high == high; ++d)
        if (d->face != FaceId(f) && !add(d->face, FaceId(f))) return false;
    }
  }
  return true;
}

double area_of(const std::vector<Vec3>& loop) { return norm(newell_normal(loop)) / 2; }

/// Whether a polygon is as flat as rounding leaves one.
bool is_flat(const std::vector<Vec3>& loop) {
  const Vec3 normal = normalized(newell_normal(loop));
  Box3 box;
  double low = 0, high = 0;
  for (const Vec3& p : loop) {
    box.add(p);
    low = std::min(low, dot(p - loop[0], normal));
    high = std::max(high, dot(p - loop[0], normal));
  }
  return high - low <= kToleranceCeiling * box.diagonal();
}

}  // namespace

void find_defects(const Surface& welded, const Adjacency& edges, std::span<const VertexId> pinched,
                  std::vector<Diagnostic>& diagnostics, RunControl& control) {
  Diagnostic non_manifold{
      DiagnosticCode::kNonManifoldEdge, 0, {}, "edges have three or more faces; elements are faces"};
  Diagnostic joined{DiagnosticCode::kNonManifoldVertex,
                    0,
                    {},
                    "vertices join faces that have no edge there in common; elements are vertices"};
  Diagnostic open{DiagnosticCode::kOpenBoundary, 0, {}, "edges have one face only; elements are faces"};
  StopCheck check(control);
  for (const EdgeId e : edges.odd_edges()) {
    check();
    const auto around = edges.half_edges(e);
    if (around.size() == 2 || edges.from(around[0]) == edges.to(around[0])) continue;
    (around.size() == 1 ? open : non_manifold).add(welded.face_source[edges.face_of(around[0])].value);
  }
  for (const VertexId v : pinched) joined.add(welded.vertex_source[v].value);
  for (Diagnostic* d : {&non_manifold, &joined, &open})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
}

std::size_t Triangulated::first_of(FaceId f) const {
  if (!are_split()) return f.value;
  return static_cast<std::size_t>(std::lower_bound(face_.begin(), face_.end(), f) - face_.begin());
}

Triangulated::Triangulated(const Surface& surface, RunControl& control, double tolerance)
    : surface_(&surface), are_split_(surface.corners.size() != 3 * surface.face_count()) {
  if (!are_split_) return;
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    if (i % kItemsPerBlock == 0) control.check();
    double area = 0;
    const PolygonKind kind = visit_triangles(
        surface, FaceId(i), control,
        [&](const Triangle& t) {
          corners_.insert(corners_.end(), t.begin(), t.end());
          face_.push_back(FaceId(i));
          area += area_of({surface.local[t[0]], surface.local[t[1]], surface.local[t[2]]});
        },
        tolerance);
    if (kind != PolygonKind::kSelfCrossing) continue;
    std::vector<Vec3> outline;
    for (const VertexId v : surface.face(FaceId(i))) outline.push_back(surface.local[v]);
    if (is_flat(outline)) excess_area_ += std::max(0.0, area - area_of(outline));
  }
}

FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control) {
  std::vector<PatchId> patch_of_triangle;
  std::span<const PatchId> patch = patches.of_face.items();
  if (faces.are_split()) {
    StopCheck check(control);
    for (std::size_t t = 0; t < faces.size(); ++t) {
      check();
      patch_of_triangle.push_back(patches.of_face[faces.face(t)]);
    }
    patch = patch_of_triangle;
  }
  std::vector<Vec3> normals;
  normals.reserve(patches.count());
  for (const Plane& plane : patches.planes) normals.push_back(plane.normal);
  const std::span<const Vec3> positions = surface.positions.items();
  const SelfIntersections found =
      patch_intersections({positions, faces.corners(), patch, normals, is_simple}, kMostIntersections, control);

  struct Pair {
    FaceId f, g;
    bool is_overlap;
    bool is_before(const Pair& other) const { return std::pair(f, g) < std::pair(other.f, other.g); }
  };
  std::vector<Pair> pairs;
  StopCheck check(control);
  for (const auto& [t, u] : found.pairs) {
    check();
    const auto [f, g] = std::minmax({faces.face(t.value), faces.face(u.value)});
    if (f != g)
      pairs.push_back({f, g, do_overlap(faces.triangle(t.value), faces.triangle(u.value), positions, plane_tolerance)});
  }
  const bool are_all_on_diagonals = for_each_edge_on_a_diagonal(surface, faces, control, [&](FaceId f, FaceId g) {
    if (pairs.size() >= 2 * kMostIntersections) return false;
    pairs.push_back({std::min(f, g), std::max(f, g), false});
    return true;
  });
  const bool is_complete = found.is_complete && are_all_on_diagonals;
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.is_before(b); });

  const std::string at_least = is_complete ? "" : "; there are more";
  Diagnostic crossing{DiagnosticCode::kSelfIntersection,
                      0,
                      {},
                      "pairs of faces cross or touch where they share nothing; elements are faces" + at_least};
  Diagnostic overlap{DiagnosticCode::kOverlappingFaces,
                     0,
                     {},
                     "pairs of faces lie on each other in one plane; elements are faces" + at_least};
  FoundIntersections result;
  result.is_complete = is_complete;
  for (std::size_t i = 0; i < pairs.size();) {
    bool is_overlap = false;
    std::size_t next = i;
    for (; next < pairs.size() && !pairs[i].is_before(pairs[next]); ++next)
      is_overlap = is_overlap || pairs[next].is_overlap;
    result.pairs.push_back({pairs[i].f, pairs[i].g});
    (is_overlap ? overlap : crossing)
        .add_pair(surface.face_source[pairs[i].f].value, surface.face_source[pairs[i].g].value);
    i = next;
  }
  for (Diagnostic* d : {&crossing, &overlap})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
  return result;
}

}  // namespace remesh
