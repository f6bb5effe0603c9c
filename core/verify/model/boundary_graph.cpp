#include "core/verify/model/boundary_graph.h"

#include <utility>

namespace remesh::verification {

BoundaryGraph::BoundaryGraph(std::size_t vertex_count, BoundingEdges bounding, RunControl& control)
    : bounding_(std::move(bounding)), node_of_(vertex_count, 0), nodes_(1) {
  StopCheck check(control);
  for (std::uint32_t e = 0; e < edges().size(); ++e)
    for (const VertexId v : {edges()[e].low, edges()[e].high}) {
      check();
      std::uint32_t& number = node_of_[v.value];
      if (number == 0) {
        number = static_cast<std::uint32_t>(nodes_.size());
        nodes_.emplace_back();
      }
      Node& node = nodes_[number];
      if (node.degree < 2) node.edges[node.degree] = e;
      ++node.degree;
    }
}

}  // namespace remesh::verification
