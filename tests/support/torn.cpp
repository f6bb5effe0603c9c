#include "tests/support/torn.h"

#include <map>
#include <random>
#include <set>
#include <vector>

namespace remesh::torn {
namespace {

Vec3 centre(const PolygonMesh& mesh, FaceId f) {
  Vec3 sum;
  for (const VertexId v : mesh.face(f)) sum += mesh.positions[v];
  return (1.0 / static_cast<double>(mesh.face(f).size())) * sum;
}

}  // namespace

IsSecond above_a_plane(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> any;
  const Vec3 normal{any(random), any(random), any(random)};
  return [normal](const Vec3& p) { return dot(p - Vec3{0.3, 0.4, 0.2}, normal) > 0; };
}

Displace noise(unsigned seed, double most) {
  return [random = std::mt19937(seed),
          offset = std::uniform_real_distribution<double>(-most, most)](const Vec3& p) mutable -> Vec3 {
    const double x = offset(random), y = offset(random), z = offset(random);
    return p + Vec3{x, y, z};
  };
}

PolygonMesh in_two(const PolygonMesh& mesh, const IsSecond& is_second, const Displace& displace) {
  std::set<VertexId> of_first;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (!is_second(centre(mesh, FaceId(f))))
      for (const VertexId v : mesh.face(FaceId(f))) of_first.insert(v);
  PolygonMesh result = mesh;
  std::map<VertexId, VertexId> copy;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!is_second(centre(mesh, FaceId(f)))) continue;
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
      const VertexId v = mesh.corners[c];
      if (!of_first.contains(v)) continue;
      const auto [at, is_new] = copy.try_emplace(v);
      if (is_new) at->second = result.positions.push_back(displace(mesh.positions[v]));
      result.corners[c] = at->second;
    }
  }
  return result;
}

std::uint64_t edges_between(const PolygonMesh& mesh, const IsSecond& is_second) {
  std::map<std::pair<VertexId, VertexId>, std::set<bool>> parts;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto loop = mesh.face(FaceId(f));
    for (std::size_t i = 0; i < loop.size(); ++i)
      parts[std::minmax(loop[i], loop[(i + 1) % loop.size()])].insert(is_second(centre(mesh, FaceId(f))));
  }
  std::uint64_t count = 0;
  for (const auto& [edge, of_edge] : parts) count += of_edge.size() == 2;
  return count;
}

PolygonMesh into_facets(const PolygonMesh& mesh, const Displace& displace) {
  PolygonMesh result = mesh;
  result.positions.clear();
  for (VertexId& v : result.corners) v = result.positions.push_back(displace(mesh.positions[v]));
  return result;
}

PolygonMesh only(const PolygonMesh& mesh, const std::function<bool(FaceId)>& is_wanted) {
  PolygonMesh result;
  std::map<VertexId, VertexId> number;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!is_wanted(FaceId(f))) continue;
    for (const VertexId v : mesh.face(FaceId(f))) {
      const auto [at, is_new] = number.try_emplace(v);
      if (is_new) at->second = result.positions.push_back(mesh.positions[v]);
      result.corners.push_back(at->second);
    }
    result.face_begin.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

}  // namespace remesh::torn
