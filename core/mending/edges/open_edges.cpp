#include "core/mending/edges/open_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "core/base/ids.h"
#include "core/base/stoppable.h"
#include "core/geometry/planes/projection.h"

namespace remesh {
namespace {

/// Edges with more faces than this are ignored, because there are too many pairs of such edges.
constexpr std::size_t kMaxFaces = 8;

}  // namespace

OpenEdges::OpenEdges(const Surface& surface, const Adjacency& edges, Which which, RunControl& control)
    : surface_(surface) {
  StopCheck check(control);
  // A list that grows to millions of items is copied several times, and these copies cannot be cancelled.
  edges_.reserve(edges.odd_edges().size());
  for (const EdgeId e : edges.odd_edges()) {
    check();
    const auto around = edges.half_edges(e);
    const VertexId from = edges.from(around[0]), to = edges.to(around[0]);
    if (around.size() > (which == Which::kOpen ? 1 : kMaxFaces) || from == to) continue;
    const auto forward = static_cast<std::size_t>(
        std::count_if(around.begin(), around.end(), [&](std::uint32_t h) { return edges.from(h) == from; }));
    if (2 * forward == around.size()) continue;
    for (const std::uint32_t h : around) {
      if ((edges.from(h) == from) != (2 * forward > around.size())) continue;
      OpenEdge& edge = edges_.emplace_back();
      edge.half_edge = h;
      edge.face = edges.face_of(h);
      edge.from = edges.from(h);
      edge.to = edges.to(h);
      edge.is_open = around.size() == 1;
    }
  }
  if (edges_.empty()) return;
  // The open edges are sorted by half-edge, so that the edges of one face are next to each other and a polygon is
  // measured only once.
  sort_stoppable(edges_.begin(), edges_.end(), control,
                 [](const OpenEdge& a, const OpenEdge& b) { return a.half_edge < b.half_edge; });
  FaceId last;
  Vec3 twice_area;
  double extent = 0;
  std::vector<Vec3> loop;
  for (OpenEdge& edge : edges_) {
    check();
    if (edge.face != last) {
      last = edge.face;
      loop.clear();
      Box3 box;
      for (const VertexId v : surface.face(last)) {
        check();
        loop.push_back(surface.local[v]);
        box.add(surface.local[v]);
      }
      twice_area = newell_normal(loop);
      extent = loop.size() == 3 ? std::max({norm(loop[1] - loop[0]), norm(loop[2] - loop[1]), norm(loop[0] - loop[2])})
                                : box.diagonal();
    }
    measure(edge, twice_area, extent);
  }
  const auto entries = Tree::make_entries(edges_.size(), control, [&](std::size_t i, Tree::Entry& entry) {
    entry.box.add(middle(i));
    entry.tag.box.add(middle(i));
  });
  tree_ = Tree(entries, control);
}

void OpenEdges::measure(OpenEdge& edge, const Vec3& twice_area, double extent) const {
  const Vec3 way = surface_.local[edge.to] - surface_.local[edge.from];
  const double size = norm(twice_area);
  edge.length = norm(way);
  edge.inward = normalized(cross(normalized(twice_area), normalized(way)));
  edge.height = extent > 0 ? size / extent : 0;
  const bool is_triangle = surface_.face(edge.face).size() == 3;
  edge.depth = is_triangle && edge.length > 0 ? size / edge.length : edge.height;
}

Vec3 OpenEdges::middle(std::size_t i) const {
  return 0.5 * surface_.local[edges_[i].from] + 0.5 * surface_.local[edges_[i].to];
}

Fit OpenEdges::fit(std::size_t i, std::size_t j, double reach) const {
  const OpenEdge &a = edges_[i], &b = edges_[j];
  if (i == j || (a.face == b.face && surface_.face(a.face).size() == 3)) return {};
  if (std::minmax(a.from, a.to) == std::minmax(b.from, b.to)) return {};
  const auto distance = [&](VertexId p, VertexId q) { return norm(surface_.local[p] - surface_.local[q]); };
  const double opposite = std::max(distance(a.from, b.to), distance(a.to, b.from));
  const double alike = std::max(distance(a.from, b.from), distance(a.to, b.to));
  const Fit fit{std::min(opposite, alike), alike < opposite};
  return do_lie_on_each_other(i, j, std::max(fit.width, reach)) ? Fit{} : fit;
}

bool OpenEdges::do_lie_on_each_other(std::size_t i, std::size_t j, double reach) const {
  // The distance between the two faces grows with the distance from their edges. If it is at most this many times
  // `reach` even at the far end of the face with the smaller depth, the faces count as lying on each other. Then it
  // cannot be decided whether they were meant to be a single face.
  constexpr double kOnEachOther = 4;
  const OpenEdge &a = edges_[i], &b = edges_[j];
  if (!(dot(a.inward, b.inward) > 0)) return false;
  return norm(cross(a.inward, b.inward)) * std::min(a.depth, b.depth) <= kOnEachOther * reach;
}

double OpenEdges::turn(std::size_t i, std::size_t j) const {
  const double cosine = -dot(edges_[i].inward, edges_[j].inward);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

double OpenEdges::angle_behind(std::size_t i, std::size_t j) const {
  const OpenEdge &a = edges_[i], &b = edges_[j];
  const Vec3 normal = cross(normalized(surface_.local[a.to] - surface_.local[a.from]), a.inward);
  const double angle = std::atan2(-dot(b.inward, normal), dot(b.inward, a.inward));
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

bool OpenEdges::is_before(std::size_t i, std::size_t j) const {
  const auto key = [&](const OpenEdge& edge) {
    return std::tuple(surface_.positions[edge.from], surface_.positions[edge.to], edge.half_edge);
  };
  return key(edges_[i]) < key(edges_[j]);
}

}  // namespace remesh
