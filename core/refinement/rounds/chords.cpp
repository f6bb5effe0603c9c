#include "core/refinement/rounds/chords.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/triangulation/delaunay_flips.h"

namespace remesh {
namespace {

/// An undirected edge is named by its two surface vertices. The smaller one is first.
struct Key {
  VertexId first, second;
  friend auto operator<=>(const Key&, const Key&) = default;
};

Key key_of(const PatchMesh& patch, std::uint32_t a, std::uint32_t b) {
  const auto& [low, high] = std::minmax(patch.vertices[a], patch.vertices[b]);
  return {low, high};
}
Key key_of(const PatchMesh& patch, std::uint32_t half_edge) {
  return key_of(patch, patch.mesh.from(half_edge), patch.mesh.to(half_edge));
}

struct ChordUse {
  Key key;
  /// True if the edge is inside its patch. Boundary edges sort first.
  bool is_inside;
  PatchId patch;
  std::uint32_t half_edge;  ///< number in the patch's mesh; valid until that mesh changes

  friend bool operator<(const ChordUse& a, const ChordUse& b) {
    return std::tie(a.key, a.is_inside, a.patch) < std::tie(b.key, b.is_inside, b.patch);
  }
};

using ChordUses = std::vector<ChordUse, DefaultInit<ChordUse>>;

/// Returns the edges whose two ends are vertices below `vertex_end` and for which `is_wanted` is true. Each occurs once
/// per patch. They are sorted.
template <class IsWanted>
ChordUses edge_uses(const PatchMeshes& meshes, std::size_t vertex_end, RunControl& control, const IsWanted& is_wanted) {
  const auto blocks =
      map_blocks<std::vector<ChordUse>>(meshes.size(), 64, control, [&](std::size_t p, std::size_t end) {
        std::vector<ChordUse> uses;
        for (; p < end; ++p) {
          const PatchMesh& patch = meshes[PatchId(p)];
          for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
            const std::uint32_t twin = patch.mesh.twin(h);
            if (twin != Triangulation2d::kNoHalfEdge && twin < h) continue;
            const Key key = key_of(patch, h);
            if (!key.second.is_valid() || key.second.value >= vertex_end) continue;
            const bool is_inside =
                twin != Triangulation2d::kNoHalfEdge && (!patch.mesh.is_constrained(h) || patch.is_reserved(h));
            if (is_wanted(key, is_inside)) uses.push_back({key, is_inside, PatchId(p), h});
          }
        }
        return uses;
      });
  return sorted_by_key(
      concatenate<ChordUse>(blocks, control), vertex_end, [](const ChordUse& use) { return use.key.first.value; },
      control);
}

ChordUses edge_uses(const PatchMeshes& meshes, std::size_t vertex_end, RunControl& control) {
  return edge_uses(meshes, vertex_end, control, [](const Key&, bool) { return true; });
}

std::vector<Chord> chords_of(const ChordUses& uses, RunControl& control) {
  std::vector<Chord> chords;
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (i % 4096 == 0) control.check_and_move();
    // One patch never has two equal edges inside it. So an equal predecessor belongs to another patch or to a boundary.
    if (uses[i].is_inside && uses[i].key == uses[i - 1].key) chords.push_back({uses[i].patch, uses[i].half_edge});
  }
  return chords;
}

bool is_used(const ChordUses& uses, const Key& key) {
  const auto found = std::lower_bound(uses.begin(), uses.end(), ChordUse{key, false, PatchId(0), 0});
  return found != uses.end() && found->key == key;
}

/// Flips the edge away and constrains the new one, so that the flips which make the triangles around it Delaunay keep
/// it. Returns false, with nothing changed, if the edge cannot be flipped or the new edge is in use already.
bool flip_away(PatchMesh& patch, std::uint32_t h, const ChordUses& uses, RunControl& control) {
  if (patch.mesh.is_constrained(h)) return false;
  const std::uint32_t g = patch.mesh.twin(h);
  const std::uint32_t a = patch.mesh.from(h), b = patch.mesh.to(h), c = patch.mesh.apex(h), d = patch.mesh.apex(g);
  const auto& uv = patch.uv;
  if (orient2d(uv[d], uv[b], uv[c]) <= 0 || orient2d(uv[c], uv[a], uv[d]) <= 0) return false;
  if (is_used(uses, key_of(patch, c, d))) return false;
  patch.mesh.flip(h);
  patch.mesh.constrain(h);
  patch.reserved.insert(c, d);
  std::vector<std::uint32_t> around{Triangulation2d::next(h), Triangulation2d::previous(h), Triangulation2d::next(g),
                                    Triangulation2d::previous(g)};
  delaunay_flips(patch.uv, patch.mesh, around, control);
  return true;
}

