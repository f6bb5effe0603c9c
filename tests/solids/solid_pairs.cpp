// Unites random pairs of solids in general position, and holds volumes and Euler numbers against those of CGAL's
// corefinement with exact numbers. Prints how many rounds of joining points they took. `./dev solids pairs` runs it.

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "tests/solids/solid_rows.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

Mesh as_cgal(const PolygonMesh& mesh) {
  Mesh result;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3& p : mesh.positions) vertices.push_back(result.add_vertex({p.x, p.y, p.z}));
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
    std::vector<Mesh::Vertex_index> corners;
    for (const VertexId v : mesh.face(f)) corners.push_back(vertices[v.value]);
    result.add_face(corners);
  }
  return result;
}

/// The figures of a union that are compared.
struct Figures {
  double volume = 0, area = 0, largest = 0;
  long euler = 0;
};

Figures figures_of(const TriangleMesh& mesh) {
  Figures found;
  std::map<std::pair<VertexId, VertexId>, int> edges;
  std::vector<std::uint8_t> is_used(mesh.positions.size(), 0);
  for (FaceId f(0); f.value < mesh.faces.size(); ++f.value) {
    const Triangle& t = mesh.faces[f];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    found.volume += dot(a, cross(b, c)) / 6;
    found.area += norm(cross(b - a, c - a)) / 2;
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[std::minmax(t[k], t[(k + 1) % 3])];
      is_used[t[k].value] = 1;
      found.largest = std::max(found.largest, largest_coordinate(mesh.positions[t[k]]));
    }
  }
  found.euler = std::count(is_used.begin(), is_used.end(), 1) - static_cast<long>(edges.size()) +
                static_cast<long>(mesh.faces.size());
  return found;
}

PolygonMesh icosphere(int levels) {
  const double g = std::numbers::phi;
  PolygonMesh mesh =
      shapes::from_lists({{-1, g, 0},
                          {1, g, 0},
                          {-1, -g, 0},
                          {1, -g, 0},
                          {0, -1, g},
                          {0, 1, g},
                          {0, -1, -g},
                          {0, 1, -g},
                          {g, 0, -1},
                          {g, 0, 1},
                          {-g, 0, -1},
                          {-g, 0, 1}},
                         {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
  if (levels > 0) mesh = divided(mesh, 1 << levels);
  for (Vec3& p : mesh.positions) p = normalized(p);
  return mesh;
}

PolygonMesh tetrahedron() {
  return shapes::from_lists({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

PolygonMesh random_solid(Random& random) {
  const auto length = [&] { return random.uniform(0.5, 2); };
  PolygonMesh mesh;
  switch (random.below(4)) {
    case 0: mesh = shapes::box({length(), length(), length()}); break;
    case 1: mesh = shapes::fan_triangulated(shapes::cylinder(3 + random.below(6), length() / 2, length())); break;
    case 2: mesh = shapes::scaled(tetrahedron(), length() / 2); break;
    default: mesh = shapes::scaled(icosphere(random.below(3)), length() / 2); break;
  }
  const auto vector = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
  const Vec3 axis = vector();
  return shapes::moved(shapes::rotated(mesh, axis, random.uniform(0, 360)), 0.5 * vector());
}

/// Returns what is wrong with the union of a pair; empty if nothing is.
std::string fault_of(const PolygonMesh& a, const PolygonMesh& b, std::map<std::size_t, int>& rounds) {
  Options options = unrefined();
  options.repair.make_union = true;
  const Result result = remeshed(as_one({a, b}), options);
  const Figures ours = figures_of(result.mesh);
  const double moved = result.report.solids ? result.report.solids->moved : 0;
  ++rounds[result.report.solids ? result.report.solids->rounds : 0];
  if (result.report.solids && result.report.solids->left > 0) return "faces still intersect";
  for (const Diagnostic& told : result.report.diagnostics)
    if ((told.code == DiagnosticCode::kCutIntersections || told.code == DiagnosticCode::kDroppedPieces) &&
        told.count == 0)
      return told.message;

  Mesh first = as_cgal(a), second = as_cgal(b), united;
  if (!processing::corefine_and_compute_union(first, second, united)) return "CGAL has no union";
  const double volume = CGAL::to_double(processing::volume(united));
  const long euler = static_cast<long>(united.number_of_vertices()) - static_cast<long>(united.number_of_edges()) +
                     static_cast<long>(united.number_of_faces());
  constexpr double kPlaces = 8;
  const double within = ours.area * (kPlaces * std::ldexp(1.0, std::ilogb(ours.largest) - 52) + moved);
  char text[160];
  std::snprintf(text, sizeof text, "volume %.17g instead of %.17g (within %.2g), Euler number %ld instead of %ld",
                ours.volume, volume, within, ours.euler, euler);
  return std::fabs(ours.volume - volume) <= within && ours.euler == euler ? "" : text;
}

int run(int pairs, std::uint64_t seed) {
  std::map<std::size_t, int> rounds;
  int failures = 0;
  for (int i = 0; i < pairs; ++i) {
    Random random(seed + static_cast<std::uint64_t>(i));
    const PolygonMesh a = random_solid(random), b = random_solid(random);
    const std::string fault = fault_of(a, b, rounds);
    if (fault.empty()) continue;
    ++failures;
    std::printf("pair %d: %s\n", i, fault.c_str());
    std::fflush(stdout);
  }
  std::printf("%d of %d pairs failed; rounds:", failures, pairs);
  for (const auto& [count, times] : rounds) std::printf(" %zu: %d", count, times);
  std::printf("\n");
  // At most one pair in a hundred may take rounds, and none more than three.
  int later = 0;
  for (const auto& [count, times] : rounds) later += count > 0 ? times : 0;
  constexpr std::size_t kMaxRounds = 3;
  constexpr int kShare = 100;
  return failures == 0 && kShare * later <= pairs && (rounds.empty() || rounds.rbegin()->first <= kMaxRounds) ? 0 : 1;
}

}  // namespace
}  // namespace remesh

int main(int argc, char** argv) {
  constexpr int kPairs = 10000;
  constexpr std::uint64_t kSeed = 1;
  return remesh::run(argc > 1 ? std::atoi(argv[1]) : kPairs, argc > 2 ? std::strtoull(argv[2], nullptr, 10) : kSeed);
}
