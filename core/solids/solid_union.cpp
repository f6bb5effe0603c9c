#include "core/solids/solid_union.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_corners.h"

namespace remesh {
namespace {

/// A face at an edge, with its corner that is not on the edge.
struct AtEdge {
  std::uint32_t face;
  Vec3 apex;
  bool is_forward;  ///< it runs along the edge as the edge is seen

  /// The side that is met first, or last, by a walk counter-clockwise around the edge.
  std::uint32_t first_side() const { return 2 * face + (is_forward ? 1 : 0); }
  std::uint32_t last_side() const { return 2 * face + (is_forward ? 0 : 1); }
};

class CellSearch {
 public:
  CellSearch(const WeighedFaces& faces, RunControl& control)
      : faces_(faces),
        control_(control),
        begins_(triangle_begins(faces.faces.size(), control)),
        edges_(faces.positions.size(), begins_, corners_of(faces.faces), control),
        sides_(2 * faces.faces.size()),
        parts_(faces.faces.size()) {}

  Cells find() {
    join_sides();
    number_cells();
    walk();
    nest();
    return std::move(cells_);
  }

 private:
  const Vec3& at(VertexId v) const { return faces_.positions[v.value]; }
  AtEdge at_edge(std::uint32_t h, VertexId from) const {
    return {h / 3, at(edges_.from(edges_.previous(h))), edges_.from(h) == from};
  }

  /// Puts the faces around the edge from a to b into their order, counter-clockwise, beginning with the first one.
  void sort_around(const Vec3& a, const Vec3& b, std::vector<AtEdge>& around) const {
    const Vec3 first = around.front().apex;
    const auto quarter = [&](const AtEdge& f) {
      if (f.face == around.front().face) return 0;
      const int side = orient3d(a, b, first, f.apex);
      return side > 0 ? 1 : side == 0 ? 2 : 3;
    };
    std::vector<std::pair<int, AtEdge>> sorted;
    for (const AtEdge& f : around) sorted.push_back({quarter(f), f});
    std::stable_sort(sorted.begin() + 1, sorted.end(), [&](const auto& f, const auto& g) {
      if (f.first != g.first) return f.first < g.first;
      return f.first != 2 && orient3d(a, b, f.second.apex, g.second.apex) > 0;
    });
    for (std::size_t i = 0; i < around.size(); ++i) around[i] = sorted[i].second;
  }

  void join_sides() {
    constexpr std::size_t kEdgesPerBlock = 1 << 12;
    for_blocks(edges_.edge_count(), kEdgesPerBlock, control_, [&](std::size_t e, std::size_t end) {
      std::vector<AtEdge> around;
      for (; e < end; ++e) {
        const auto half_edges = edges_.half_edges(EdgeId(e));
        const VertexId a = edges_.from(half_edges.front()), b = edges_.to(half_edges.front());
        around.clear();
        for (const std::uint32_t h : half_edges) around.push_back(at_edge(h, a));
        if (around.size() > 2) sort_around(at(a), at(b), around);
        for (std::size_t i = 0; i < around.size(); ++i) {
          const AtEdge& next = around[(i + 1) % around.size()];
          sides_.join(around[i].last_side(), next.first_side());
          parts_.join(around[i].face, next.face);
        }
      }
    });
  }

  void number_cells() {
    std::vector<std::uint32_t> number(sides_size(), kNone);
    cells_.of_side.resize(sides_size());
    StopCheck check(control_);
    std::uint32_t count = 0;
    for (std::uint32_t s = 0; s < sides_size(); ++s) {
      check();
      std::uint32_t& of_root = number[sides_.find(s)];
      if (of_root == kNone) of_root = count++;
      cells_.of_side[s] = of_root;
    }
    cells_.winding.assign(count, 0);
  }
  std::size_t sides_size() const { return 2 * faces_.faces.size(); }

