#include "core/triangulation/delaunay_mesh.h"

#include <algorithm>
#include <cassert>

#include "core/base/small_blocks.h"
#include "core/geometry/exact/predicates.h"

namespace remesh {

DelaunayMesh::DelaunayMesh(Scratch& scratch, std::pmr::memory_resource* memory)
    : scratch_(&scratch),
      points_(memory),
      edge_at_(memory),
      corner_(memory),
      twin_(memory),
      half_edge_of_side_(memory),
      free_vertices_(memory),
      free_triangles_(memory) {}

DelaunayMesh::DelaunayMesh(const Triangulation2d& mesh, std::span<const Vec2> points,
                           std::span<const std::uint32_t> sides, Scratch& scratch,
                           std::span<const std::uint32_t> number, std::pmr::memory_resource* memory)
    : DelaunayMesh(scratch, memory) {
  // Most meshes that grow at all become about twice as large. Reserving that much memory at once saves copies.
  const std::uint32_t n = mesh.half_edge_count();
  points_.reserve(2 * points.size());
  edge_at_.reserve(2 * points.size());
  corner_.reserve(2 * std::size_t{n});
  twin_.reserve(2 * std::size_t{n});
  half_edge_of_side_.reserve(2 * sides.size());
  points_.assign(points.begin(), points.end());
  edge_at_.assign(points.size(), kNone);
  live_triangles_ = mesh.triangle_count();
  corner_.resize(n);
  twin_.resize(n);
  for (std::uint32_t h = 0; h < n; ++h) {
    corner_[h] = number.empty() ? mesh.from(h) : number[mesh.from(h)];
    twin_[h] = mesh.twin(h);
    edge_at_[corner_[h]] = h;
  }
  half_edge_of_side_.assign(sides.begin(), sides.end());
  for (std::uint32_t s = 0; s < sides.size(); ++s) twin_[sides[s]] = kConstraint | s;
  // A constraint of `mesh` that is not among `sides` is released, and its edge may not be Delaunay.
  scratch.stack.clear();
  for (std::uint32_t h = 0; h < n; ++h)
    if (mesh.is_constrained(h) && !is_constrained(h)) scratch_->stack.push_back(h);
  restore_delaunay();
  scratch_->changed.clear();
}

DelaunayMesh::Location DelaunayMesh::locate(std::uint32_t triangle, Vec2 p) const {
  const std::uint32_t t = 3 * triangle;
  const Vec2 start = (1.0 / 3.0) * (points_[corner_[t]] + points_[corner_[t + 1]] + points_[corner_[t + 2]]);
  // Returns the side of the line from the start to p on which a vertex lies: 1 is left, -1 is right.
  const auto side_of_way = [&](std::uint32_t v) { return orient2d(start, p, points_[v]); };
  const auto is_beyond = [&](std::uint32_t h) { return orient2d(points_[from(h)], points_[to(h)], p) < 0; };
  std::uint32_t h = t;
  for (std::uint32_t k = 0; k < 3; ++k)
    if (is_beyond(t + k)) {
      h = t + k;
      // The walk leaves through this edge if the edge's start is on its right and the edge's end on its left.
      if (side_of_way(from(h)) <= 0 && side_of_way(to(h)) >= 0) break;
    }
  std::uint64_t walked = 0;
  bool is_hidden = false;
  for (; is_beyond(h); ++walked) {
    is_hidden = is_constrained(h);
    if (is_hidden) break;
    const std::uint32_t g = twin_[h];
    h = side_of_way(apex(g)) > 0 ? next(g) : previous(g);
  }
  scratch_->visited += walked;
  return {h, is_hidden};
}

void DelaunayMesh::collect_cavity(Vec2 p, std::uint32_t triangle, std::uint32_t left_out) {
  scratch_->cavity.assign(1, triangle);
  scratch_->rim.clear();
  scratch_->front.clear();
  // The edges are entered counter-clockwise around the triangle. They begin at `left_out`, which is no part of the rim,
  // or at the first edge if there is none.
  const std::uint32_t first = left_out != kNone ? left_out : 3 * triangle;
  const auto reach = [&](std::uint32_t h, std::uint32_t from, std::uint32_t to) {
    scratch_->front.push_back({from, to, twin_[h]});
  };
  const std::uint32_t a = from(first), b = to(first), c = apex(first);
  reach(previous(first), c, a);
  reach(next(first), b, c);
  if (left_out == kNone) reach(first, a, b);
  while (!scratch_->front.empty()) {
    const RimEdge edge = scratch_->front.back();
    scratch_->front.pop_back();
    if (!is_constrained(edge)) {
      const std::uint32_t previous_outside = previous(edge.outside), beyond = corner_[previous_outside];
      if (in_circle_perturbed(points_[edge.to], points_[edge.from], points_[beyond], p) > 0) {
        scratch_->cavity.push_back(edge.outside / 3);
        reach(previous_outside, beyond, edge.to);
        reach(next(edge.outside), edge.from, beyond);
        continue;
      }
    }
    scratch_->rim.push_back(edge);
  }
  scratch_->visited += scratch_->cavity.size();
}

DelaunayMesh::Cavity DelaunayMesh::find_cavity(Vec2 p, std::uint32_t triangle) {
  collect_cavity(p, triangle, kNone);
  const bool has_room = std::all_of(scratch_->rim.begin(), scratch_->rim.end(),
                                    [&](const RimEdge& e) { return orient2d(points_[e.from], points_[e.to], p) > 0; });
  return {p, scratch_->cavity, scratch_->rim, has_room};
}

std::uint32_t DelaunayMesh::new_vertex(Vec2 p) {
  if (free_vertices_.empty()) {
    points_.push_back(p);
    edge_at_.push_back(kNone);
    return vertex_slots() - 1;
  }
  const std::uint32_t v = free_vertices_.back();
  free_vertices_.pop_back();
  points_[v] = p;
  return v;
}

std::uint32_t DelaunayMesh::new_triangle() {
  ++live_triangles_;
  if (free_triangles_.empty()) {
    corner_.insert(corner_.end(), 3, kNone);
    twin_.insert(twin_.end(), 3, kNone);
    return triangle_slots() - 1;
  }
  const std::uint32_t t = free_triangles_.back();
  free_triangles_.pop_back();
  return t;
}

void DelaunayMesh::drop_triangle(std::uint32_t t) {
  --live_triangles_;
  corner_[3 * t] = corner_[3 * t + 1] = corner_[3 * t + 2] = kNone;
  free_triangles_.push_back(t);
}

void DelaunayMesh::set_triangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const std::uint32_t h = 3 * t;
  corner_[h] = a;
  corner_[h + 1] = b;
  corner_[h + 2] = c;
  edge_at_[a] = h;
  edge_at_[b] = h + 1;
  edge_at_[c] = h + 2;
  scratch_->changed.push_back(t);
}

