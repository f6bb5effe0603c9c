/// Makes claims about curved patches for the tests of the checker.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "tests/core/verify/refined.h"
#include "tests/support/curved_place.h"
#include "tests/support/hausdorff.h"

namespace remesh {

inline constexpr double kPi = std::numbers::pi;
using test::CurvedPlace;

/// Triangles with patches. Vertices at the same coordinates are one.
class PatchedMesh {
 public:
  std::vector<Vec3> positions;
  std::vector<Triangle> faces;
  std::vector<PatchId> patches;

  VertexId vertex(const Vec3& p) {
    const auto [at, is_new] = numbers_.emplace(p, VertexId(positions.size()));
    if (is_new) positions.push_back(p);
    return at->second;
  }
  void add(PatchId patch, const Vec3& a, const Vec3& b, const Vec3& c) {
    if (a == b || b == c || c == a) return;
    faces.push_back({vertex(a), vertex(b), vertex(c)});
    patches.push_back(patch);
  }
  /// Adds a grid over the parameters between `low` and `high`. Vertices inside are moved by up to `shift` of a cell.
  void add_grid(PatchId patch, const CurvedPlace& place, Vec2 low, Vec2 high, int nu, int nv, double shift = 0) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-shift, shift);
    std::map<std::pair<int, int>, Vec3> points;
    for (int i = 0; i <= nu; ++i)
      for (int j = 0; j <= nv; ++j) {
        const bool is_inside = i > 0 && i < nu && j > 0 && j < nv;
        const double du = is_inside ? any(random) : 0, dv = is_inside ? any(random) : 0;
        const auto between = [](double a, double b, double t) { return t == 0 ? a : t == 1 ? b : a + t * (b - a); };
        points[{i, j}] = place.point(between(low.x, high.x, (i + du) / nu), between(low.y, high.y, (j + dv) / nv));
      }
    for (int i = 0; i < nu; ++i)
      for (int j = 0; j < nv; ++j) {
        const Vec3 &a = points[{i, j}], &b = points[{i + 1, j}], &c = points[{i + 1, j + 1}], &d = points[{i, j + 1}];
        const bool is_other = (i + j) % 2 == 1;
        add(patch, a, b, is_other ? d : c);
        add(patch, is_other ? b : a, c, d);
      }
  }
  /// Adds a convex polygon.
  void add_fan(PatchId patch, const std::vector<Vec3>& corners) {
    for (std::size_t i = 2; i < corners.size(); ++i) add(patch, corners[0], corners[i - 1], corners[i]);
  }

 private:
  std::map<Vec3, VertexId> numbers_;
};

/// Claims that `output` is the remeshed `input`.
/// Input: `surfaces` - one per patch; kPlane for planes, of which only the axis counts.
inline Example curved_example(const PatchedMesh& input, const PatchedMesh& output,
                              const std::vector<AnalyticSurface>& surfaces, double tolerance) {
  Example e;
  std::vector<std::vector<std::uint32_t>> lists;
  for (const Triangle& face : input.faces) lists.push_back({face[0].value, face[1].value, face[2].value});
  const PolygonMesh mesh = shapes::from_lists(input.positions, lists);
  e.surface = shapes::surface(mesh);
  e.surface_patch = IdVector<FaceId, PatchId>(input.patches.size());
  for (std::size_t f = 0; f < input.patches.size(); ++f) e.surface_patch[FaceId(f)] = input.patches[f];
  for (std::size_t p = 0; p < surfaces.size(); ++p) {
    if (surfaces[p].kind == SurfaceKind::kPlane) {
      e.frames.push_back(frame_of(mesh, e.surface_patch, PatchId(p)));
      e.curved_of_patch.push_back(kNone);
      continue;
    }
    // The frame of a curved patch is not to be read.
    const double nan = std::nan("");
    e.frames.push_back({{nan, nan, nan}, {nan, 0, 0}, {0, nan, 0}, {0, 0, nan}, nan, nan});
    e.curved_of_patch.push_back(static_cast<std::uint32_t>(e.curved.size()));
    // The options allow any tolerance.
    e.curved.push_back({surfaces[p], tolerance, HUGE_VAL});
  }
  e.positions = output.positions;
  e.faces = output.faces;
  e.face_patch = output.patches;
  Box3 box;
  for (const Vec3& p : input.positions) box.add(p);
  e.plane_tolerance = 1e-9 * box.diagonal();
  e.goals = no_goals();
  e.project();
  e.make_delaunay();
  return e;
}

/// The distance between input and output of a patch, both ways, or less by no more than `accuracy`.
inline double true_distance(const Example& e, PatchId patch, double accuracy) {
  std::vector<Corners3> input, output;
  for (std::size_t f = 0; f < e.surface_patch.size(); ++f) {
    if (e.surface_patch[FaceId(f)] != patch) continue;
    const auto corner = [&](std::size_t k) {
      return e.surface.positions[e.surface.corners[e.surface.face_begin[f] + k]];
    };
    input.push_back({corner(0), corner(1), corner(2)});
  }
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (e.face_patch[f] == patch)
      output.push_back(
          {e.positions[e.faces[f][0].value], e.positions[e.faces[f][1].value], e.positions[e.faces[f][2].value]});
  return test::hausdorff(input, output, accuracy);
}

}  // namespace remesh
