#include "core/mending/details/detail_complex.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/stoppable.h"

namespace remesh {

DetailComplex::DetailComplex(std::span<const Vec3> positions, std::span<const Triangle> faces, RunControl& control) {
  StopCheck check(control);
  for (const Vec3& p : positions) {
    check();
    add_point(p, {p, p});
  }
  points_.reserve(faces.size());
  of_.reserve(faces.size());
  next_.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check();
    add_triangle({faces[f][0].value, faces[f][1].value, faces[f][2].value}, FaceId(f));
  }
}

std::uint32_t DetailComplex::add_point(const Vec3& place, const Box3& box) {
  const auto point = static_cast<std::uint32_t>(place_.size());
  parent_.push_back(point);
  place_.push_back(place);
  box_.push_back(box);
  first_.push_back(kNone);
  last_.push_back(kNone);
  return point;
}

std::uint32_t DetailComplex::add_triangle(const std::array<std::uint32_t, 3>& points, FaceId of) {
  const auto triangle = static_cast<std::uint32_t>(points_.size());
  points_.push_back(points);
  of_.push_back(of);
  is_cut_.push_back(0);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t corner = 3 * triangle + k, node = node_of(points[k]);
    next_.push_back(kNone);
    if (first_[node] == kNone)
      first_[node] = corner;
    else
      next_[last_[node]] = corner;
    last_[node] = corner;
  }
  return triangle;
}

std::uint32_t DetailComplex::node_of(std::uint32_t point) const {
  while (parent_[point] != point) {
    parent_[point] = parent_[parent_[point]];
    point = parent_[point];
  }
  return point;
}

bool DetailComplex::find_present(std::uint32_t triangle, PresentTriangle& present) const {
  if (is_cut_[triangle] != 0) return false;
  present.index = triangle;
  for (std::size_t k = 0; k < 3; ++k) present.corners[k] = node_of(points_[triangle][k]);
  const auto& c = present.corners;
  return c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
}

void DetailComplex::collect(std::uint32_t node, std::vector<PresentTriangle>& triangles, WorkBound& work) const {
  triangles.clear();
  std::uint64_t steps = 1;
  PresentTriangle present{};
  for (std::uint32_t corner = first_[node]; corner != kNone; corner = next_[corner], ++steps)
    if (find_present(corner / 3, present)) triangles.push_back(present);
  work.take(steps);
}

double DetailComplex::farthest(const Box3& box, const Vec3& place) {
  Vec3 away;
  for (int axis = 0; axis < 3; ++axis)
    away[axis] = std::max(std::fabs(box.min[axis] - place[axis]), std::fabs(box.max[axis] - place[axis]));
  return norm(away);
}

double DetailComplex::reach_on_edge(std::uint32_t from, std::uint32_t to, double at, const Vec3& place) const {
  return farthest(box_on_edge(from, to, at), place);
}

Box3 DetailComplex::box_on_edge(std::uint32_t from, std::uint32_t to, double at) const {
  // A point between two points of two boxes lies in the box between these.
  return {box_[from].min + at * (box_[to].min - box_[from].min), box_[from].max + at * (box_[to].max - box_[from].max)};
}

void DetailComplex::join(std::uint32_t from, std::uint32_t to) {
  parent_[from] = to;
  box_[to].add(box_[from]);
  if (first_[from] == kNone) return;
  if (first_[to] == kNone)
    first_[to] = first_[from];
  else
    next_[last_[to]] = first_[from];
  last_[to] = last_[from];
}

std::uint32_t DetailComplex::cut(std::uint32_t from, std::uint32_t to, double at, WorkBound& work) {
  // All triangles with both nodes have this edge. Triangles without area may have it twice.
  std::vector<std::uint32_t> with_edge;
  std::uint64_t steps = 1;
  for (std::uint32_t corner = first_[from]; corner != kNone; corner = next_[corner], ++steps) {
    const std::uint32_t triangle = corner / 3;
    if (is_cut_[triangle] != 0) continue;
    const auto& p = points_[triangle];
    if (std::any_of(p.begin(), p.end(), [&](std::uint32_t point) { return node_of(point) == to; }))
      with_edge.push_back(triangle);
  }
  work.take(steps);
  sort_unique(with_edge);

  const Vec3 place = place_on_edge(from, to, at);
  const Box3 box = box_on_edge(from, to, at);
  std::uint32_t node = kNone;
  // One point for each pair of points between which the edge runs.
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> made;
  const auto point_between = [&](std::uint32_t p, std::uint32_t q) {
    if (node_of(p) != from) std::swap(p, q);
    for (const auto& [ends, point] : made)
      if (ends == std::pair(p, q)) return point;
    const std::uint32_t point = add_point(place, box);
    cuts_.push_back({VertexId(p), VertexId(q), at});
    if (node == kNone)
      node = point;
    else
      join(point, node);
    made.push_back({{p, q}, point});
    return point;
  };
  for (const std::uint32_t triangle : with_edge) {
    is_cut_[triangle] = 1;
    const FaceId of = of_[triangle];
    // The corners in order, with the new points between them.
    std::array<std::uint32_t, 6> loop{};
    std::array<bool, 6> is_new{};
    std::size_t size = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = points_[triangle][k], q = points_[triangle][(k + 1) % 3];
      loop[size++] = p;
      const std::uint32_t a = node_of(p), b = node_of(q);
      if ((a != from || b != to) && (a != to || b != from)) continue;
      is_new[size] = true;
      loop[size++] = point_between(p, q);
    }
    // With one new point, the loop is cut into a fan from it. With two, the corner between them is cut off, and the
    // rest is cut along a diagonal.
    std::size_t begin = 0;
    while (!is_new[begin]) ++begin;
    if (size == 4) {
      add_triangle({loop[begin], loop[(begin + 1) % 4], loop[(begin + 2) % 4]}, of);
      add_triangle({loop[begin], loop[(begin + 2) % 4], loop[(begin + 3) % 4]}, of);
      continue;
    }
    while (!is_new[(begin + 2) % size]) begin = (begin + 1) % size;
    // loop[begin] and loop[begin + 2] are new, and the corner between them is cut off.
    add_triangle({loop[begin], loop[(begin + 1) % 5], loop[(begin + 2) % 5]}, of);
    add_triangle({loop[begin], loop[(begin + 2) % 5], loop[(begin + 3) % 5]}, of);
    add_triangle({loop[begin], loop[(begin + 3) % 5], loop[(begin + 4) % 5]}, of);
  }
  return node;
}

DetailMap DetailComplex::take_map() {
  DetailMap map;
  map.cuts = std::move(cuts_);
  std::vector<std::uint32_t> order;
  for (std::uint32_t t = 0; t < points_.size(); ++t)
    if (is_cut_[t] == 0) order.push_back(t);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t t, std::uint32_t u) { return std::pair(of_[t], t) < std::pair(of_[u], u); });
  map.pieces.reserve(order.size());
  for (const std::uint32_t t : order)
    map.pieces.push_back({{VertexId(points_[t][0]), VertexId(points_[t][1]), VertexId(points_[t][2])}, of_[t]});
  map.image.reserve(place_.size());
  for (std::uint32_t p = 0; p < place_.size(); ++p) map.image.push_back(VertexId(node_of(p)));
  return map;
}

}  // namespace remesh
