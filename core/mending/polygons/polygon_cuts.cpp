#include "core/mending/polygons/polygon_cuts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/stoppable.h"

namespace remesh {

PolygonCuts::PolygonCuts(Surface& surface, RunControl& control)
    : surface_(surface),
      edges_(surface.vertex_count(), surface.face_begin, surface.corners, control),
      places_(surface.positions.begin(), surface.positions.end()) {
  sort_stoppable(places_.begin(), places_.end(), control);
}

std::vector<PolygonCuts::Corners> PolygonCuts::cut(std::span<const VertexId> loop, const PolygonSplit& split) {
  auto triangles = split.triangles;
  // A quadrilateral that crosses itself is cut equally badly by either diagonal.
  const bool has_choice =
      split.kind == PolygonKind::kSelfCrossing || (split.kind == PolygonKind::kNotPlanar && split.has_two_ways);
  if (loop.size() == 4 && has_choice && is_taken(loop[0], loop[2]) != is_taken(loop[1], loop[3])) {
    if (is_taken(loop[0], loop[2]))
      triangles = {{0, 1, 3}, {1, 2, 3}};
    else
      triangles = {{0, 1, 2}, {0, 2, 3}};
  }

  // The key is a pair of vertices and not of corners, because a loop may pass a vertex or an edge more than once. Each
  // cut occurs twice, once for each of its sides.
  std::map<Edge, std::optional<VertexId>> vertex_of;
  for (std::size_t i = 0; i < loop.size(); ++i) vertex_of[std::minmax(loop[i], loop[(i + 1) % loop.size()])] = {};
  std::vector<Corners> result;
  std::vector<VertexId> around;
  for (const auto& t : triangles) {
    around.clear();
    std::size_t apex = 0;  // a corner that sees every edge of the outline
    for (int side = 0; side < 3; ++side) {
      const VertexId a = loop[t[side]], b = loop[t[(side + 1) % 3]];
      around.push_back(a);
      const auto [at, is_new] = vertex_of.try_emplace(std::minmax(a, b));
      if (is_new) {
        if (is_taken(a, b)) at->second = vertex_on(a, b);
        if (!at->second) cuts_.insert(std::minmax(a, b));
      }
      if (!at->second) continue;
      apex = around.size();
      around.push_back(*at->second);
    }
    const std::size_t n = around.size();
    for (std::size_t k = 1; k + 1 < n; ++k)
      result.push_back({around[apex], around[(apex + k) % n], around[(apex + k + 1) % n]});
  }
  return result;
}

bool PolygonCuts::is_of_others(VertexId a, VertexId b, FaceId f) const {
  const EdgeId edge = edges_.find(a, b);
  if (!edge.is_valid()) return false;
  const auto around = edges_.half_edges(edge);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t h) { return edges_.face_of(h) != f; });
}

bool PolygonCuts::is_taken(VertexId a, VertexId b) const {
  if (cuts_.contains(std::minmax(a, b))) return true;
  const EdgeId edge = edges_.find(a, b);
  if (!edge.is_valid()) return false;
  // Faces that have only two different corners will be dropped, so they do not count.
  const auto around = edges_.half_edges(edge);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t h) {
    const auto loop = surface_.face(edges_.face_of(h));
    return std::any_of(loop.begin(), loop.end(), [&](VertexId v) { return v != a && v != b; });
  });
}

bool PolygonCuts::is_free_place(const Vec3& p) const {
  return !std::binary_search(places_.begin(), places_.end(), p) && !new_places_.contains(p);
}

/// Makes a new vertex between two others. Output: empty if no free place was found among the vertices there.
std::optional<VertexId> PolygonCuts::vertex_on(VertexId a, VertexId b) {
  constexpr int kHalvings = 20;
  const auto [first, second] = std::minmax(a, b);
  const Vec3 p = surface_.positions[first], q = surface_.positions[second];
  for (int i = 1; i <= kHalvings; ++i) {
    const double fraction = std::ldexp(1.0, -i);
    const Vec3 place = (1 - fraction) * p + fraction * q;
    if (!is_free_place(place)) continue;
    new_places_.insert(place);
    surface_.local.push_back(surface_.to_local(place));
    surface_.vertex_source.push_back(surface_.vertex_source[first]);
    surface_.positions.change([&](std::vector<Vec3>& positions) { positions.push_back(place); });
    return VertexId(surface_.vertex_count() - 1);
  }
  return std::nullopt;
}

}  // namespace remesh
