#include "core/mending/faces/input_defects.h"

#include <utility>

#include "core/base/stoppable.h"

namespace remesh {

void find_defects(const Surface& welded, const Adjacency& edges, std::span<const VertexId> pinched,
                  std::vector<Diagnostic>& diagnostics, RunControl& control) {
  Diagnostic non_manifold{DiagnosticCode::kNonManifoldEdge,
                          0,
                          {},
                          "edges have three or more faces; `elements` lists the first face of each edge by number"};
  Diagnostic joined{DiagnosticCode::kNonManifoldVertex,
                    0,
                    {},
                    "vertices join groups of faces that share no edge there; `elements` lists the vertices by number"};
  Diagnostic open{DiagnosticCode::kOpenBoundary,
                  0,
                  {},
                  "edges have only one face; `elements` lists the face of each edge by number"};
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

}  // namespace remesh