void DelaunayMesh::attach(std::uint32_t h, std::uint32_t outside) {
  twin_[h] = outside;
  if ((outside & kConstraint) != 0)
    half_edge_of_side_[outside & ~kConstraint] = h;
  else
    twin_[outside] = h;
}

DelaunayMesh::Fan DelaunayMesh::make_fan(std::uint32_t v) {
  scratch_->changed.clear();
  Fan fan{kNone, kNone};
  for (std::size_t i = 0; i < scratch_->rim.size(); ++i) {
    const std::uint32_t t = i < scratch_->cavity.size() ? scratch_->cavity[i] : new_triangle();
    set_triangle(t, scratch_->rim[i].from, scratch_->rim[i].to, v);
    attach(3 * t, scratch_->rim[i].outside);
    if (i == 0)
      fan.first = 3 * t + 2;
    else
      join(fan.last, 3 * t + 2);
    fan.last = 3 * t + 1;
  }
  return fan;
}

std::uint32_t DelaunayMesh::fill_cavity(const Cavity& cavity) {
  assert(cavity.has_room && cavity.rim.data() == scratch_->rim.data() && cavity.rim.size() == scratch_->rim.size());
  const std::uint32_t v = new_vertex(cavity.point);
  const Fan fan = make_fan(v);
  join(fan.first, fan.last);
  return v;
}

std::uint32_t DelaunayMesh::cut(std::uint32_t side, Vec2 p, std::uint32_t vertex) {
  const std::uint32_t h = half_edge_of_side_[side];
  collect_cavity(p, h / 3, h);
  const auto is_in_front = [&](const RimEdge& e) { return orient2d(points_[e.from], points_[e.to], p) > 0; };
  if (!std::all_of(scratch_->rim.begin(), scratch_->rim.end(), is_in_front)) return kNone;
  const std::uint32_t v = vertex != kNone ? vertex : new_vertex(p);
  const Fan fan = make_fan(v);
  // The rim runs from the end of the cut edge round to its start.
  const auto other = side_count();
  half_edge_of_side_.push_back(fan.first);
  twin_[fan.first] = kConstraint | other;
  half_edge_of_side_[side] = fan.last;
  twin_[fan.last] = kConstraint | side;
  return v;
}

