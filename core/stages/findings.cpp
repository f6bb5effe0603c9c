#include "core/stages/findings.h"

#include <algorithm>
#include <atomic>
#include <compare>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/geometry/overlap.h"
#include "core/mesh/triangle_corners.h"
#include "core/stages/polygon_split.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 8192;

/// Vertices at which the faces fall into fans that have no edge in common.
class PinchedVertices {
 public:
  PinchedVertices(const Surface& surface, const Adjacency& edges, RunControl& control)
      : surface_(surface), edges_(edges), control_(control), some_(surface.vertex_count()) {}

  std::vector<VertexId> find() {
    for_blocks(surface_.corners.size(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t h = begin; h < end; ++h)
        some_[surface_.corners[h].value].store(static_cast<std::uint32_t>(h + 1), std::memory_order_relaxed);
    });
    // A walk around most vertices meets all their faces, from whichever it starts. If so around all, all are met.
    const auto counts =
        map_blocks<std::size_t>(surface_.vertex_count(), kBlock, control_, [&](std::size_t begin, std::size_t end) {
          std::size_t count = 0;
          for (std::size_t v = begin; v < end; ++v) count += count_around(v);
          return count;
        });
    if (std::accumulate(counts.begin(), counts.end(), std::size_t{0}) == surface_.corners.size()) return {};

    std::vector<std::uint32_t> degree(surface_.vertex_count(), 0);
    for (std::size_t h = 0; h < surface_.corners.size(); ++h) {
      if (h % kBlock == 0) control_.check();
      ++degree[surface_.corners[h].value];
    }
    const auto found = map_blocks<std::vector<VertexId>>(surface_.vertex_count(), kBlock, control_,
                                                         [&](std::size_t begin, std::size_t end) {
                                                           std::vector<VertexId> odd;
                                                           for (std::size_t v = begin; v < end; ++v)
                                                             if (count_around(v) != degree[v])
                                                               odd.push_back(VertexId(v));
                                                           return odd;
                                                         });
    std::vector<std::uint8_t> is_odd(surface_.vertex_count(), 0);
    std::vector<VertexId> odd;
    for (const auto& vertices : found) odd.insert(odd.end(), vertices.begin(), vertices.end());
    for (const VertexId v : odd) is_odd[v.value] = 1;
    return count_fans(odd, is_odd, std::move(degree));
  }

 private:
  std::uint32_t before(std::uint32_t h) const {
    const std::uint32_t f = edges_.face_of(h).value;
    return h == surface_.face_begin[f] ? surface_.face_begin[f + 1] - 1 : h - 1;
  }

  /// How many corners at its first vertex are reached from h over edges of two faces that look the same way.
  std::uint32_t walk(std::uint32_t start) const {
    std::uint32_t count = 1;
    std::uint32_t h = edges_.twin(before(start));
    for (; h != Adjacency::kNone && h != start; h = edges_.twin(before(h))) ++count;
    if (h == start) return count;
    for (h = edges_.twin(start); h != Adjacency::kNone; h = edges_.twin(edges_.next(h))) ++count;
    return count;
  }

  /// The corners that a walk around a vertex meets.
  std::uint32_t count_around(std::size_t v) const {
    const std::uint32_t some = some_[v].load(std::memory_order_relaxed);
    return some == 0 ? 0 : walk(some - 1);
  }

  /// Of the others, joins the corners over whatever edges there are. `count`: the corners of each vertex.
  std::vector<VertexId> count_fans(const std::vector<VertexId>& odd, const std::vector<std::uint8_t>& is_odd,
                                   std::vector<std::uint32_t> count) {
    UnionFind fans(surface_.corners.size());
    const auto corner_at = [&](std::uint32_t h, VertexId v) { return edges_.from(h) == v ? h : edges_.next(h); };
    for (std::uint32_t e = 0; e < edges_.edge_count(); ++e) {
      if (e % kBlock == 0) control_.check();
      const auto around = edges_.half_edges(EdgeId(e));
      for (const VertexId v : {edges_.from(around[0]), edges_.to(around[0])}) {
        if (!is_odd[v.value]) continue;
        if (edges_.from(around[0]) == edges_.to(around[0])) {  // a repeated corner is no edge
          count[v.value] -= fans.join(around[0], edges_.next(around[0]));
          break;
        }
        for (const std::uint32_t h : around) count[v.value] -= fans.join(corner_at(around[0], v), corner_at(h, v));
      }
    }
    std::vector<VertexId> pinched;
    std::copy_if(odd.begin(), odd.end(), std::back_inserter(pinched), [&](VertexId v) { return count[v.value] > 1; });
    return pinched;
  }

  const Surface& surface_;
  const Adjacency& edges_;
  RunControl& control_;
  std::vector<std::atomic<std::uint32_t>> some_;  ///< of each vertex, one of its corners, counted from 1; 0: none
};

