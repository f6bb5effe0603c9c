#include "tests/bench/refinement.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "core/triangulation/patch_triangulation.h"
#include "tests/bench/inputs.h"
#include "tests/bench/timing.h"
#include "tests/support/polygons.h"
#include "tests/support/shapes.h"

namespace remesh::bench {
namespace {

/// CGAL's bound is the square of a sine, and corresponds to 20.7 degrees. Our bound is a little higher.
constexpr double kCgalBound = 0.125;
constexpr double kDegrees = 20.705;

struct Outcome {
  double ms = 0;  ///< time of triangulation and refinement; the median of three runs
  std::uint64_t triangles = 0;
};

/// Runs the refinement once on one thread.
Outcome refine_ours(const PolygonMesh& mesh, const Options& options) {
  RunControl control;
  const Result result = remesh_surface(mesh, options, {}, control);
  Outcome outcome;
  for (const StageTime& time : result.report.timing_ms)
    if (time.stage == Stage::kTriangulation || time.stage == Stage::kRefinement) outcome.ms += time.ms;
  outcome.triangles = result.mesh.faces.size();
  return outcome;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                                       CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure>;

/// Returns a point inside a loop.
Kernel::Point_2 point_inside(polygons::Loop loop) {
  if (polygons::area(loop) < 0) std::reverse(loop.begin(), loop.end());
  RunControl control;
  const polygons::PatchInput input = polygons::patch_input({loop, {}});
  const PatchTriangulation made = triangulate_patch(input.points, input.edges, control);
  const Vec2 centre =
      (1.0 / 3) * (input.points[made.mesh.from(0)] + input.points[made.mesh.from(1)] + input.points[made.mesh.from(2)]);
  return {centre.x, centre.y};
}

Outcome refine_cgal(const polygons::PatchInput& input, const std::vector<Kernel::Point_2>& seeds) {
  std::vector<Kernel::Point_2> points;
  for (const Vec2 p : input.points) points.emplace_back(p.x, p.y);
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  for (const Segment& edge : input.edges) edges.emplace_back(edge[0], edge[1]);
  Outcome outcome;
  Cdt cdt;
  outcome.ms = milliseconds([&] {
    cdt.insert_constraints(points.begin(), points.end(), edges.begin(), edges.end());
    CGAL::Delaunay_mesher_2<Cdt, CGAL::Delaunay_mesh_size_criteria_2<Cdt>> mesher(cdt);
    mesher.set_seeds(seeds.begin(), seeds.end(), false);
    mesher.set_criteria(CGAL::Delaunay_mesh_size_criteria_2<Cdt>(kCgalBound, 0));
    mesher.refine_mesh();
  });
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) outcome.triangles += f->is_in_domain();
  return outcome;
}

void compare(const char* name, const polygons::Polygon& polygon, Rows& rows) {
  const polygons::PatchInput input = polygons::patch_input(polygon);
  const PolygonMesh mesh = mesh_of(input);
  std::vector<Kernel::Point_2> seeds;
  for (const polygons::Loop& hole : polygon.holes) seeds.push_back(point_inside(hole));
  Options options;
  options.min_angle_deg = kDegrees;
  std::vector<double> times_of_ours, times_of_theirs;
  Outcome ours, theirs;
  // The two alternate, so that changes in the speed of the machine affect both alike.
  for (int run = 0; run < kRuns; ++run) {
    ours = refine_ours(mesh, options);
    theirs = refine_cgal(input, seeds);
    times_of_ours.push_back(ours.ms);
    times_of_theirs.push_back(theirs.ms);
  }
  ours.ms = median(times_of_ours);
  theirs.ms = median(times_of_theirs);
  std::printf("  %-34s%10zu%12llu%12llu%9.3f%10.3f%10.3f%9.3f\n", name, input.edges.size(),
              static_cast<unsigned long long>(ours.triangles), static_cast<unsigned long long>(theirs.triangles),
              static_cast<double>(ours.triangles) / static_cast<double>(theirs.triangles), ours.ms / 1000,
              theirs.ms / 1000, ours.ms / theirs.ms);
  std::fflush(stdout);
  rows.push_back({"refinement", name, "remesh_surface", input.edges.size(), ours.ms, ours.triangles});
  rows.push_back({"refinement", name, "CGAL Mesh_2", input.edges.size(), theirs.ms, theirs.triangles});
}

/// Prints and returns the time per face of the output, in nanoseconds.
double time_per_face(const char* name, const PolygonMesh& mesh, const Options& options, double of_large_patch,
                     Rows& rows) {
  std::vector<double> times;
  Outcome outcome;
  for (int run = 0; run < kRuns; ++run) {
    outcome = refine_ours(mesh, options);
    times.push_back(outcome.ms);
  }
  outcome.ms = median(times);
  const double time = 1e6 * outcome.ms / static_cast<double>(outcome.triangles);
  rows.push_back({"patches", name, "remesh_surface", mesh.face_count(), outcome.ms, outcome.triangles});
  std::printf("  %-44s%10zu%12llu%12.0f", name, mesh.face_count(), static_cast<unsigned long long>(outcome.triangles),
              time);
  std::printf(of_large_patch > 0 ? "%9.2f\n" : "\n", time / of_large_patch);
  std::fflush(stdout);
  return time;
}

void time_tiny_patches(Rows& rows) {
  std::printf("\ntiny patches beside one large patch, 25 degrees, one core, triangulation and refinement\n");
  std::printf("  %-44s%10s%12s%12s%9s\n", "surface", "faces in", "faces out", "ns a face", "ratio");
  const double large = time_per_face("one patch: plate, 2,500 holes of 12 corners",
                                     mesh_of(polygons::patch_input(plate(50, 12))), {}, 0, rows);
  Options even;
  even.max_edge_length = 1.0 / 256;
  time_per_face("one patch: square, by its largest edge", shapes::sheet(1, 1, 1, 1), even, large, rows);
  time_per_face("patches of 2 triangles, good as they are", facets(354, 354, 1), {}, large, rows);
  time_per_face("patches of 2 triangles, 4 times as wide as high", facets(125, 125, 4), {}, large, rows);
  time_per_face("the same, 250,000 faces in", facets(354, 354, 4), {}, large, rows);
}

}  // namespace

void measure_refinement(Rows& rows) {
  std::printf("\nrefinement to 20.7 degrees, one core, seconds with the triangulation (median of %d)\n", kRuns);
  std::printf("  %-34s%10s%12s%12s%9s%10s%10s%9s\n", "region", "edges", "triangles", "of CGAL", "ratio", "seconds",
              "of CGAL", "ratio");
  compare("star of 100,000 edges, 1,024 holes", smooth_star(100000, 32), rows);
  compare("plate, 400 holes of 24 corners", plate(20, 24), rows);
  compare("plate, 2,500 holes of 12 corners", plate(50, 12), rows);
  compare("comb", polygons::comb(2000, 20), rows);
  time_tiny_patches(rows);
}

}  // namespace remesh::bench
