/// Correct refined claims that are made by hand, and the means to make more of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/core/verify/cases.h"

namespace remesh {

inline Goals no_goals() {
  Goals goals;
  goals.max_edge_length = goals.max_area = std::numeric_limits<double>::infinity();
  goals.max_faces = std::numeric_limits<std::uint64_t>::max();
  return goals;
}
inline Goals angle_goal(double degrees) {
  Goals goals = no_goals();
  goals.min_angle_deg = degrees;
  return goals;
}

/// Returns the claim as one about a refined result, which may have new vertices.
inline Example refined(Example e, const Goals& goals = no_goals()) {
  e.goals = goals;
  return e;
}
inline Example refined(const PolygonMesh& input, const PolygonMesh& output, const Goals& goals = no_goals()) {
  return refined(example(input, output), goals);
}

inline void list(Example& e, std::size_t face, UnrefinedReason reason) {
  const auto at = std::lower_bound(e.unrefined.begin(), e.unrefined.end(), FaceId(face));
  e.reasons.insert(e.reasons.begin() + (at - e.unrefined.begin()), reason);
  e.unrefined.insert(at, FaceId(face));
}

/// Cuts the edge from a to b at m in all its faces, or in those of one patch.
inline void split_edge(Example& e, const Vec3& a, const Vec3& b, const Vec3& m, PatchId only = PatchId()) {
  const VertexId va = e.vertex_at(a), vb = e.vertex_at(b), vm = e.add_vertex(m);
  for (std::size_t f = e.faces.size(); f-- > 0;) {
    if (only.is_valid() && e.face_patch[f] != only) continue;
    const Triangle face = e.faces[f];
    for (int i = 0; i < 3; ++i) {
      const VertexId from = face[i], to = face[(i + 1) % 3], apex = face[(i + 2) % 3];
      if (!((from == va && to == vb) || (from == vb && to == va))) continue;
      e.faces[f] = {from, vm, apex};
      e.faces.push_back({vm, to, apex});
      e.face_patch.push_back(e.face_patch[f]);
    }
  }
  e.project();
  e.make_delaunay();
}

/// Puts a vertex into a face, which becomes three.
inline void split_face(Example& e, std::size_t f, const Vec3& m) {
  const auto [a, b, c] = e.faces[f];
  const VertexId vm = e.add_vertex(m);
  e.faces[f] = {a, b, vm};
  e.faces.push_back({b, c, vm});
  e.faces.push_back({c, a, vm});
  e.face_patch.insert(e.face_patch.end(), 2, e.face_patch[f]);
  e.project();
  e.make_delaunay();
}

inline void move_vertex(Example& e, const Vec3& from, const Vec3& to) {
  e.positions[e.vertex_at(from).value] = to;
  e.project();
}

/// Makes a square with a new vertex in its middle.
inline Example square_with_new_middle() {
  return refined(shapes::sheet(2, 2, 1, 1), shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                                                               {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}));
}

/// Makes a cube of which each edge is cut into n pieces.
inline Example refined_cube(int n) { return refined(shapes::box({1, 1, 1}), shapes::box({1, 1, 1}, n)); }

/// Makes three pages whose common edge is cut.
inline Example refined_pages(int n) { return refined(shapes::three_pages(1), shapes::three_pages(n)); }

/// Makes a square plate with a fin on it. The foot of the fin is inside the plate, so it is an edge with the plate on
/// both sides.
inline Example plate_with_fin() {
  const std::vector<Vec3> points{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0},
                                 {1, 2, 0}, {3, 2, 0}, {3, 2, 1}, {1, 2, 1}};
  const PolygonMesh input = shapes::from_lists(
      points, {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {3, 0, 4}, {4, 5, 6}, {4, 6, 7}});
  Example e = refined(input, input);
  split_edge(e, {1, 2, 0}, {3, 2, 0}, {2, 2, 0});
  return e;
}

/// Makes a wedge of `degrees` at the origin whose two sides are cut at shells of radius 1 to `shells`.
inline Example wedge(double degrees, int shells, double bound) {
  const double angle = degrees * 3.14159265358979323846 / 180;
  const Vec3 right{1, 0, 0}, left{std::cos(angle), std::sin(angle), 0};
  PolygonMesh input = shapes::from_lists({{0, 0, 0}, double(shells) * right, double(shells) * left}, {{0, 1, 2}});
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::vector<std::uint32_t>> faces{{0, 1, 2}};
  for (int k = 1; k <= shells; ++k) {
    points.push_back(double(k) * right);
    points.push_back(double(k) * left);
  }
  for (std::uint32_t k = 1; k < static_cast<std::uint32_t>(shells); ++k) {
    const std::uint32_t a = 2 * k - 1, b = 2 * k;
    faces.push_back({a, a + 2, b});
    faces.push_back({a + 2, b + 2, b});
  }
  return refined(input, shapes::from_lists(points, faces), angle_goal(bound));
}

}  // namespace remesh
