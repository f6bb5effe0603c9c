#include "core/stages/findings.h"

#include "core/stages/polygon_split.h"

namespace remesh {

void find_defects(const Surface& welded, const Adjacency& edges, const MeshStatistics& statistics,
                  std::vector<Diagnostic>& diagnostics) {
  Diagnostic non_manifold{
      DiagnosticCode::kNonManifoldEdge, 0, {}, "edges have three or more faces; elements are faces"};
  Diagnostic open{DiagnosticCode::kOpenBoundary, 0, {}, "edges have one face only; elements are faces"};
  Diagnostic winding{
      DiagnosticCode::kInconsistentWinding, 0, {}, "edges have two faces that look opposite ways; elements are faces"};
  Diagnostic inside_out{DiagnosticCode::kInsideOut, 0, {}, "the surface is closed and encloses a negative volume"};
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
    const auto around = edges.half_edges(EdgeId(e));
    const std::uint32_t h = around[0];
    if (edges.from(h) == edges.to(h)) continue;
    const std::uint32_t source = welded.face_source[edges.face_of(h)].value;
    if (around.size() == 1) open.add(source);
    if (around.size() > 2) non_manifold.add(source);
    if (around.size() == 2 && edges.twin(h) == Adjacency::kNone) winding.add(source);
  }
  if (statistics.volume && *statistics.volume < 0) inside_out.add(0);
  for (Diagnostic* d : {&non_manifold, &open, &winding, &inside_out})
    if (d->count > 0) diagnostics.push_back(std::move(*d));
}

std::vector<Triangle> triangulated(const Surface& surface, RunControl& control) {
  std::vector<Triangle> triangles;
  triangles.reserve(surface.face_count());
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    if (i % 4096 == 0) control.check();
    const auto loop = surface.face(FaceId(i));
    if (loop.size() == 3) {
      triangles.push_back({loop[0], loop[1], loop[2]});
      continue;
    }
    points.clear();
    for (const VertexId v : loop) points.push_back(surface.local[v]);
    for (const auto& [a, b, c] : split_polygon(points, 0, control).triangles)
      triangles.push_back({loop[a], loop[b], loop[c]});
  }
  return triangles;
}

}  // namespace remesh