  /// Finds the winding numbers of the cells of each part, relative to one of its cells.
  void walk() {
    const std::size_t n = faces_.faces.size(), count = cells_.winding.size();
    const Grouping of_cell = group_by(
        2 * n, count, [&](std::uint32_t s) { return cells_.of_side[s]; }, control_);
    std::vector<std::uint8_t> is_seen(count, 0);
    std::vector<std::uint32_t> stack;
    StopCheck check(control_);
    for (std::uint32_t first = 0; first < count; ++first) {
      if (std::exchange(is_seen[first], 1) != 0) continue;
      stack.assign(1, first);
      while (!stack.empty()) {
        const std::uint32_t cell = stack.back();
        stack.pop_back();
        for (const std::uint32_t side : of_cell[cell]) {
          check();
          const std::int32_t weight = faces_.weights[side / 2];
          // Behind a face, the number is larger by its weight.
          const std::int32_t beyond = cells_.winding[cell] + (side % 2 == 0 ? weight : -weight);
          const std::uint32_t other = cells_.of_side[side ^ 1U];
          if (std::exchange(is_seen[other], 1) == 0) {
            cells_.winding[other] = beyond;
            stack.push_back(other);
          } else if (cells_.winding[other] != beyond) {
            cells_.are_consistent = false;
          }
        }
      }
    }
  }

  /// Makes the winding numbers absolute. Outside of a part it is that of all other parts.
  void nest() {
    const std::size_t n = faces_.faces.size();
    std::vector<std::uint32_t> part(n);
    std::vector<VertexId> smallest(n), own(n);  // of each part, by its root; the second one is of no other part
    std::vector<std::uint32_t> part_at(faces_.positions.size(), kNone);
    constexpr std::uint32_t kSeveral = kNone - 1;
    StopCheck check(control_);
    for (std::uint32_t f = 0; f < n; ++f) {
      check();
      part[f] = parts_.find(f);
      VertexId& least = smallest[part[f]];
      for (const VertexId v : faces_.faces[f]) {
        if (!least.is_valid() || at(v) < at(least)) least = v;
        std::uint32_t& of_vertex = part_at[v.value];
        of_vertex = of_vertex == kNone || of_vertex == part[f] ? part[f] : kSeveral;
      }
    }
    for (std::uint32_t f = 0; f < n; ++f)
      for (const VertexId v : faces_.faces[f])
        if (VertexId& found = own[part[f]]; part_at[v.value] == part[f] && (!found.is_valid() || at(v) < at(found)))
          found = v;
    const Grouping of_part = group_by(
        n, n, [&](std::uint32_t f) { return part[f]; }, control_);
    std::vector<std::uint32_t> roots;
    for (std::uint32_t f = 0; f < n; ++f)
      if (part[f] == f) roots.push_back(f);
    std::vector<std::int32_t> shift(n, 0);
    const RayWinding rays(faces_, control_);
    for_blocks(roots.size(), 16, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        const std::uint32_t root = roots[i];
        const std::uint32_t outer = cells_.of_side[outer_side(of_part[root], smallest[root])];
        std::int32_t around = 0;
        // A part may touch others in some of its vertices. Everywhere else, all of it lies in one cell of the others.
        const Triangle& t = faces_.faces[root];
        constexpr double kThird = 1.0 / 3;
        const Vec3 place =
            own[root].is_valid() ? at(own[root]) : kThird * at(t[0]) + kThird * at(t[1]) + kThird * at(t[2]);
        if (roots.size() > 1) around = rays.at(place, [&](std::uint32_t f) { return part[f] == root; });
        shift[root] = around - cells_.winding[outer];
      }
    });
    std::vector<std::uint8_t> is_shifted(cells_.winding.size(), 0);
    for (std::uint32_t s = 0; s < 2 * n; ++s)
      if (std::exchange(is_shifted[cells_.of_side[s]], 1) == 0) cells_.winding[cells_.of_side[s]] += shift[part[s / 2]];
    cells_.count = cells_.winding.size() - roots.size();
  }