void DelaunayMesh::remove(std::uint32_t v) {
  scratch_->changed.clear();
  // Collect the ring around v, counter-clockwise, as the half-edges opposite to v. The triangles at v are removed.
  scratch_->rim.clear();
  const std::uint32_t first = edge_at_[v];
  std::uint32_t h = first;
  do {
    scratch_->rim.push_back({to(h), apex(h), twin_[next(h)]});
    drop_triangle(h / 3);
    h = twin_[previous(h)];
  } while (h != first);
  edge_at_[v] = kNone;
  free_vertices_.push_back(v);

  // Go around the ring and cut off ears until it is filled. The ring stays star-shaped around v, so it always has an
  // ear. A convex corner is an ear if v is not beyond its diagonal.
  const Vec2 centre = points_[v];
  std::vector<std::uint32_t>& following = scratch_->ring;
  const auto n = static_cast<std::uint32_t>(scratch_->rim.size());
  following.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) following[i] = (i + 1) % n;
  scratch_->stack.clear();
  std::uint32_t i = 0;
  for (std::uint32_t left = n; left > 3;) {
    // Edge i runs from a to b and edge j from b to c. The ear is the triangle abc.
    const std::uint32_t j = following[i];
    const std::uint32_t a = scratch_->rim[i].from, b = scratch_->rim[i].to, c = scratch_->rim[j].to;
    if (orient2d(points_[a], points_[b], points_[c]) > 0 && orient2d(points_[a], points_[c], centre) >= 0) {
      const std::uint32_t t = new_triangle();
      set_triangle(t, a, b, c);
      attach(3 * t, scratch_->rim[i].outside);
      attach(3 * t + 1, scratch_->rim[j].outside);
      scratch_->rim[i] = {a, c, 3 * t + 2};
      following[i] = following[j];
      scratch_->stack.push_back(3 * t);
      scratch_->stack.push_back(3 * t + 1);
      scratch_->stack.push_back(3 * t + 2);
      --left;
    }
    i = following[i];
  }
  const std::uint32_t j = following[i], k = following[j];
  const std::uint32_t t = new_triangle();
  set_triangle(t, scratch_->rim[i].from, scratch_->rim[j].from, scratch_->rim[k].from);
  attach(3 * t, scratch_->rim[i].outside);
  attach(3 * t + 1, scratch_->rim[j].outside);
  attach(3 * t + 2, scratch_->rim[k].outside);
  for (std::uint32_t e = 0; e < 3; ++e) scratch_->stack.push_back(3 * t + e);
  restore_delaunay();
}

void DelaunayMesh::flip(std::uint32_t h) {
  // h runs from a to b and has apex c; g runs from b to a and has apex d.
  const std::uint32_t g = twin_[h];
  const std::uint32_t a = from(h), b = to(h), c = apex(h), d = apex(g);
  const std::uint32_t bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
  const std::uint32_t t = h / 3, u = g / 3;
  set_triangle(t, c, a, d);
  set_triangle(u, d, b, c);
  attach(3 * t, ca);
  attach(3 * t + 1, ad);
  attach(3 * u, db);
  attach(3 * u + 1, bc);
  join(3 * t + 2, 3 * u + 2);
  for (const std::uint32_t e : {3 * t, 3 * t + 1, 3 * u, 3 * u + 1}) scratch_->stack.push_back(e);
}

void DelaunayMesh::restore_delaunay() {
  while (!scratch_->stack.empty()) {
    const std::uint32_t h = scratch_->stack.back();
    scratch_->stack.pop_back();
    if (is_constrained(h)) continue;
    if (in_circle_perturbed(points_[from(h)], points_[to(h)], points_[apex(h)], points_[apex(twin_[h])]) > 0) flip(h);
  }
}

void DelaunayMesh::number(std::pmr::vector<std::uint32_t>& vertex, std::pmr::vector<std::uint32_t>& triangle) const {
  vertex.clear();
  triangle.clear();
  triangle.reserve(live_triangles_);
  for (std::uint32_t t = 0; t < triangle_slots(); ++t)
    if (is_live(t)) triangle.push_back(t);
  vertex.reserve(points_.size());
  for (std::uint32_t v = 0; v < points_.size(); ++v)
    if (is_live_vertex(v)) vertex.push_back(v);
}

Triangulation2d DelaunayMesh::compact(std::pmr::vector<std::uint32_t>& vertex,
                                      std::pmr::vector<std::uint32_t>& triangle) const {
  number(vertex, triangle);
  StackMemory memory;
  std::pmr::vector<std::uint32_t> new_vertex(points_.size(), kNone, &memory),
      new_triangle(triangle_slots(), kNone, &memory);
  for (std::uint32_t v = 0; v < vertex.size(); ++v) new_vertex[vertex[v]] = v;
  for (std::uint32_t t = 0; t < triangle.size(); ++t) new_triangle[triangle[t]] = t;
  Triangulation2d mesh;
  mesh.reserve(triangle.size());
  for (const std::uint32_t t : triangle)
    mesh.add_triangle(new_vertex[corner_[3 * t]], new_vertex[corner_[3 * t + 1]], new_vertex[corner_[3 * t + 2]]);
  for (const std::uint32_t t : triangle)
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      if (!is_constrained(h)) mesh.join(3 * new_triangle[t] + h % 3, 3 * new_triangle[twin_[h] / 3] + twin_[h] % 3);
  for (const std::uint32_t h : half_edge_of_side_) mesh.constrain(3 * new_triangle[h / 3] + h % 3);
  return mesh;
}

}  // namespace remesh