bool are_all_triangles(const Surface& surface) { return surface.corners.size() == 3 * surface.face_count(); }

/// A diagonal by which a polygon was split.
struct Diagonal {
  VertexId low, high;
  FaceId face;
  friend auto operator<=>(const Diagonal&, const Diagonal&) = default;
};

std::vector<Diagonal> diagonals_of(const Surface& surface, const Triangulated& faces) {
  std::vector<Diagonal> all;
  std::vector<std::pair<VertexId, VertexId>> sides;
  for (std::size_t begin = 0; begin < faces.face.size();) {
    const FaceId f = faces.face[begin];
    std::size_t end = begin;
    sides.clear();
    for (; end < faces.face.size() && faces.face[end] == f; ++end)
      for (std::size_t i = 0; i < 3; ++i)
        sides.push_back(std::minmax({faces.triangles[end][i], faces.triangles[end][(i + 1) % 3]}));
    begin = end;
    if (surface.face(f).size() == 3) continue;
    // Two of its triangles share it. So they do the bridge to a hole, which is no edge of another face.
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i] == sides[i - 1]) all.push_back({sides[i].first, sides[i].second, f});
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Calls add(f, g) for each polygon f that has an edge of another face g for a diagonal: however it is split, they
/// touch.
template <class Add>
void for_each_edge_on_a_diagonal(const Surface& surface, const Triangulated& faces, RunControl& control,
                                 const Add& add) {
  if (are_all_triangles(surface)) return;
  const std::vector<Diagonal> diagonals = diagonals_of(surface, faces);
  if (diagonals.empty()) return;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    if (f % kBlock == 0) control.check();
    const auto loop = surface.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto [low, high] = std::minmax({loop[i], loop[i + 1 == loop.size() ? 0 : i + 1]});
      auto d = std::lower_bound(diagonals.begin(), diagonals.end(), Diagonal{low, high, FaceId(0)});
      for (; d != diagonals.end() && d->low == low && d->high == high; ++d)
        if (d->face != FaceId(f)) add(d->face, FaceId(f));
    }
  }
}

}  // namespace

void find_defects(const Surface& welded, const Adjacency& edges, std::vector<Diagnostic>& diagnostics,
                  RunControl& control) {
  Diagnostic non_manifold{
      DiagnosticCode::kNonManifoldEdge, 0, {}, "edges have three or more faces; elements are faces"};
  Diagnostic pinched{DiagnosticCode::kNonManifoldVertex,
                     0,
                     {},
                     "vertices join faces that have no edge there in common; elements are vertices"};
  Diagnostic open{DiagnosticCode::kOpenBoundary, 0, {}, "edges have one face only; elements are faces"};
  struct Odd {
    std::vector<FaceId> open, non_manifold;  ///< a face at each such edge
  };
  const auto blocks = map_blocks<Odd>(edges.edge_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    Odd odd;
    for (std::size_t e = begin; e < end; ++e) {
      const auto around = edges.half_edges(EdgeId(e));
      if (around.size() == 2 || edges.from(around[0]) == edges.to(around[0])) continue;
      (around.size() == 1 ? odd.open : odd.non_manifold).push_back(edges.face_of(around[0]));
    }
    return odd;
  });
  for (const Odd& odd : blocks) {
    for (const FaceId f : odd.open) open.add(welded.face_source[f].value);
    for (const FaceId f : odd.non_manifold) non_manifold.add(welded.face_source[f].value);
  }
  for (const VertexId v : PinchedVertices(welded, edges, control).find()) pinched.add(welded.vertex_source[v].value);
  for (Diagnostic* d : {&non_manifold, &pinched, &open})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
}

