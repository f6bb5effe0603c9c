#include "core/verify/boundary_graph.h"

#include <utility>

namespace remesh::verification {

BoundaryGraph::BoundaryGraph(std::size_t vertex_count, std::vector<Edge> edges)
    : edges_(std::move(edges)), degree_(vertex_count, 0), incident_(vertex_count) {
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    for (const VertexId v : {edges_[e].low, edges_[e].high}) {
      std::uint32_t& degree = degree_[v.value];
      if (degree < 2) incident_[v.value][degree] = e;
      ++degree;
    }
}

}  // namespace remesh::verification
