#include "core/stages/findings.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/geometry/overlap.h"
#include "core/stages/polygon_split.h"

namespace remesh {
namespace {

constexpr std::size_t kBlock = 8192;

/// Vertices at which the faces fall into fans that have no edge in common.
class PinchedVertices {
 public:
  PinchedVertices(const Surface& surface, const Adjacency& edges, RunControl& control)
      : surface_(surface), edges_(edges), control_(control) {}

  std::vector<VertexId> find() {
    degree_.assign(surface_.vertex_count(), 0);
    some_.assign(surface_.vertex_count(), Adjacency::kNone);
    for (std::uint32_t h = 0; h < surface_.corners.size(); ++h) {
      if (h % kBlock == 0) control_.check();
      ++degree_[surface_.corners[h].value];
      some_[surface_.corners[h].value] = h;
    }
    // A walk around most vertices meets all their faces.
    const auto found = map_blocks<std::vector<VertexId>>(surface_.vertex_count(), kBlock, control_,
                                                         [&](std::size_t begin, std::size_t end) {
                                                           std::vector<VertexId> odd;
                                                           for (std::size_t v = begin; v < end; ++v)
                                                             if (degree_[v] > 1 && walk(some_[v]) != degree_[v])
                                                               odd.push_back(VertexId(v));
                                                           return odd;
                                                         });
    std::vector<std::uint8_t> is_odd(surface_.vertex_count(), 0);
    std::vector<VertexId> odd;
    for (const auto& vertices : found) odd.insert(odd.end(), vertices.begin(), vertices.end());
    for (const VertexId v : odd) is_odd[v.value] = 1;
    return odd.empty() ? odd : count_fans(odd, is_odd);
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

  /// Of the others, joins the corners over whatever edges there are.
  std::vector<VertexId> count_fans(const std::vector<VertexId>& odd, const std::vector<std::uint8_t>& is_odd) {
    UnionFind fans(surface_.corners.size());
    std::vector<std::uint32_t> count(surface_.vertex_count(), 0);
    for (std::uint32_t h = 0; h < surface_.corners.size(); ++h) ++count[surface_.corners[h].value];
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
  std::vector<std::uint32_t> degree_, some_;  ///< of each vertex: how many corners, and the last of them
};

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
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
    if (e % kBlock == 0) control.check();
    const auto around = edges.half_edges(EdgeId(e));
    const std::uint32_t h = around[0];
    if (edges.from(h) == edges.to(h)) continue;
    const std::uint32_t source = welded.face_source[edges.face_of(h)].value;
    if (around.size() == 1) open.add(source);
    if (around.size() > 2) non_manifold.add(source);
  }
  for (const VertexId v : PinchedVertices(welded, edges, control).find()) pinched.add(welded.vertex_source[v].value);
  for (Diagnostic* d : {&non_manifold, &pinched, &open})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
}

Triangulated triangulated(const Surface& surface, RunControl& control) {
  Triangulated result;
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
  std::vector<PatchId> patch;
  patch.reserve(faces.face.size());
  for (const FaceId f : faces.face) patch.push_back(patches.of_face[f]);
  std::vector<Vec3> normals;
  normals.reserve(patches.count());
  for (const Plane& plane : patches.planes) normals.push_back(plane.normal);
  const std::vector<Vec3>& positions = surface.positions.items();
  const SelfIntersections found =
      patch_intersections({positions, faces.triangles, patch, normals, is_simple}, kMostIntersections, control);

  struct Pair {
    FaceId f, g;
    bool is_overlap;
    bool is_before(const Pair& other) const { return std::pair(f, g) < std::pair(other.f, other.g); }
  };
  std::vector<Pair> pairs;
  for (const auto& [t, u] : found.pairs) {
    const auto [f, g] = std::minmax(faces.face[t.value], faces.face[u.value]);
    if (f != g)
      pairs.push_back(
          {f, g, do_overlap(faces.triangles[t.value], faces.triangles[u.value], positions, plane_tolerance)});
  }
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