Triangulated triangulated(const Surface& surface, RunControl& control) {
  Triangulated result;
  if (are_all_triangles(surface)) {
    result.triangles.resize(surface.face_count());
    result.face.resize(surface.face_count());
    for_blocks(surface.face_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        result.triangles[f] = {surface.corners[3 * f], surface.corners[3 * f + 1], surface.corners[3 * f + 2]};
        result.face[f] = FaceId(f);
      }
    });
    return result;
  }
  result.triangles.reserve(surface.face_count());
  result.face.reserve(surface.face_count());
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    if (i % 4096 == 0) control.check();
    const auto loop = surface.face(FaceId(i));
    const auto add = [&](VertexId a, VertexId b, VertexId c) {
      result.triangles.push_back({a, b, c});
      result.face.push_back(FaceId(i));
    };
    if (loop.size() == 3) {
      add(loop[0], loop[1], loop[2]);
      continue;
    }
    points.clear();
    for (const VertexId v : loop) points.push_back(surface.local[v]);
    for (const auto& [a, b, c] : split_polygon(points, 0, control).triangles) add(loop[a], loop[b], loop[c]);
  }
  return result;
}

FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control) {
  std::vector<PatchId> patch_of_triangle;
  if (!are_all_triangles(surface))
    for (const FaceId f : faces.face) patch_of_triangle.push_back(patches.of_face[f]);
  const std::span<const PatchId> patch = are_all_triangles(surface) ? patches.of_face.items() : patch_of_triangle;
  std::vector<Vec3> normals;
  normals.reserve(patches.count());
  for (const Plane& plane : patches.planes) normals.push_back(plane.normal);
  const std::vector<Vec3>& positions = surface.positions.items();
  const SelfIntersections found = patch_intersections(
      {positions, corners_of(faces.triangles), patch, normals, is_simple}, kMostIntersections, control);

  struct Pair {
    FaceId f, g;
    bool is_overlap;
    bool is_before(const Pair& other) const { return std::pair(f, g) < std::pair(other.f, other.g); }
  };
  std::vector<Pair> pairs;
  for (const auto& [t, u] : found.pairs) {
    const auto [f, g] = std::minmax({faces.face[t.value], faces.face[u.value]});
    if (f != g)
      pairs.push_back(
          {f, g, do_overlap(faces.triangles[t.value], faces.triangles[u.value], positions, plane_tolerance)});
  }
  for_each_edge_on_a_diagonal(surface, faces, control, [&](FaceId f, FaceId g) {
    if (pairs.size() < 2 * kMostIntersections) pairs.push_back({std::min(f, g), std::max(f, g), false});
  });
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.is_before(b); });

  const std::string at_least = found.is_complete ? "" : "; there are more";
  Diagnostic crossing{DiagnosticCode::kSelfIntersection,
                      0,
                      {},
                      "pairs of faces cross or touch where they share nothing; elements are faces" + at_least};
  Diagnostic overlap{DiagnosticCode::kOverlappingFaces,
                     0,
                     {},
                     "pairs of faces lie on each other in one plane; elements are faces" + at_least};
  FoundIntersections result;
  result.is_complete = found.is_complete;
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
