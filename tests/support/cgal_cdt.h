/// The constrained Delaunay triangulation by CGAL: the oracle for ours.
#pragma once

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <span>
#include <vector>

#include "tests/support/triangulation_checks.h"

namespace remesh {

/// All triangles of the convex hull, canonical. The segments must not cross.
inline std::vector<Corners> cgal_cdt(std::span<const Vec2> points, std::span<const Segment> segments) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
  using Structure =
      CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                             CGAL::No_constraint_intersection_requiring_constructions_tag>
      cdt;
  std::vector<decltype(cdt)::Vertex_handle> handle;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    handle.push_back(cdt.insert(Kernel::Point_2(points[i].x, points[i].y)));
    handle.back()->info() = i;
  }
  for (const auto& [a, b] : segments) cdt.insert_constraint(handle[a], handle[b]);
  std::vector<Corners> triangles;
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f)
    triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return canonical(std::move(triangles));
}

}  // namespace remesh
