#include "core/mending/open_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <tuple>

#include "core/base/parallel.h"
#include "core/geometry/projection.h"

namespace remesh {
namespace {

constexpr std::uint32_t kBetweenChecks = 4096;

}  // namespace

OpenEdges::OpenEdges(const Surface& surface, const Adjacency& edges, RunControl& control) : surface_(surface) {
  std::uint32_t looks = 0;
  for (const EdgeId e : edges.odd_edges()) {
    if (looks++ % kBetweenChecks == 0) control.check();
    const auto around = edges.half_edges(e);
    const VertexId from = edges.from(around[0]), to = edges.to(around[0]);
    if (around.size() != 1 || from == to) continue;
    OpenEdge& edge = edges_.emplace_back();
    edge.half_edge = around[0];
    edge.face = edges.face_of(around[0]);
    edge.from = from;
    edge.to = to;
  }
  if (edges_.empty()) return;
  // By half-edge, so that those of one face are next to each other and a polygon is measured once.
  sort_all(edges_.begin(), edges_.end(), [&](const OpenEdge& a, const OpenEdge& b) {
    control.check();
    return a.half_edge < b.half_edge;
  });
  FaceId last;
  Vec3 twice_area;
  double extent = 0;
  std::vector<Vec3> loop;
  for (OpenEdge& edge : edges_) {
    if (looks++ % kBetweenChecks == 0) control.check();
    if (edge.face != last) {
      last = edge.face;
      loop.clear();
      Box3 box;
      for (const VertexId v : surface.face(last)) {
        loop.push_back(surface.local[v]);
        box.add(surface.local[v]);
      }
      twice_area = newell_normal(loop);
      extent = loop.size() == 3 ? std::max({norm(loop[1] - loop[0]), norm(loop[2] - loop[1]), norm(loop[0] - loop[2])})
                                : box.diagonal();
    }
    measure(edge, twice_area, extent);
  }
  std::vector<Tree::Entry> entries(edges_.size());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (i % kBetweenChecks == 0) control.check();
    entries[i].box.add(middle(i));
    entries[i].tag.box.add(middle(i));
  }
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

double OpenEdges::width(std::size_t i, std::size_t j, double reach) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  // Of what lies on each other within so many times the distance nobody can tell whether it was meant to be one.
  constexpr double kOnEachOther = 4;
  const OpenEdge &a = edges_[i], &b = edges_[j];
  if (i == j || (a.face == b.face && surface_.face(a.face).size() == 3)) return kNone;
  const auto distance = [&](VertexId p, VertexId q) { return norm(surface_.local[p] - surface_.local[q]); };
  const double width = std::max(distance(a.from, b.to), distance(a.to, b.from));
  if (dot(a.inward, b.inward) > 0) {
    const double opening = norm(cross(a.inward, b.inward)) * std::min(a.depth, b.depth);
    if (opening <= kOnEachOther * std::max(width, reach)) return kNone;
  }
  return width;
}

std::string few_digits(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", length);
  return text;
}

bool OpenEdges::is_before(std::size_t i, std::size_t j) const {
  const auto key = [&](const OpenEdge& edge) {
    return std::tuple(surface_.positions[edge.from], surface_.positions[edge.to], edge.half_edge);
  };
  return key(edges_[i]) < key(edges_[j]);
}

}  // namespace remesh
