#include "core/refinement/separation.h"

#include <algorithm>
#include <cstdint>

#include "core/base/stoppable.h"
#include "core/geometry/predicates.h"
#include "core/triangulation/delaunay_flips.h"

namespace remesh {
namespace {

/// For every vertex, counts the vertices before it that are in the same place.
std::vector<std::uint32_t> count_before(const Surface& surface, const std::vector<Vec3>& new_positions,
                                        RunControl& control) {
  struct Place {
    Vec3 position;
    std::uint32_t vertex;
  };
  std::vector<Place> places;
  places.reserve(surface.vertex_count() + new_positions.size());
  StopCheck check(control);
  const auto add = [&](const Vec3& p) {
    check();
    places.push_back({p, static_cast<std::uint32_t>(places.size())});
  };
  for (const Vec3& p : surface.positions) add(p);
  for (const Vec3& p : new_positions) add(p);
  sort_stoppable(places.begin(), places.end(), control, [](const Place& a, const Place& b) {
    return a.position != b.position ? a.position < b.position : a.vertex < b.vertex;
  });
  std::vector<std::uint32_t> before(places.size(), 0);
  for (std::size_t i = 1; i < places.size(); ++i) {
    check();
    if (places[i].position == places[i - 1].position) before[places[i].vertex] = before[places[i - 1].vertex] + 1;
  }
  return before;
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

}  // namespace

bool separate_new_vertices(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement,
                           RunControl& control) {
  const std::vector<std::uint32_t> before = count_before(surface, refinement.new_positions, control);
  const std::size_t first_inner = surface.vertex_count() + refinement.first_inner;
  PatchMeshes& meshes = triangulated.meshes;
  bool is_any = false;
  for (std::size_t p = 0; p < meshes.size(); ++p) {
    if (p % 1024 == 0) control.check_and_move();
    PatchMesh& patch = meshes[PatchId(p)];
    const auto is_twin = [&](VertexId v) { return v.value >= first_inner && before[v.value] > 0; };
    if (std::none_of(patch.vertices.begin(), patch.vertices.end(), is_twin)) continue;
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
      is_any = true;
    }
  }
  return is_any;
}

}  // namespace remesh
