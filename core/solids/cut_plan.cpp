#include "core/solids/cut_plan.h"

#include "core/base/stoppable.h"

namespace remesh {

CutSides::CutSides(const Soup& soup, const SoupEdges& edges, CutPlan& plan, RunControl& control)
    : soup_(soup), edges_(edges), plan_(plan) {
  struct Point {
    EdgeId edge;
    double place;
    VertexId vertex;
    auto operator<=>(const Point&) const = default;
  };
  StopCheck check(control);
  std::vector<Point> points;
  points.reserve(plan.on_edges.size());
  for (const auto& [edge, vertex] : plan.on_edges) {
    check();
    const auto [a, b] = edges.ends(edge);
    const VertexId image = plan.image_of(vertex);
    if (image == plan.image_of(a) || image == plan.image_of(b)) continue;
    const Vec3& from = soup.positions[a.value];
    points.push_back({edge, dot(soup.positions[image.value] - from, soup.positions[b.value] - from), image});
  }
  sort_stoppable(points.begin(), points.end(), control);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  plan.on_edges.clear();
  begin_.reserve(edges.count() + 1);
  for (const Point& p : points) {
    check();
    while (begin_.size() <= p.edge.value) begin_.push_back(static_cast<std::uint32_t>(plan.on_edges.size()));
    plan.on_edges.push_back({p.edge, p.vertex});
  }
  begin_.resize(edges.count() + 1, static_cast<std::uint32_t>(plan.on_edges.size()));
}

void CutSides::append_side(FaceId f, std::size_t k, std::vector<VertexId>& points) const {
  const auto append = [&](VertexId v) {
    if (points.empty() || points.back() != v) points.push_back(v);
  };
  const EdgeId e = edges_.of(f, k);
  const VertexId from = soup_.faces[f.value][k];
  append(plan_.image_of(from));
  const std::uint32_t begin = begin_[e.value], end = begin_[e.value + 1];
  const bool is_forward = edges_.ends(e).first == from;
  for (std::uint32_t i = begin; i < end; ++i) append(plan_.on_edges[is_forward ? i : begin + end - 1 - i].second);
}

void CutSides::append_outline(FaceId f, std::vector<VertexId>& points) const {
  const std::size_t first = points.size();
  for (std::size_t k = 0; k < 3; ++k) append_side(f, k, points);
  while (points.size() > first + 1 && points.back() == points[first]) points.pop_back();
}

}  // namespace remesh
