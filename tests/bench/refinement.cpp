#include "tests/bench/refinement.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "core/remesh.h"
#include "core/stages/patch_triangulation.h"
#include "tests/bench/timing.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh::bench {
namespace {

/// CGAL's bound is a squared sine: 20.7 degrees. Ours is a little higher.
constexpr double kCgalBound = 0.125;
constexpr double kDegrees = 20.705;

struct Outcome {
  double ms = 0;  ///< of triangulation and refinement; of three runs the one in the middle
  std::uint64_t triangles = 0;
};

/// A region as a mesh of its constrained Delaunay triangles: what our pipeline takes.
PolygonMesh mesh_of(const polygons::PatchInput& input) {
  RunControl control;
  const PatchTriangulation made = triangulate_patch(input.points, input.edges, control);
  PolygonMesh mesh;
  for (const Vec2 p : input.points) mesh.positions.push_back({p.x, p.y, 0});
  for (std::uint32_t h = 0; h < made.mesh.half_edge_count(); h += 3) {
    for (std::uint32_t k = 0; k < 3; ++k) mesh.corners.push_back(VertexId(made.mesh.from(h + k)));
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  }
  return mesh;
}

/// One run on one thread.
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

/// A point inside a loop.
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

void compare(const char* name, const polygons::Polygon& polygon) {
  const polygons::PatchInput input = polygons::patch_input(polygon);
  const PolygonMesh mesh = mesh_of(input);
  std::vector<Kernel::Point_2> seeds;
  for (const polygons::Loop& hole : polygon.holes) seeds.push_back(point_inside(hole));
  Options options;
  options.min_angle_deg = kDegrees;
  std::vector<double> times_of_ours, times_of_theirs;
  Outcome ours, theirs;
  // Alternating, so that both see the same moods of the machine.
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
}

/// A plate 4 by 3 with round holes of many corners, and slots: what CAD packages cut.
polygons::Polygon plate(int holes_a_side, int corners) {
  polygons::Polygon plate;
  plate.outer = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  const double cell_x = 4.0 / holes_a_side, cell_y = 3.0 / holes_a_side;
  const auto on_grid = [](double x) { return std::nearbyint(x * 0x1p40) * 0x1p-40; };
  for (int i = 0; i < holes_a_side; ++i)
    for (int j = 0; j < holes_a_side; ++j) {
      const Vec2 centre{(i + 0.5) * cell_x, (j + 0.5) * cell_y};
      // Radii differ; every third hole is a slot.
      const double radius = cell_y * (0.1 + 0.03 * ((7 * i + 3 * j) % 8));
      const double stretch = (i + j) % 3 == 0 ? cell_x * 0.15 : 0;
      polygons::Loop hole;
      for (int k = 0; k < corners; ++k) {
        const double angle = -2 * std::numbers::pi * (k + 0.5) / corners;
        const double x = radius * std::cos(angle);
        hole.push_back(
            {on_grid(centre.x + x + (x > 0 ? stretch : -stretch)), on_grid(centre.y + radius * std::sin(angle))});
      }
      plate.holes.push_back(std::move(hole));
    }
  return plate;
}

/// A star with round tips of that many corners, each off the curve by a little, and square holes in rows: what is large
/// and has no sharp angles, at which CGAL would not end.
polygons::Polygon smooth_star(int corners, int holes_a_side) {
  const auto on_grid = [](Vec2 p) {
    return Vec2{std::nearbyint(p.x * 0x1p40) * 0x1p-40, std::nearbyint(p.y * 0x1p40) * 0x1p-40};
  };
  Random random(7);
  polygons::Polygon star;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    const double radius = 0.8 + 0.15 * std::cos(7 * angle) + random.uniform(0, 1.5) / corners;
    star.outer.push_back(on_grid({radius * std::cos(angle), radius * std::sin(angle)}));
  }
  const double cell = 0.8 / holes_a_side;
  for (int i = 0; i < holes_a_side; ++i)
    for (int j = 0; j < holes_a_side; ++j) {
      const Vec2 centre{-0.4 + (i + 0.5) * cell, -0.4 + (j + 0.5) * cell};
      const double turn = random.uniform(0, 1), radius = cell * random.uniform(0.1, 0.4);
      polygons::Loop hole;
      for (int k = 0; k < 4; ++k) {
        const double angle = turn - std::numbers::pi / 2 * k;
        hole.push_back(on_grid(centre + radius * Vec2{std::cos(angle), std::sin(angle)}));
      }
      star.holes.push_back(std::move(hole));
    }
  return star;
}