/// Puts a vertex into the middle of the edge. Returns false, with nothing changed, if the edge has no room for a
/// vertex.
bool split(PatchMesh& patch, const PatchChart& chart, std::uint32_t h, RunControl& control) {
  Triangulation2d& mesh = patch.mesh;
  const std::uint32_t g = mesh.twin(h);
  const std::uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.apex(h), d = mesh.apex(g);
  const auto& uv = patch.uv;
  const Vec2 middle = chart.on_grid(0.5 * (uv[a] + uv[b]));
  for (const auto& [from, to] : {std::pair(b, c), {c, a}, {a, d}, {d, b}})
    if (orient2d(uv[from], uv[to], middle) <= 0) return false;
  const auto m = static_cast<std::uint32_t>(patch.uv.size());
  patch.uv.push_back(middle);
  patch.vertices.emplace_back();
  // (a, b, c) and (b, a, d) become (a, m, c), (m, b, c), (b, m, d) and (m, a, d).
  const auto next = [](std::uint32_t e) { return Triangulation2d::next(e); };
  const std::uint32_t bc = mesh.twin(next(h)), ad = mesh.twin(next(g));
  const bool is_bc_constrained = mesh.is_constrained(next(h)), is_ad_constrained = mesh.is_constrained(next(g));
  mesh.set_triangle(h, a, m, c);
  mesh.set_triangle(g, b, m, d);
  const std::uint32_t mb = mesh.add_triangle(m, b, c), ma = mesh.add_triangle(m, a, d);
  mesh.join(h, ma);
  mesh.join(g, mb);
  mesh.join(next(h), mb + 2);
  mesh.join(next(g), ma + 2);
  mesh.join(mb + 1, bc, is_bc_constrained);
  mesh.join(ma + 1, ad, is_ad_constrained);
  std::vector<std::uint32_t> around{mb + 1, ma + 1, Triangulation2d::previous(h), Triangulation2d::previous(g)};
  delaunay_flips(patch.uv, mesh, around, control);
  return true;
}

/// Removes the constraint from edges inside the patch for which `is_wanted` is false, and makes the triangles around
/// them Delaunay. Returns whether there was such an edge.
template <class IsWanted>
bool release_reserved(PatchMesh& patch, const IsWanted& is_wanted, RunControl& control) {
  if (patch.reserved.empty()) return false;
  std::vector<std::uint32_t> released;
  for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
    const std::uint32_t twin = patch.mesh.twin(h);
    if (twin == Triangulation2d::kNoHalfEdge || !patch.mesh.is_constrained(h) || !patch.is_reserved(h) || is_wanted(h))
      continue;
    patch.mesh.join(h, twin);
    patch.reserved.erase(patch.mesh.from(h), patch.mesh.to(h));
    released.push_back(h);
  }
  const bool is_any = !released.empty();
  delaunay_flips(patch.uv, patch.mesh, released, control);
  return is_any;
}

/// Calls `treat` for each chord in turn. A chord is skipped if flips for an earlier chord have changed its half-edge;
/// the next pass treats it again. `treat` returns whether it succeeded; if not, it has changed nothing. The result is
/// true if any call succeeded.
template <class Treat>
bool for_chords(PatchMeshes& meshes, const std::vector<Chord>& chords, RunControl& control, const Treat& treat) {
  std::vector<Key> keys;
  keys.reserve(chords.size());
  StopCheck check(control);
  for (const Chord& chord : chords) {
    check();
    keys.push_back(key_of(meshes[chord.patch], chord.half_edge));
  }
  bool is_any = false;
  for (std::size_t i = 0; i < chords.size(); ++i) {
    check();
    const PatchMesh& patch = meshes[chords[i].patch];
    if (key_of(patch, chords[i].half_edge) == keys[i]) is_any = treat(chords[i].patch, chords[i].half_edge) || is_any;
  }
  return is_any;
}

}  // namespace

