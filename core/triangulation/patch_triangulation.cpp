#include "core/triangulation/patch_triangulation.h"

#include <utility>

#include "core/geometry/exact/predicates.h"
#include "core/triangulation/carving.h"
#include "core/triangulation/delaunay_divide_conquer.h"
#include "core/triangulation/delaunay_flips.h"
#include "core/triangulation/lexicographic_triangulation.h"

namespace remesh {
namespace {

/// Above this many points, the long triangles of the sweep cost more flips than divide and conquer costs merges.
constexpr std::size_t kSweepLimit = 256;

/// Most patches of curved models are a single triangle, which needs no triangulation.
bool is_single_triangle(std::span<const Vec2> points, std::span<const Segment> edges) {
  return points.size() == 3 && edges.size() == 3 && edges[0][1] == edges[1][0] && edges[1][1] == edges[2][0] &&
         edges[2][1] == edges[0][0];
}

PatchTriangulation single_triangle(std::span<const Vec2> points, std::span<const Segment> edges) {
  PatchTriangulation result;
  const int orientation = orient2d(points[edges[0][0]], points[edges[1][0]], points[edges[2][0]]);
  if (orientation <= 0) {
    result.outcome = orientation == 0 ? TriangulationOutcome::kDegenerate : TriangulationOutcome::kInconsistentLoops;
    return result;
  }
  const std::uint32_t h = result.mesh.add_triangle(edges[0][0], edges[1][0], edges[2][0]);
  for (std::uint32_t k = 0; k < 3; ++k) result.mesh.constrain(h + k);
  return result;
}

}  // namespace

Triangulation2d triangulate_points(std::span<const Vec2> points, RunControl& control) {
  if (points.size() > kSweepLimit) return delaunay_divide_conquer(points, control);
  Triangulation2d mesh = lexicographic_triangulation(points, control);
  delaunay_flips(points, mesh, control);
  return mesh;
}

PatchTriangulation triangulate_patch(std::span<const Vec2> points, std::span<const Segment> loop_edges,
                                     RunControl& control) {
  if (is_single_triangle(points, loop_edges)) return single_triangle(points, loop_edges);
  PatchTriangulation result;
  Triangulation2d mesh = triangulate_points(points, control);
  if (mesh.triangle_count() == 0) {
    result.outcome = TriangulationOutcome::kDegenerate;
    return result;
  }
  result.outcome = constraint_recovery(points, loop_edges, mesh, control);
  if (result.outcome == TriangulationOutcome::kDone) result.outcome = carving(loop_edges, mesh, control);
  if (result.outcome == TriangulationOutcome::kDone) result.mesh = std::move(mesh);
  return result;
}

}  // namespace remesh
