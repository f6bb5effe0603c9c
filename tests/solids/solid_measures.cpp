#include "tests/solids/solid_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "tests/support/cgal_space.h"

namespace remesh {

Measures measures_of(const TriangleMesh& mesh) {
  Measures found;
  found.narrowest = std::numeric_limits<double>::infinity();
  long double volume = 0, area = 0, lengths = 0;
  std::set<VertexId> vertices;
  std::map<std::pair<VertexId, VertexId>, std::vector<FaceId>> edges;
  for (FaceId f(0); f.value < mesh.faces.size(); ++f.value) {
    const Triangle& t = mesh.faces[f];
    const Vec3 origin = mesh.positions[mesh.faces[FaceId(0)][0]];
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin, c = mesh.positions[t[2]] - origin;
    volume += dot(a, cross(b - a, c - a)) / 6;
    area += norm(cross(b - a, c - a)) / 2;
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    found.narrowest = std::min(found.narrowest, norm(cross(b - a, c - a)) / longest);
    for (std::size_t k = 0; k < 3; ++k) {
      edges[std::minmax(t[k], t[(k + 1) % 3])].push_back(f);
      vertices.insert(t[k]);
      found.largest = std::max(found.largest, largest_coordinate(mesh.positions[t[k]]));
    }
  }
  std::vector<std::uint32_t> parent(mesh.faces.size());
  for (std::uint32_t f = 0; f < parent.size(); ++f) parent[f] = f;
  const auto root = [&](std::uint32_t f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (const auto& [edge, faces] : edges) {
    lengths += norm(mesh.positions[edge.second] - mesh.positions[edge.first]);
    if (faces.size() == 2)
      parent[root(faces[0].value)] = root(faces[1].value);
    else
      ++(faces.size() == 4 ? found.four_faces : found.other_edges);
  }
  for (std::uint32_t f = 0; f < parent.size(); ++f) found.shells += root(f) == f ? 1 : 0;
  found.volume = static_cast<double>(volume);
  found.area = static_cast<double>(area);
  found.lengths = static_cast<double>(lengths);
  found.euler =
      static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.faces.size());
  return found;
}

std::size_t pairs_by_cgal(const TriangleMesh& mesh, std::size_t enough) {
  std::vector<std::pair<Box3, FaceId>> boxes;
  for (FaceId f(0); f.value < mesh.faces.size(); ++f.value) {
    Box3 box;
    for (const VertexId v : mesh.faces[f]) box.add(mesh.positions[v]);
    boxes.push_back({box, f});
  }
  std::sort(boxes.begin(), boxes.end(), [](const auto& a, const auto& b) { return a.first.min.x < b.first.min.x; });
  const CgalIntersection do_intersect(mesh.positions.items());
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = i + 1; j < boxes.size() && boxes[j].first.min.x <= boxes[i].first.max.x; ++j) {
      bool do_meet = true;
      for (int axis = 1; axis < 3; ++axis)
        do_meet = do_meet && boxes[i].first.min[axis] <= boxes[j].first.max[axis] &&
                  boxes[j].first.min[axis] <= boxes[i].first.max[axis];
      if (do_meet && do_intersect(mesh.faces[boxes[i].second], mesh.faces[boxes[j].second]) && ++count == enough)
        return count;
    }
  return count;
}

}  // namespace remesh