std::vector<Chord> find_chords(const PatchMeshes& meshes, std::size_t vertex_end, RunControl& control) {
  if (meshes.size() < 2) return {};
  // Only few edges inside patches join two vertices below `vertex_end`, and a boundary edge equals one of these only if
  // it has the same two ends. So boundary edges are collected only between the ends of these few edges.
  ChordUses uses = edge_uses(meshes, vertex_end, control, [](const Key&, bool is_inside) { return is_inside; });
  if (uses.empty()) return {};
  std::vector<std::uint8_t> is_end(vertex_end, 0);
  StopCheck check(control);
  for (const ChordUse& use : uses) {
    check();
    is_end[use.key.first.value] = is_end[use.key.second.value] = 1;
  }
  const ChordUses boundary = edge_uses(meshes, vertex_end, control, [&](const Key& key, bool is_inside) {
    return !is_inside && is_end[key.first.value] != 0 && is_end[key.second.value] != 0;
  });
  // Copying one list to the end of the other in one piece would take long, and the copy could not be cancelled.
  ChordUses all;
  all.reserve(uses.size() + boundary.size());
  std::merge(uses.begin(), uses.end(), boundary.begin(), boundary.end(), std::back_inserter(all),
             [&](const ChordUse& a, const ChordUse& b) {
               check();
               return a < b;
             });
  return chords_of(all, control);
}

FlippedChords flip_chords(PatchMeshes& meshes, std::size_t vertex_end, RunControl& control) {
  if (std::all_of(meshes.begin(), meshes.end(), [](const PatchMesh& patch) { return patch.reserved.empty(); }) &&
      find_chords(meshes, vertex_end, control).empty())
    return {};
  // A flip may make new chords. It may also remove an edge because of which another edge was constrained. Such changes
  // may go on forever, so the number of passes is limited.
  constexpr int kMaxPasses = 8;
  for (int pass = 0;; ++pass) {
    const ChordUses uses = edge_uses(meshes, vertex_end, control);
    bool is_settled = true;
    StopCheck check(control);
    for (PatchMesh& patch : meshes) {
      check();
      const auto is_wanted = [&](std::uint32_t h) {
        return is_used(uses, key_of(patch, patch.mesh.apex(h), patch.mesh.apex(patch.mesh.twin(h))));
      };
      is_settled = !release_reserved(patch, is_wanted, control) && is_settled;
    }
    const std::vector<Chord> chords = chords_of(uses, control);
    if (is_settled && chords.empty()) return {true, false};
    if (pass == kMaxPasses) return {true, true};
    if (!is_settled) continue;
    const auto flip_one = [&](PatchId p, std::uint32_t h) { return flip_away(meshes[p], h, uses, control); };
    if (!for_chords(meshes, chords, control, flip_one)) return {true, true};
  }
}

void split_chords(TriangulatedPatches& triangulated, std::size_t vertex_end,
                  const std::function<void(PatchId)>& before_change, RunControl& control) {
  PatchMeshes& meshes = triangulated.meshes;
  std::vector<Chord> chords = find_chords(meshes, vertex_end, control);
  if (chords.empty()) return;
  // Edges that were constrained for the sake of chords are released first. If their chord is split now, these edges
  // need not stay, and they may not be Delaunay.
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const PatchId p(i);
    if (meshes[p].reserved.empty()) continue;
    before_change(p);
    release_reserved(
        meshes[p], [](std::uint32_t) { return false; }, control);
  }
  // Each pass leaves fewer chords, because all new edges end at a new vertex.
  const auto split_one = [&](PatchId p, std::uint32_t h) {
    before_change(p);
    return split(meshes[p], triangulated.charts[p], h, control);
  };
  do {
    chords = find_chords(meshes, vertex_end, control);
  } while (for_chords(meshes, chords, control, split_one));
}

}  // namespace remesh
