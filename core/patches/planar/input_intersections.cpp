#include "core/patches/planar/input_intersections.h"

#include <compare>
#include <cstdint>
#include <string>

#include "core/base/blocks.h"
#include "core/base/number_text.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/geometry/planes/projection.h"
#include "core/geometry/triangles/overlap.h"
#include "core/mending/polygons/polygon_split.h"

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
    // Two triangles of the polygon share a diagonal. They also share the bridge to a hole, but that is an edge of no
    // other face.
    sort_stoppable(sides.begin(), sides.end(), control);
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i] == sides[i - 1]) all.push_back({sides[i].first, sides[i].second, f});
  }
  sort_stoppable(all.begin(), all.end(), control);
  return all;
}

/// Calls add(f, g) for each polygon f and other face g such that an edge of g is a diagonal of f. Whatever the split of
/// the polygon, the two touch. Stops and returns false if add returns false.
template <class Add>
bool for_each_edge_on_a_diagonal(const Surface& surface, const Triangulated& faces, RunControl& control,
                                 const Add& add) {
  if (!faces.are_split()) return true;
  const std::vector<Diagonal> diagonals = diagonals_of(surface, faces, control);
  if (diagonals.empty()) return true;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    if (f % kItemsPerBlock == 0) control.check_and_move();
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

/// Reports which part of the search for intersections was done.
Diagnostic incomplete_check(const SelfIntersections& found, std::size_t faces) {
  const double left = (1 - found.searched) * static_cast<double>(faces);
  std::string message = "the search for faces that intersect was cut short, because it would take too long; " +
                        number_text(100 * found.searched, 2) + " % of the faces were held against all others";
  if (found.estimated_pairs > 0)
    message +=
        "; by an estimate from some of the faces, " + number_text(found.estimated_pairs, 1) + " pairs intersect in all";
  return {DiagnosticCode::kIncompleteCheck, std::max<std::uint64_t>(1, static_cast<std::uint64_t>(left)), {}, message};
}

}  // namespace

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
  SearchLimits limits(max_intersections(faces.size()), SearchLimits::steps_for(faces.size()));
  limits.is_estimate_wanted = true;
  const SelfIntersections found =
      patch_intersections({positions, faces.corners(), patch, normals, is_simple}, limits, control);

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
    if (pairs.size() >= 2 * kMaxIntersections) return false;
    pairs.push_back({std::min(f, g), std::max(f, g), false});
    return true;
  });
  const bool is_complete = found.is_complete && are_all_on_diagonals;
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.is_before(b); });

  const std::string at_least = is_complete ? "" : "; there are more pairs than were counted";
  Diagnostic crossing{DiagnosticCode::kSelfIntersection,
                      0,
                      {},
                      "pairs of faces cross or touch where they share no vertex or edge; `elements` lists the two "
                      "faces of each pair by number" +
                          at_least};
  Diagnostic overlap{
      DiagnosticCode::kOverlappingFaces,
      0,
      {},
      "pairs of faces overlap in one plane; `elements` lists the two faces of each pair by number" + at_least};
  FoundIntersections result;
  result.is_complete = is_complete;
  result.searched = found.searched;
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
  if (!found.is_complete) diagnostics.push_back(incomplete_check(found, faces.size()));
  return result;
}

}  // namespace remesh
