#include "core/stages/assembly.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

#include "core/geometry/predicates.h"
#include "core/stages/delaunay_flips.h"

namespace remesh {
namespace {

/// An undirected edge by its surface vertices.
using Key = std::pair<VertexId, VertexId>;

Key key_of(VertexId a, VertexId b) { return {std::min(a, b), std::max(a, b)}; }

struct Use {
  Key key;
  bool is_inside;  ///< of its patch; boundary edges sort first
  PatchId patch;
  std::uint32_t half_edge;  ///< in the patch, before any flip

  friend bool operator<(const Use& a, const Use& b) {
    return std::tie(a.key, a.is_inside, a.patch) < std::tie(b.key, b.is_inside, b.patch);
  }
};

bool is_inside_edge(const Triangulation2d& mesh, std::uint32_t h) {
  return mesh.twin(h) != Triangulation2d::kNone && !mesh.is_constrained(h);
}

std::vector<Use> edge_uses(const std::vector<PatchMesh>& meshes, RunControl& control) {
  std::vector<Use> uses;
  for (std::uint32_t p = 0; p < meshes.size(); ++p) {
    if (p % 4096 == 0) control.check();
    const auto& [mesh, vertices] = std::tie(meshes[p].mesh, meshes[p].vertices);
    for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
      const std::uint32_t twin = mesh.twin(h);
      if (twin != Triangulation2d::kNone && twin < h) continue;
      uses.push_back({key_of(vertices[mesh.from(h)], vertices[mesh.to(h)]), is_inside_edge(mesh, h), PatchId(p), h});
    }
  }
  tbb::parallel_sort(uses.begin(), uses.end());
  return uses;
}

/// Flips the edge away and holds the new one, so that what follows is Delaunay around it.
bool flip_away(PatchMesh& patch, const Use& use, const std::vector<Use>& uses, RunControl& control) {
  const std::uint32_t h = use.half_edge;
  // Where an earlier flip has changed the edge, the next pass looks again.
  if (key_of(patch.vertices[patch.mesh.from(h)], patch.vertices[patch.mesh.to(h)]) != use.key) return true;
  const std::uint32_t g = patch.mesh.twin(h);
  const std::uint32_t a = patch.mesh.from(h), b = patch.mesh.to(h), c = patch.mesh.apex(h), d = patch.mesh.apex(g);
  const auto& uv = patch.uv;
  if (orient2d(uv[d], uv[b], uv[c]) <= 0 || orient2d(uv[c], uv[a], uv[d]) <= 0) return false;
  const Key flipped = key_of(patch.vertices[c], patch.vertices[d]);
  const auto found = std::lower_bound(uses.begin(), uses.end(), Use{flipped, false, PatchId(0), 0});
  if (found != uses.end() && found->key == flipped) return false;
  patch.mesh.flip(h);
  patch.mesh.constrain(h);
  patch.held.push_back({c, d});
  std::vector<std::uint32_t> around{Triangulation2d::next(h), Triangulation2d::previous(h), Triangulation2d::next(g),
                                    Triangulation2d::previous(g)};
  delaunay_flips(patch.uv, patch.mesh, around, control);
  return true;
}

}  // namespace

std::vector<PatchId> resolve_chords(std::vector<PatchMesh>& meshes, RunControl& control) {
  std::vector<PatchId> failed;
  // A flip may make edges that conflict anew; a patch that goes on doing so takes a step of the ladder.
  constexpr int kMostPasses = 4;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::vector<Use> uses = edge_uses(meshes, control);
    bool is_changed = false;
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (i % 4096 == 0) control.check();
      // Two equal edges inside one patch do not occur, so an equal predecessor is another patch's or a boundary.
      if (!uses[i].is_inside || uses[i].key != uses[i - 1].key) continue;
      is_changed = true;
      if (pass + 1 == kMostPasses || !flip_away(meshes[uses[i].patch.value], uses[i], uses, control))
        failed.push_back(uses[i].patch);
    }
    if (!is_changed || !failed.empty()) break;
  }
  std::sort(failed.begin(), failed.end());
  failed.erase(std::unique(failed.begin(), failed.end()), failed.end());
  return failed;
}

Assembled assembly(std::size_t surface_vertices, const std::vector<PatchMesh>& meshes, RunControl& control) {
  control.check();
  std::vector<VertexId> number(surface_vertices);
  std::size_t faces = 0;
  for (const PatchMesh& patch : meshes) {
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      number[patch.vertices[patch.mesh.from(h)].value] = VertexId(0);
    faces += patch.mesh.triangle_count();
  }
  Assembled out;
  for (std::uint32_t v = 0; v < surface_vertices; ++v)
    if (number[v].is_valid()) number[v] = out.vertex.push_back(VertexId(v));
  out.faces.reserve(faces);
  out.face_patch.reserve(faces);
  out.corner_uv.reserve(3 * faces);
  for (std::uint32_t p = 0; p < meshes.size(); ++p) {
    const PatchMesh& patch = meshes[p];
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
      Triangle triangle;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t i = patch.mesh.from(h + k);
        triangle[k] = number[patch.vertices[i].value];
        out.corner_uv.push_back(patch.uv[i]);
      }
      out.faces.push_back(triangle);
      out.face_patch.push_back(PatchId(p));
    }
  }
  return out;
}

}  // namespace remesh
