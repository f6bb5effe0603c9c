#include "core/refinement/adjustment/separation.h"

#include <algorithm>

#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/triangulation/delaunay_flips.h"

namespace remesh {
namespace {

/// Counts, for every vertex, the earlier vertices at the same place.
std::vector<std::uint32_t> count_before(const Surface& surface, const PatchMeshes& meshes,
                                        const std::vector<Vec3>& new_positions, TwinsOf of, RunControl& control) {
  struct Place {
    Vec3 position;
    std::uint32_t vertex;
  };
  const std::size_t of_surface = surface.vertex_count(), count = of_surface + new_positions.size();
  StopCheck check(control);
  std::vector<std::uint8_t> is_used(count, of == TwinsOf::kSurface ? 1 : 0);
  for (const PatchMesh& patch : meshes)
    for (const VertexId v : patch.vertices) {
      check();
      is_used[v.value] = 1;
    }
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1)));
  for (std::size_t v = 0; v < count; ++v) {
    check();
    if (is_used[v] == 0) continue;
    const VertexId id(static_cast<std::uint32_t>(v));
    places.push_back({v < of_surface ? surface.positions[id] : new_positions[v - of_surface], id.value});
  }
  sort_stoppable(places.begin(), places.end(), control, [](const Place& a, const Place& b) {
    return a.position != b.position ? a.position < b.position : a.vertex < b.vertex;
  });
  std::vector<std::uint32_t> before(count, 0);
  for (std::size_t i = 1; i < places.size(); ++i) {
    check();
    if (places[i].position == places[i - 1].position) before[places[i].vertex] = before[places[i - 1].vertex] + 1;
  }
  return before;
}

/// Returns the corners of all triangles of a patch, by half-edge.
std::vector<std::uint32_t> corners_of(const Triangulation2d& mesh, RunControl& control) {
  StopCheck check(control);
  std::vector<std::uint32_t> corners(mesh.half_edge_count());
  for (std::uint32_t h = 0; h < corners.size(); ++h) {
    check();
    corners[h] = mesh.from(h);
  }
  return corners;
}

class Mover {
 public:
  Mover(PatchMesh& patch, RunControl& control) : patch_(patch), control_(control) {
    patch_.mesh.index_points(patch_.uv.size());
  }
  ~Mover() { patch_.mesh.drop_index(); }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

  /// Moves vertex v to `to` and makes the edges around it Delaunay. Returns false, with nothing changed, if there is no
  /// room for that.
  bool move(std::uint32_t v, Vec2 to) {
    const Triangulation2d& mesh = patch_.mesh;
    std::vector<std::uint32_t> around;
    const std::uint32_t first = mesh.edge_at(v);
    for (std::uint32_t h = first; around.empty() || h != first; h = mesh.twin(Triangulation2d::previous(h))) {
      if (orient2d(to, patch_.uv[mesh.to(h)], patch_.uv[mesh.apex(h)]) <= 0) return false;
      around.insert(around.end(), {h, Triangulation2d::next(h)});
    }
    patch_.uv[v] = to;
    delaunay_flips(patch_.uv, patch_.mesh, around, control_);
    return true;
  }

 private:
  PatchMesh& patch_;
  RunControl& control_;
};

/// Moves each vertex once that has the place of earlier vertices. The length of the move grows with their number.
/// Output: whether any was moved; `is_moved` has one entry per vertex then.
bool separate_once(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement, TwinsOf of,
                   std::vector<std::uint8_t>& is_moved, RunControl& control) {
  PatchMeshes& meshes = triangulated.meshes;
  const std::vector<std::uint32_t> before = count_before(surface, meshes, refinement.new_positions, of, control);
  const std::size_t first_inner = surface.vertex_count() + refinement.first_inner;
  bool is_any = false;
  std::size_t first_triangle = 0;
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    if (p % 1024 == 0) control.check_and_move();
    PatchMesh& patch = meshes[PatchId(p)];
    const std::size_t first = first_triangle;
    first_triangle += patch.mesh.triangle_count();
    const auto is_twin = [&](VertexId v) { return v.value >= first_inner && before[v.value] > 0; };
    if (std::none_of(patch.vertices.begin(), patch.vertices.end(), is_twin)) continue;
    const std::vector<std::uint32_t> corners = corners_of(patch.mesh, control);
    Mover mover(patch, control);
    const PatchChart chart = triangulated.charts[PatchId(p)];
    for (std::uint32_t v = 0; v < patch.vertices.size(); ++v) {
      const VertexId id = patch.vertices[v];
      if (!is_twin(id)) continue;
      Vec3& position = refinement.new_positions[id.value - surface.vertex_count()];
      const Vec2 from = patch.uv[v];
      const Vec2 to = from + Vec2{before[id.value] * chart.visible_step(from, position), 0};
      if (!mover.move(v, to)) continue;
      position = position + (chart.to_space(to) - chart.to_space(from));
      is_moved.resize(before.size(), 0);
      is_moved[id.value] = 1;
      is_any = true;
    }
    StopCheck check(control);
    for (std::uint32_t h = 0; h < corners.size() && first + h / 3 < refinement.reason.size(); ++h) {
      check();
      if (patch.mesh.from(h) != corners[h]) refinement.reason[first + h / 3] = UnrefinedReason::kEffort;
    }
  }
  return is_any;
}

}  // namespace

std::vector<std::uint8_t> separate_new_vertices(const Surface& surface, TriangulatedPatches& triangulated,
                                                Refinement& refinement, TwinsOf of, RunControl& control) {
  // A moved vertex may get the place of a third vertex.
  constexpr int kMaxPasses = 16;
  std::vector<std::uint8_t> is_moved;
  if (refinement.first_inner == refinement.new_positions.size()) return is_moved;
  for (int pass = 0; pass < kMaxPasses; ++pass)
    if (!separate_once(surface, triangulated, refinement, of, is_moved, control)) break;
  return is_moved;
}

}  // namespace remesh
