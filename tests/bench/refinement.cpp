/// Refinement beside CGAL's Mesh_2, on the same planar regions and for the same bound.
#include "tests/bench/refinement.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "core/remesh.h"
#include "core/stages/patch_triangulation.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// CGAL's bound: its criterion 0.125 is the squared sine of the angle... of half the ratio's inverse: 20.7 degrees.
constexpr double kCgalBound = 0.125;
constexpr double kDegrees = 20.705;
constexpr int kRuns = 3;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

struct Outcome {
  double seconds = 0;
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

/// Triangulation and refinement of the patch, one thread.
Outcome refine_ours(const PolygonMesh& mesh) {
  Options options;
  options.refine = true;
  options.min_angle_deg = kDegrees;
  RunControl control;
  const Result result = remesh_surface(mesh, options, {}, control);
  Outcome outcome;
  for (const StageTime& time : result.report.timing_ms)
    if (time.stage == Stage::kTriangulation || time.stage == Stage::kRefinement) outcome.seconds += time.ms / 1000;
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
  const auto start = Clock::now();
  Cdt cdt;
  cdt.insert_constraints(points.begin(), points.end(), edges.begin(), edges.end());
  CGAL::Delaunay_mesher_2<Cdt, CGAL::Delaunay_mesh_size_criteria_2<Cdt>> mesher(cdt);
  mesher.set_seeds(seeds.begin(), seeds.end(), false);
  mesher.set_criteria(CGAL::Delaunay_mesh_size_criteria_2<Cdt>(kCgalBound, 0));
  mesher.refine_mesh();
  Outcome outcome{seconds_since(start), 0};
  for (auto f = cdt.finite_faces_begin(); f != cdt.finite_faces_end(); ++f) outcome.triangles += f->is_in_domain();
  return outcome;
}

void compare(const char* name, const polygons::Polygon& polygon) {
  const polygons::PatchInput input = polygons::patch_input(polygon);
  const PolygonMesh mesh = mesh_of(input);
  std::vector<Kernel::Point_2> seeds;
  for (const polygons::Loop& hole : polygon.holes) seeds.push_back(point_inside(hole));
  std::vector<double> ours, theirs;
  Outcome a, b;
  // Alternating, so that both see the same moods of the machine.
  for (int run = 0; run < kRuns; ++run) {
    a = refine_ours(mesh);
    b = refine_cgal(input, seeds);
    ours.push_back(a.seconds);
    theirs.push_back(b.seconds);
  }
  std::printf("  %-34s%10zu%12llu%12llu%9.3f%10.3f%10.3f%9.3f\n", name, input.edges.size(),
              static_cast<unsigned long long>(a.triangles), static_cast<unsigned long long>(b.triangles),
              static_cast<double>(a.triangles) / static_cast<double>(b.triangles), median(ours), median(theirs),
              median(ours) / median(theirs));
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
        hole.push_back({on_grid(centre.x + x + (x > 0 ? stretch : -stretch)), on_grid(centre.y + radius * std::sin(angle))});
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

void time_tiny_patches() {
  // The same area in patches of two triangles and in six large ones.
  const auto per_face = [](const PolygonMesh& mesh, double min_angle_deg) {
    std::vector<double> times;
    for (int run = 0; run < kRuns; ++run) {
      Options options;
      options.refine = true;
      options.min_angle_deg = min_angle_deg;
      RunControl control;
      const Result result = remesh_surface(mesh, options, {}, control);
      double ms = 0;
      for (const StageTime& time : result.report.timing_ms)
        if (time.stage == Stage::kTriangulation || time.stage == Stage::kRefinement) ms += time.ms;
      times.push_back(1e6 * ms / static_cast<double>(result.mesh.faces.size()));
    }
    return median(times);
  };
  (void)per_face;
}

}  // namespace

void bench_refinement() {
  std::printf("\nrefinement to 20.7 degrees, one core, seconds with the triangulation (median of %d)\n", kRuns);
  std::printf("  %-34s%10s%12s%12s%9s%10s%10s%9s\n", "region", "edges", "triangles", "of CGAL", "ratio", "seconds",
              "of CGAL", "ratio");
  compare("star of 100,000 edges, 1,024 holes", smooth_star(100000, 32));
  compare("plate, 400 holes of 24 corners", plate(20, 24));
  compare("plate, 2,500 holes of 12 corners", plate(50, 12));
  compare("comb", polygons::comb(2000, 20));
  time_tiny_patches();
}

}  // namespace remesh
