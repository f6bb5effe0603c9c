/// Makes claims for the tests of the checker. A claim is correct at first, and there are means to spoil it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/verify/verify.h"
#include "tests/support/cgal_plane.h"
#include "tests/support/shapes.h"

namespace remesh {

/// A claim that owns its parts, so that a test can spoil one of them.
struct Example {
  Surface surface;
  IdVector<FaceId, PatchId> surface_patch;
  IdVector<PatchId, Frame> frames;
  std::vector<std::uint32_t> frame_of_patch;  ///< index in `frames`, or kNone; empty if every patch has a frame
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;
  std::vector<PatchId> face_patch;
  std::vector<Vec2> corner_uv;
  double plane_tolerance = 0;
  std::optional<Goals> goals;  ///< empty if nothing was refined
  std::vector<FaceId> unrefined;
  std::vector<UnrefinedReason> reasons;
  std::vector<std::uint8_t> frozen;                               ///< empty if no patch is frozen
  std::vector<std::pair<PatchId, PatchId>> intersecting_patches;  ///< pairs that cross in the input
  bool are_these_all = true;                                      ///< whether the pairs above are all
  std::vector<std::uint32_t> curved_of_patch;                     ///< empty if all patches are planes
  std::vector<CurvedClaim> curved;
  std::vector<MovedVertex> moved;
  const PolygonMesh* input = nullptr;  ///< null if it is not known from what `surface` was made
  double weld_tolerance = 0;

  Verdict verify() const {
    RunControl control;
    return verify(control);
  }
  Verdict verify(RunControl& control) const {
    const RefinementClaim refinement{goals.value_or(Goals()), unrefined, reasons, frozen};
    const InputIntersections known{intersecting_patches, are_these_all};
    const ClaimedFrames of_patches =
        frame_of_patch.empty() ? ClaimedFrames(frames) : ClaimedFrames(frame_of_patch, frames.items());
    Claim claim{surface,    surface_patch, of_patches,      positions,        faces,
                face_patch, corner_uv,     plane_tolerance, goals.has_value()};
    claim.refinement = goals ? &refinement : nullptr;
    claim.intersections = &known;
    claim.curved_of_patch = curved_of_patch;
    claim.curved = curved;
    claim.moved = moved;
    claim.input = input;
    claim.weld_tolerance = weld_tolerance;
    return remesh::verify(claim, control);
  }
  /// Claims that the input intersects where the output does.
  void allow_intersections() {
    for (const auto& [f, g] : verify().intersections)
      intersecting_patches.push_back(std::minmax(face_patch[f.value], face_patch[g.value]));
    std::sort(intersecting_patches.begin(), intersecting_patches.end());
  }
  /// Moves vertices of the input.
  template <class Move>
  void move(const Move& move) {
    surface.positions.change([&](std::vector<Vec3>& positions) {
      for (Vec3& p : positions) move(p);
    });
  }
  Vec2 project(PatchId p, const Vec3& point) const {
    const Frame& f = frames[p];
    const auto rounded = [&](double t) { return std::nearbyint(t / f.scale / f.grid) * f.grid; };
    return {rounded(dot(point - f.origin, f.x_axis)), rounded(dot(point - f.origin, f.y_axis))};
  }
  /// Stores the plane coordinates of all faces again.
  void project() {
    corner_uv.clear();
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const VertexId v : faces[f]) corner_uv.push_back(project(face_patch[f], positions[v.value]));
  }
  /// Flips edges until all are locally Delaunay, by an exact predicate that is not ours.
  void make_delaunay() {
    for (bool is_done = false; !is_done;) {
      is_done = true;
      for (std::size_t f = 0; f < faces.size() && is_done; ++f)
        for (std::size_t g = 0; g < faces.size() && is_done; ++g)
          for (int i = 0; i < 9 && is_done; ++i) is_done = !flip(f, i % 3, g, i / 3);
    }
  }
  /// Flips the edge that face f begins at corner i, if it is face g's at corner j and not Delaunay.
  bool flip(std::size_t f, int i, std::size_t g, int j) {
    const VertexId from = faces[f][i], to = faces[f][(i + 1) % 3];
    const bool is_plane = curved_of_patch.empty() || curved_of_patch[face_patch[f].value] == kNone;
    if (!is_plane || face_patch[f] != face_patch[g] || faces[g][j] != to || faces[g][(j + 1) % 3] != from) return false;
    const VertexId left = faces[f][(i + 2) % 3], right = faces[g][(j + 2) % 3];
    const auto point = [&](VertexId v) { return project(face_patch[f], positions[v.value]); };
    if (cgal_in_circle(point(from), point(to), point(left), point(right)) <= 0) return false;
    faces[f] = {left, from, right};
    faces[g] = {right, to, left};
    project();
    return true;
  }
  VertexId vertex_at(const Vec3& p) const {
    return VertexId(static_cast<std::size_t>(std::find(positions.begin(), positions.end(), p) - positions.begin()));
  }
  VertexId add_vertex(const Vec3& p) {
    if (vertex_at(p).value == positions.size()) positions.push_back(p);
    return vertex_at(p);
  }
  void add_face(PatchId patch, const Vec3& a, const Vec3& b, const Vec3& c) {
    const VertexId va = add_vertex(a), vb = add_vertex(b), vc = add_vertex(c);
    faces.push_back({va, vb, vc});
    face_patch.push_back(patch);
    project();
  }
  void remove_face(std::size_t f) {
    faces.erase(faces.begin() + f);
    face_patch.erase(face_patch.begin() + f);
    project();
  }
  void remove_patch(PatchId patch) {
    for (std::size_t f = faces.size(); f-- > 0;)
      if (face_patch[f] == patch) remove_face(f);
  }
  /// Returns the face with these corners, which may be in any order.
  std::size_t face_at(const Vec3& a, const Vec3& b, const Vec3& c) const {
    std::vector<Vec3> wanted{a, b, c};
    std::sort(wanted.begin(), wanted.end());
    for (std::size_t f = 0; f < faces.size(); ++f) {
      std::vector<Vec3> corners;
      for (const VertexId v : faces[f]) corners.push_back(positions[v.value]);
      std::sort(corners.begin(), corners.end());
      if (corners == wanted) return f;
    }
    throw std::invalid_argument("no such face");
  }
  PatchId patch_at(const Vec3& a, const Vec3& b, const Vec3& c) const { return face_patch[face_at(a, b, c)]; }
};