  /// Returns a side of a face of the part that is seen from outside of the part. The vertex is the part's smallest one.
  std::uint32_t outer_side(std::span<const std::uint32_t> part, VertexId v) const {
    const auto xy = [&](const Vec3& p) { return Vec2{p.x, p.y}; };
    const Vec3& a = at(v);
    // Of the edges at the vertex, seen along z, the one that lies to the right of all others.
    VertexId to;
    for (const std::uint32_t f : part) {
      const Triangle& t = faces_.faces[f];
      if (std::find(t.begin(), t.end(), v) == t.end()) continue;
      for (const VertexId u : t)
        if (xy(at(u)) != xy(a) && (!to.is_valid() || orient2d(xy(a), xy(at(to)), xy(at(u))) < 0)) to = u;
    }
    // All faces at this edge are to the left of it. The first one, from the right and below, is seen from outside.
    const Vec3& b = at(to);
    const auto along = [&](const Vec3& p) { return Vec2{a.x != b.x ? p.x : p.y, p.z}; };
    const auto half_edges = edges_.half_edges(edges_.find(v, to));
    AtEdge first = at_edge(half_edges.front(), v);
    for (const std::uint32_t h : half_edges.subspan(1)) {
      const AtEdge next = at_edge(h, v);
      const int side = orient3d(a, b, next.apex, first.apex);
      if (side > 0 || (side == 0 && orient2d(along(a), along(b), along(next.apex)) < 0)) first = next;
    }
    return first.first_side();
  }

  const WeighedFaces& faces_;
  RunControl& control_;
  std::vector<std::uint32_t> begins_;
  const Adjacency edges_;
  UnionFind sides_, parts_;
  Cells cells_;
};

/// Returns by how much a face of each shell changes the winding number: 0 for open shells, and -1 for those that have
/// to be turned over.
std::vector<std::int32_t> weights_of_shells(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                            const Shells& shells, UnionFaces& found, RunControl& control) {
  std::vector<std::int32_t> of_shell(shells.all.size(), 0);
  bool is_any_inwards = false;
  for (std::size_t s = 0; s < of_shell.size(); ++s) {
    of_shell[s] = shells.all[s].is_closed ? 1 : 0;
    is_any_inwards = is_any_inwards || (shells.all[s].is_closed && shells.all[s].volume < 0);
  }
  if (!is_any_inwards) return of_shell;
  const std::vector<Vec3> scaled = scaled_for_predicates(positions, control);
  std::vector<std::int32_t> weights;
  std::vector<VertexId> smallest(of_shell.size());
  StopCheck check(control);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check();
    const std::uint32_t shell = shells.of_face[f];
    weights.push_back(of_shell[shell]);
    for (const VertexId v : faces[f])
      if (!smallest[shell].is_valid() || scaled[v.value] < scaled[smallest[shell].value]) smallest[shell] = v;
  }
  const RayWinding rays({scaled, faces, weights}, control);
  for (std::uint32_t s = 0; s < of_shell.size(); ++s) {
    check();
    if (of_shell[s] == 0 || !(shells.all[s].volume < 0)) continue;
    const std::int32_t around =
        rays.at(scaled[smallest[s].value], [&](std::uint32_t f) { return shells.of_face[f] == s; });
    if (around == 0) found.turned_shells.push_back(s);
  }
  for (const std::uint32_t s : found.turned_shells) of_shell[s] = -1;
  return of_shell;
}

}  // namespace

RayWinding::RayWinding(const WeighedFaces& faces, RunControl& control)
    : faces_(faces), tree_(faces.positions, faces.faces, control) {}

std::vector<std::uint32_t> RayWinding::faces_beside(const Vec3& p) const {
  std::vector<std::uint32_t> faces;
  Box3 ray;
  ray.add(p);
  ray.min.x = -HUGE_VAL;
  tree_.visit_meeting(ray, 0, [&](std::size_t slot) {
    faces.push_back(tree_.face(slot).value);
    return true;
  });
  return faces;
}

/// Returns what a face adds to the winding number of a point from which the ray runs against x.
std::int32_t RayWinding::crossing(std::uint32_t f, const Vec3& p) const {
  const Triangle& t = faces_.faces[f];
  const auto at = [&](std::size_t k) { return faces_.positions[t[k % 3].value]; };
  const auto yz = [](const Vec3& q) { return Vec2{q.y, q.z}; };
  int facing = 0;  // 1 if the face looks along x
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 a = yz(at(k)), b = yz(at(k + 1));
    int side = orient2d(a, b, yz(p));
    // The point is moved along y, and by less along z.
    if (side == 0) side = a.y > b.y ? 1 : a.y < b.y ? -1 : b.x > a.x ? 1 : b.x < a.x ? -1 : 0;
    if (side == 0 || (facing != 0 && side != facing)) return 0;
    facing = side;
  }
  return orient3d(at(0), at(1), at(2), p) * facing > 0 ? -facing * faces_.weights[f] : 0;
}