/// nx x ny parallelograms of two triangles, `width` x 1 seen from above, over which the surface goes up and down so
/// that no two beside each other have one plane: z is a sum of one height a column and one a row.
PolygonMesh facets(int nx, int ny, double width) {
  Random random(11);
  const auto zigzag = [&](int n, double length) {
    std::vector<double> heights;
    for (int i = 0; i <= n; ++i) heights.push_back(length * (i % 2 == 0 ? 0.25 : 0) + random.integer(1, 200) * 0x1p-11);
    return heights;
  };
  const std::vector<double> of_column = zigzag(nx, width), of_row = zigzag(ny, 1);
  PolygonMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) mesh.positions.push_back({i * width, 1.0 * j, of_column[i] + of_row[j]});
  const auto vertex = [&](int i, int j) { return VertexId(static_cast<std::uint32_t>(j * (nx + 1) + i)); };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      for (const auto& [b, c] :
           {std::pair(vertex(i + 1, j), vertex(i + 1, j + 1)), std::pair(vertex(i + 1, j + 1), vertex(i, j + 1))}) {
        for (const VertexId v : {vertex(i, j), b, c}) mesh.corners.push_back(v);
        mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
      }
  return mesh;
}

/// Prints the time per face of the output; returns it, in nanoseconds.
double time_per_face(const char* name, const PolygonMesh& mesh, const Options& options, double of_large_patch) {
  std::vector<double> times;
  Outcome outcome;
  for (int run = 0; run < kRuns; ++run) {
    outcome = refine_ours(mesh, options);
    times.push_back(1e6 * outcome.ms / static_cast<double>(outcome.triangles));
  }
  const double time = median(times);
  std::printf("  %-44s%10zu%12llu%12.0f", name, mesh.face_count(), static_cast<unsigned long long>(outcome.triangles),
              time);
  std::printf(of_large_patch > 0 ? "%9.2f\n" : "\n", time / of_large_patch);
  std::fflush(stdout);
  return time;
}

void time_tiny_patches() {
  std::printf("\ntiny patches beside one large patch, 25 degrees, one core, triangulation and refinement\n");
  std::printf("  %-44s%10s%12s%12s%9s\n", "surface", "faces in", "faces out", "ns a face", "ratio");
  const double large = time_per_face("one patch: plate, 2,500 holes of 12 corners",
                                     mesh_of(polygons::patch_input(plate(50, 12))), {}, 0);
  Options even;
  even.max_edge_length = 1.0 / 256;
  time_per_face("one patch: square, by its largest edge", shapes::sheet(1, 1, 1, 1), even, large);
  time_per_face("patches of 2 triangles, good as they are", facets(354, 354, 1), {}, large);
  time_per_face("patches of 2 triangles, 4 times as wide as high", facets(125, 125, 4), {}, large);
  time_per_face("the same, 250,000 faces in", facets(354, 354, 4), {}, large);
}

}  // namespace

void measure_refinement() {
  std::printf("\nrefinement to 20.7 degrees, one core, seconds with the triangulation (median of %d)\n", kRuns);
  std::printf("  %-34s%10s%12s%12s%9s%10s%10s%9s\n", "region", "edges", "triangles", "of CGAL", "ratio", "seconds",
              "of CGAL", "ratio");
  compare("star of 100,000 edges, 1,024 holes", smooth_star(100000, 32));
  compare("plate, 400 holes of 24 corners", plate(20, 24));
  compare("plate, 2,500 holes of 12 corners", plate(50, 12));
  compare("comb", polygons::comb(2000, 20));
  time_tiny_patches();
}

}  // namespace remesh::bench
