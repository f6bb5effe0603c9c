/// Prints how the time of triangulating and of remeshing grows with the size of the input, beside CGAL's.
/// Usage: remesh_bench [max_size [workers]]; sizes are the decades from 10,000 to max_size (1,000,000).
/// Every time is the median of three runs, in milliseconds; the factor behind it is the growth over one decade.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/delaunay_divide_conquer.h"
#include "core/remesh.h"
#include "core/stages/delaunay_flips.h"
#include "core/stages/lexicographic_triangulation.h"
#include "core/stages/patch_triangulation.h"
#include "tests/support/polygons.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int kRuns = 3;
constexpr int kSweepLimit = 100000;  // on grids it takes minutes above

template <class Work>
double milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

template <class Work>
double median_milliseconds(const Work& work) {
  std::vector<double> times;
  for (int run = 0; run < kRuns; ++run) times.push_back(milliseconds(work));
  return median(std::move(times));
}

/// One line per thing that was measured, one column per size.
class Table {
 public:
  Table(std::string title, std::vector<int> sizes) : title_(std::move(title)), sizes_(std::move(sizes)) {}

  /// The next column's time of this line.
  void add(const std::string& name, double ms) {
    auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name == name; });
    if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{name, {}});
    line->times.push_back(ms);
  }

  void print() const {
    std::printf("\n%-28s", title_.c_str());
    for (const int size : sizes_) std::printf("%19d", size);
    std::printf("\n");
    for (const Line& line : lines_) {
      std::printf("  %-26s", line.name.c_str());
      for (std::size_t i = 0; i < line.times.size(); ++i) {
        std::printf("%11.2f", line.times[i]);
        if (i > 0 && line.times[i - 1] > 0)
          std::printf(" x%-6.1f", line.times[i] / line.times[i - 1]);
        else
          std::printf("%8s", "");
      }
      std::printf("\n");
    }
  }

 private:
  struct Line {
    std::string name;
    std::vector<double> times;
  };
  std::string title_;
  std::vector<int> sizes_;
  std::vector<Line> lines_;
};

void measure_points(const std::string& title, const std::vector<int>& sizes, std::vector<Vec2> (*make)(int)) {
  RunControl control;
  Table table(title, sizes);
  for (const int size : sizes) {
    const std::vector<Vec2> points = make(size);
    std::vector<Kernel::Point_2> cgal_points;
    for (const Vec2 p : points) cgal_points.emplace_back(p.x, p.y);
    // CGAL orders its points itself, and the order in which it gets them must not help: both begin with them shuffled.
    Random random(1);
    std::vector<Vec2> shuffled = points;
    for (std::size_t i = points.size() - 1; i > 0; --i) {
      const std::size_t j = random.bits() % (i + 1);
      std::swap(shuffled[i], shuffled[j]);
      std::swap(cgal_points[i], cgal_points[j]);
    }
    table.add("sorting", median_milliseconds([&] {
                std::vector<Vec2> copy = shuffled;
                std::sort(copy.begin(), copy.end());
              }));
    table.add("triangulate_points", median_milliseconds([&] { triangulate_points(points, control); }));
    table.add("divide and conquer", median_milliseconds([&] { delaunay_divide_conquer(points, control); }));
    table.add("CGAL, its sorting included", median_milliseconds([&] {
                const CGAL::Delaunay_triangulation_2<Kernel> mesh(cgal_points.begin(), cgal_points.end());
              }));
    if (size > kSweepLimit) continue;
    table.add("sweep and flips", median_milliseconds([&] {
                Triangulation2d mesh = lexicographic_triangulation(points, control);
                delaunay_flips(points, mesh, control);
              }));
  }
  table.print();
}