/// Divides each triangle into three at its middle, so that none is left of those that there were.
inline PolygonMesh split_in_three(const PolygonMesh& mesh) {
  std::vector<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
  std::vector<std::vector<std::uint32_t>> faces;
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
    const auto corners = mesh.face(f);
    const auto middle = static_cast<std::uint32_t>(positions.size());
    Vec3 sum;
    for (const VertexId v : corners) sum += mesh.positions[v];
    positions.push_back((1.0 / 3) * sum);
    for (std::size_t i = 0; i < 3; ++i) faces.push_back({corners[i].value, corners[(i + 1) % 3].value, middle});
  }
  return shapes::from_lists(positions, faces);
}

inline Vec3 normal_of(const PolygonMesh& mesh, std::size_t f) {
  const auto face = mesh.face(FaceId(f));
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < face.size(); ++i)
    sum +=
        cross(mesh.positions[face[i]] - mesh.positions[face[0]], mesh.positions[face[i + 1]] - mesh.positions[face[0]]);
  return normalized(sum);
}

/// Finds the patches of connected coplanar faces in the plain way, by comparing each face with its neighbours.
inline IdVector<FaceId, PatchId> plain_patches(const PolygonMesh& mesh, std::size_t& count) {
  std::map<std::pair<VertexId, VertexId>, std::vector<std::size_t>> by_edge;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(FaceId(f));
    for (std::size_t i = 0; i < face.size(); ++i)
      by_edge[std::minmax(face[i], face[(i + 1) % face.size()])].push_back(f);
  }
  IdVector<FaceId, PatchId> patch(mesh.face_count());
  count = 0;
  for (std::size_t seed = 0; seed < mesh.face_count(); ++seed) {
    if (patch[FaceId(seed)].is_valid()) continue;
    std::vector<std::size_t> todo{seed};
    patch[FaceId(seed)] = PatchId(count);
    while (!todo.empty()) {
      const std::size_t f = todo.back();
      todo.pop_back();
      const auto face = mesh.face(FaceId(f));
      for (std::size_t i = 0; i < face.size(); ++i) {
        const auto& around = by_edge[std::minmax(face[i], face[(i + 1) % face.size()])];
        if (around.size() != 2) continue;
        const std::size_t g = around[0] == f ? around[1] : around[0];
        if (patch[FaceId(g)].is_valid() || dot(normal_of(mesh, f), normal_of(mesh, g)) < 1 - 1e-6) continue;
        patch[FaceId(g)] = PatchId(count);
        todo.push_back(g);
      }
    }
    ++count;
  }
  return patch;
}

