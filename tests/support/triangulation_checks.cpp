#include "tests/support/triangulation_checks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

bool is_strictly_between(Vec2 a, Vec2 b, Vec2 p) {
  return orient2d(a, b, p) == 0 && std::min(a, b) < p && p < std::max(a, b);
}

}  // namespace

std::vector<Corners> canonical(std::vector<Corners> list) {
  for (Corners& t : list) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<Corners> triangles_of(const Triangulation2d& mesh) {
  std::vector<Corners> list;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    list.push_back({mesh.from(h), mesh.to(h), mesh.apex(h)});
  return canonical(std::move(list));
}

std::set<Segment> edges_of(const Triangulation2d& mesh) {
  std::set<Segment> edges;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
    edges.insert({std::min(mesh.from(h), mesh.to(h)), std::max(mesh.from(h), mesh.to(h))});
  return edges;
}

std::set<Segment> constrained_edges_of(const Triangulation2d& mesh) {
  std::set<Segment> edges;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h)
    if (mesh.is_constrained(h)) edges.insert({std::min(mesh.from(h), mesh.to(h)), std::max(mesh.from(h), mesh.to(h))});
  return edges;
}

void expect_valid(std::span<const Vec2> points, const Triangulation2d& mesh) {
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    ASSERT_GT(orient2d(points[mesh.from(h)], points[mesh.to(h)], points[mesh.apex(h)]), 0);
    const std::uint32_t g = mesh.twin(h);
    if (g == kNoHalfEdge) continue;
    ASSERT_EQ(mesh.twin(g), h);
    ASSERT_EQ(mesh.from(g), mesh.to(h));
    ASSERT_EQ(mesh.to(g), mesh.from(h));
    ASSERT_EQ(mesh.is_constrained(g), mesh.is_constrained(h));
  }
}

void expect_locally_delaunay(std::span<const Vec2> points, const Triangulation2d& mesh) {
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const std::uint32_t g = mesh.twin(h);
    if (g == kNoHalfEdge || mesh.is_constrained(h)) continue;
    ASSERT_LT(in_circle_perturbed(points[mesh.from(h)], points[mesh.to(h)], points[mesh.apex(h)], points[mesh.apex(g)]),
              0)
        << mesh.from(h) << '-' << mesh.to(h);
  }
}

double area_of(std::span<const Vec2> points, const Triangulation2d& mesh) {
  double twice = 0;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    twice += cross(points[mesh.to(h)] - points[mesh.from(h)], points[mesh.apex(h)] - points[mesh.from(h)]);
  return twice / 2;
}

std::size_t hull_size(std::span<const Vec2> sorted_points) {
  std::size_t size = 0;  // Andrew's monotone chain, with collinear points
  for (const int side : {1, -1}) {
    std::vector<Vec2> chain;
    for (const Vec2 p : sorted_points) {
      while (chain.size() >= 2 && side * orient2d(chain[chain.size() - 2], chain.back(), p) < 0) chain.pop_back();
      chain.push_back(p);
    }
    size += chain.size() - 1;
  }
  return size;
}

bool segments_conflict(std::span<const Vec2> points, const Segment& a, const Segment& b) {
  const Vec2 p = points[a[0]], q = points[a[1]], r = points[b[0]], s = points[b[1]];
  if (std::minmax(a[0], a[1]) == std::minmax(b[0], b[1])) return false;
  if (is_strictly_between(p, q, r) || is_strictly_between(p, q, s) || is_strictly_between(r, s, p) ||
      is_strictly_between(r, s, q))
    return true;
  return orient2d(p, q, r) * orient2d(p, q, s) < 0 && orient2d(r, s, p) * orient2d(r, s, q) < 0;
}

bool has_point_inside(std::span<const Vec2> points, const Segment& segment) {
  return std::any_of(points.begin(), points.end(),
                     [&](Vec2 p) { return is_strictly_between(points[segment[0]], points[segment[1]], p); });
}

}  // namespace remesh