void measure_polygons(const std::string& title, const std::vector<int>& sizes, polygons::Polygon (*make)(int)) {
  using Structure = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Kernel>,
                                                         CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  RunControl control;
  Table table(title, sizes);
  for (const int size : sizes) {
    const polygons::PatchInput input = polygons::patch_input(make(size));
    std::vector<Kernel::Point_2> cgal_points;
    for (const Vec2 p : input.points) cgal_points.emplace_back(p.x, p.y);
    std::vector<std::pair<std::size_t, std::size_t>> cgal_edges;
    for (const Segment& edge : input.edges) cgal_edges.emplace_back(edge[0], edge[1]);
    table.add("triangulate_patch", median_milliseconds([&] { triangulate_patch(input.points, input.edges, control); }));
    table.add("CGAL, without carving", median_milliseconds([&] {
                CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure> mesh;
                mesh.insert_constraints(cgal_points.begin(), cgal_points.end(), cgal_edges.begin(), cgal_edges.end());
              }));
  }
  table.print();
}

void measure_surfaces(const std::string& title, const std::vector<int>& sizes, int workers, PolygonMesh (*make)(int)) {
  const RunSettings settings{.workers = workers};
  Table table(title, sizes);
  for (const int size : sizes) {
    const PolygonMesh mesh = make(size);
    std::vector<double> totals;
    std::vector<std::pair<Stage, std::vector<double>>> stages;
    for (int run = 0; run < kRuns; ++run) {
      RunControl control;
      Report report;
      totals.push_back(milliseconds([&] { report = remesh_surface(mesh, Options{}, settings, control).report; }));
      for (const StageTime& time : report.timing_ms) {
        auto stage = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.first == time.stage; });
        if (stage == stages.end()) stage = stages.insert(stages.end(), {time.stage, {}});
        stage->second.push_back(time.ms);
      }
    }
    for (auto& [stage, times] : stages) table.add(std::string(stage_name(stage)), median(std::move(times)));
    table.add("total", median(std::move(totals)));
  }
  table.print();
}

std::vector<Vec2> scattered(int size) { return polygons::scattered(1, size); }
std::vector<Vec2> square_grid(int size) {
  const int side = static_cast<int>(std::sqrt(size));
  return polygons::grid(side, side);
}
std::vector<Vec2> circle(int size) { return polygons::nearly_cocircular(size); }

polygons::Polygon sieve(int size) { return polygons::sieve(static_cast<int>(std::sqrt(size / 4))); }
polygons::Polygon comb(int size) { return polygons::comb(size / 4, 100); }
polygons::Polygon star(int size) { return polygons::star_with_holes(1, size, 10); }

PolygonMesh box(int size) { return shapes::box({1, 2, 3}, static_cast<int>(std::sqrt(size / 12))); }
PolygonMesh turned_box(int size) { return shapes::rotated(box(size), {1, 2, 3}, 30); }
/// Every face a patch of its own. Faces come in powers of four, so the growth of a decade is not tenfold: 8192, 131072
/// and 524288 stand for the first three.
PolygonMesh sphere(int size) {
  int levels = 0;
  for (int faces = 8; faces * 2 < size; faces *= 4) ++levels;
  return shapes::sphere(levels);
}

void run(int max_size, int workers) {
  std::vector<int> sizes;
  for (int size = 10000; size <= max_size; size *= 10) sizes.push_back(size);

  tbb::task_arena(workers).execute([&] {
    measure_points("scattered points", sizes, scattered);
    measure_points("square grid of points", sizes, square_grid);
    measure_points("points on a circle", sizes, circle);
    measure_polygons("corners of a sieve", sizes, sieve);
    measure_polygons("corners of a comb", sizes, comb);
    measure_polygons("corners of a star", sizes, star);
  });
  measure_surfaces("faces of a box", sizes, workers, box);
  measure_surfaces("faces of a turned box", sizes, workers, turned_box);
  measure_surfaces("faces of a sphere", sizes, workers, sphere);
}

}  // namespace
}  // namespace remesh

int main(int argc, char** argv) {
  const int max_size = argc > 1 ? std::atoi(argv[1]) : 1000000;
  const int workers = argc > 2 ? std::atoi(argv[2]) : 1;
  if (max_size < 10000 || max_size > 100000000 || workers < 1) {
    std::fprintf(stderr, "usage: remesh_bench [max_size of at least 10000 [workers]]\n");
    return 1;
  }
  remesh::run(max_size, workers);
  return 0;
}