Cells find_cells(const WeighedFaces& faces, RunControl& control) { return CellSearch(faces, control).find(); }

std::size_t count_cells(const Arrangement& arranged, RunControl& control) {
  const std::vector<Vec3> scaled = scaled_for_predicates(arranged.positions, control);
  const std::vector<std::int32_t> weights(arranged.faces.size(), 0);
  return find_cells({scaled, arranged.faces, weights}, control).count;
}

UnionFaces find_union(const Arrangement& arranged, std::span<const Vec3> positions, std::span<const Triangle> faces,
                      const Shells& shells, RunControl& control) {
  UnionFaces found;
  const std::vector<std::int32_t> shell_weights = weights_of_shells(positions, faces, shells, found, control);
  const std::vector<Vec3> scaled = scaled_for_predicates(arranged.positions, control);
  const std::size_t n = arranged.faces.size();
  std::vector<std::int32_t> weights(n, 0);
  StopCheck check(control);
  for (std::size_t f = 0; f < n; ++f)
    for (const Cover& cover : arranged.covers_of(f)) {
      check();
      const std::int32_t weight = shell_weights[shells.of_face[cover.face.value]];
      weights[f] += cover.is_reversed ? -weight : weight;
    }
  const Cells cells = find_cells({scaled, arranged.faces, weights}, control);
  found.are_consistent = cells.are_consistent;
  found.cells = cells.count;
  found.stays.assign(n, 1);
  found.is_turned.assign(n, 0);
  const auto is_solid = [&](std::size_t side) { return cells.winding[cells.of_side[side]] >= 1; };
  bool is_any_solid = false;
  for (std::size_t side = 0; side < 2 * n; ++side) is_any_solid = is_any_solid || is_solid(side);
  if (!cells.are_consistent || !is_any_solid) return found;
  for (std::size_t f = 0; f < n; ++f) {
    check();
    const bool is_before = is_solid(2 * f), is_behind = is_solid(2 * f + 1);
    const auto covers = arranged.covers_of(f);
    const bool is_loose = std::any_of(covers.begin(), covers.end(), [&](const Cover& cover) {
      return shell_weights[shells.of_face[cover.face.value]] == 0;
    });
    found.stays[f] = is_before != is_behind || (is_loose && !is_before) ? 1 : 0;
    found.is_turned[f] = is_before && !is_behind ? 1 : 0;
    if (found.stays[f] == 0) ++found.dropped;
  }
  return found;
}

void keep_union(Arrangement& arranged, const UnionFaces& found, RunControl& control) {
  Arrangement kept;
  std::vector<VertexId> number(arranged.positions.size());
  StopCheck check(control);
  for (std::size_t f = 0; f < arranged.faces.size(); ++f)
    if (found.stays[f] != 0)
      for (const VertexId v : arranged.faces[f]) number[v.value] = VertexId(0);
  for (std::size_t v = 0; v < number.size(); ++v) {
    check();
    if (!number[v].is_valid()) continue;
    number[v] = VertexId(kept.positions.size());
    kept.positions.push_back(arranged.positions[v]);
    kept.vertex.push_back(arranged.vertex[v]);
  }
  for (std::size_t f = 0; f < arranged.faces.size(); ++f) {
    check();
    if (found.stays[f] == 0) continue;
    Triangle t = arranged.faces[f];
    for (VertexId& v : t) v = number[v.value];
    const bool is_turned = found.is_turned[f] != 0;
    if (is_turned) std::swap(t[1], t[2]);
    kept.faces.push_back(t);
    for (Cover cover : arranged.covers_of(f)) {
      cover.is_reversed = cover.is_reversed != is_turned;
      kept.covers.push_back(cover);
    }
    kept.cover_begin.push_back(static_cast<std::uint32_t>(kept.covers.size()));
  }
  arranged.positions = std::move(kept.positions);
  arranged.vertex = std::move(kept.vertex);
  arranged.faces = std::move(kept.faces);
  arranged.cover_begin = std::move(kept.cover_begin);
  arranged.covers = std::move(kept.covers);
  arranged.flaps.clear();
  arranged.flap_positions.clear();
}

}  // namespace remesh