inline Frame frame_of(const PolygonMesh& mesh, const IdVector<FaceId, PatchId>& patch, PatchId p) {
  Box3 box;
  Vec3 normal, edge;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    if (patch[FaceId(f)] != p) continue;
    const auto face = mesh.face(FaceId(f));
    for (const VertexId v : face) box.add(mesh.positions[v]);
    normal += normal_of(mesh, f);
    const Vec3 side = mesh.positions[face[1]] - mesh.positions[face[0]];
    if (norm(side) > norm(edge)) edge = side;
  }
  Frame frame;
  frame.normal = normalized(normal);
  frame.x_axis = normalized(edge - dot(edge, frame.normal) * frame.normal);
  frame.y_axis = cross(frame.normal, frame.x_axis);
  frame.origin = box.min + 0.5 * (box.max - box.min);
  frame.origin += -dot(frame.origin - box.min, frame.normal) * frame.normal;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)  // a point of the plane, to be sure
    if (patch[FaceId(f)] == p) {
      const Vec3& on = mesh.positions[mesh.face(FaceId(f))[0]];
      frame.origin += dot(on - frame.origin, frame.normal) * frame.normal;
    }
  frame.scale = std::ldexp(1.0, std::ilogb(box.diagonal()) + 1);
  frame.grid = 0x1p-40;
  return frame;
}

/// Claims that `output`, triangles over some of the input's vertices, is the remeshed `input`. Each output face belongs
/// to the patch with its normal that holds its middle.
inline Example example(const PolygonMesh& input, const PolygonMesh& output) {
  Example out;
  std::size_t patch_count = 0;
  out.surface = shapes::surface(input);
  out.surface_patch = plain_patches(input, patch_count);
  for (std::size_t p = 0; p < patch_count; ++p) out.frames.push_back(frame_of(input, out.surface_patch, PatchId(p)));
  out.positions = output.positions.items();
  Box3 box;
  for (const Vec3& p : out.positions) box.add(p);
  out.plane_tolerance = 1e-9 * box.diagonal();
  for (std::size_t f = 0; f < output.face_count(); ++f) {
    const auto face = output.face(FaceId(f));
    const Vec3 middle = 1.0 / 3 * (output.positions[face[0]] + output.positions[face[1]] + output.positions[face[2]]);
    const Vec3 normal = normal_of(output, f);
    PatchId patch;
    for (std::size_t g = 0; g < input.face_count(); ++g) {
      const auto in = input.face(FaceId(g));
      if (dot(normal, normal_of(input, g)) < 1 - 1e-6) continue;
      if (std::fabs(dot(normal, middle - input.positions[in[0]])) > 1e-6 * box.diagonal()) continue;
      bool is_inside = true;  // faces of the examples are convex, or a patch of their own
      for (std::size_t i = 0; i < in.size() && in.size() == 3; ++i) {
        const Vec3& a = input.positions[in[i]];
        const Vec3& b = input.positions[in[(i + 1) % in.size()]];
        if (dot(cross(b - a, middle - a), normal) < -1e-9 * box.diagonal() * box.diagonal()) is_inside = false;
      }
      if (is_inside) {
        patch = out.surface_patch[FaceId(g)];
        break;
      }
    }
    if (!patch.is_valid()) throw std::invalid_argument("an output face outside the input");
    out.faces.push_back({face[0], face[1], face[2]});
    out.face_patch.push_back(patch);
  }
  out.project();
  out.make_delaunay();
  return out;
}

/// Returns the same claim in other units.
inline Example scaled(Example e, double factor) {
  e.move([&](Vec3& p) { p = factor * p; });
  for (Vec3& p : e.positions) p = factor * p;
  for (Frame& frame : e.frames) {
    frame.origin = factor * frame.origin;
    frame.scale = std::ldexp(frame.scale, std::ilogb(factor) + 1);
  }
  e.plane_tolerance *= factor;
  if (e.goals) {
    e.goals->max_edge_length *= factor;
    e.goals->min_edge_length *= factor;
    e.goals->max_area = e.goals->max_area * factor * factor;
  }
  e.project();
  e.make_delaunay();
  return e;
}

inline ::testing::AssertionResult is_verified(const Example& e) {
  const Verdict v = e.verify();
  if (v.all_true() && v.failed_patches.empty()) return ::testing::AssertionSuccess();
  auto failure = ::testing::AssertionFailure();
  failure << "surface " << v.surface << ", conforming " << v.conforming << ", delaunay " << v.delaunay << ", quality "
          << v.quality.value_or(true);
  for (const std::string& words : v.failures) failure << "\n  " << words;
  return failure;
}

inline std::string all_words(const Verdict& v) {
  std::string all;
  for (const std::string& words : v.failures) all += words + "\n";
  return all;
}

inline bool blames(const Verdict& v, PatchId p) {
  return std::find(v.failed_patches.begin(), v.failed_patches.end(), p) != v.failed_patches.end();
}

}  // namespace remesh
