#include "tests/support/cgal_plane.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstdint>
#include <utility>

namespace remesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using CgalPolygon = CGAL::Polygon_2<Kernel>;

Kernel::Point_2 to_cgal(Vec2 p) { return {p.x, p.y}; }

CgalPolygon to_cgal(const polygons::Loop& loop) {
  CgalPolygon polygon;
  for (const Vec2 p : loop) polygon.push_back(to_cgal(p));
  return polygon;
}

template <class Triangulation>
std::vector<Corners> triangles(const Triangulation& triangulation) {
  std::vector<Corners> result;
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f)
    result.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return result;
}

}  // namespace

int cgal_orientation(Vec2 a, Vec2 b, Vec2 c) { return CGAL::orientation(to_cgal(a), to_cgal(b), to_cgal(c)); }

int cgal_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return CGAL::side_of_oriented_circle(to_cgal(a), to_cgal(b), to_cgal(c), to_cgal(d));
}

std::vector<Corners> cgal_delaunay(std::span<const Vec2> points) {
  using Structure = CGAL::Triangulation_data_structure_2<VertexBase>;
  std::vector<std::pair<Kernel::Point_2, std::uint32_t>> input;
  for (std::uint32_t i = 0; i < points.size(); ++i) input.push_back({to_cgal(points[i]), i});
  return triangles(CGAL::Delaunay_triangulation_2<Kernel, Structure>(input.begin(), input.end()));
}

std::vector<Corners> cgal_cdt(std::span<const Vec2> points, std::span<const Segment> segments) {
  using Structure =
      CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                             CGAL::No_constraint_intersection_requiring_constructions_tag>
      cdt;
  std::vector<decltype(cdt)::Vertex_handle> handle;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    handle.push_back(cdt.insert(to_cgal(points[i])));
    handle.back()->info() = i;
  }
  for (const auto& [a, b] : segments) cdt.insert_constraint(handle[a], handle[b]);
  return canonical(triangles(cdt));
}

std::string cgal_fault_of(const polygons::Polygon& polygon) {
  std::vector<CgalPolygon> loops{to_cgal(polygon.outer)};
  for (const polygons::Loop& hole : polygon.holes) loops.push_back(to_cgal(hole));
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const std::string loop = "loop " + std::to_string(i), hole = "hole " + std::to_string(i);
    if (!loops[i].is_simple()) return loop + " is not simple";
    if (loops[i].is_clockwise_oriented() != (i > 0)) return loop + " turns";
    if (i > 0 && loops[0].bounded_side(loops[i][0]) != CGAL::ON_BOUNDED_SIDE) return hole + " is outside";
    for (std::size_t j = 0; j < i; ++j) {
      if (j > 0 && loops[j].bounded_side(loops[i][0]) != CGAL::ON_UNBOUNDED_SIDE)
        return hole + " is in hole " + std::to_string(j);
      for (auto a = loops[i].edges_begin(); a != loops[i].edges_end(); ++a)
        for (auto b = loops[j].edges_begin(); b != loops[j].edges_end(); ++b)
          if (CGAL::do_intersect(*a, *b)) return loop + " meets loop " + std::to_string(j);
    }
  }
  return {};
}

}  // namespace remesh
