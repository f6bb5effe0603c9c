/// Prints how the time of triangulating polygons grows with the size of the input, beside CGAL's, and what
/// refinement makes of regions of one size, beside CGAL's, too. The part `hostile` shows the growth on surfaces that
/// are made to keep a core busy, each size once; it runs only if it is asked for.
/// Usage: remesh_bench [--only PART] [--json FILE] [max_size [workers]]; sizes are the decades from 10,000 to max_size
/// (1,000,000). Every time is the median of three runs, in milliseconds; the factor behind it is the growth over one
/// decade. The file gets the same figures as a list of flat objects (rows.h).
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <malloc.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/triangulation/patch_triangulation.h"
#include "tests/bench/hostile.h"
#include "tests/bench/inputs.h"
#include "tests/bench/refinement.h"
#include "tests/bench/rows.h"
#include "tests/bench/timing.h"
#include "tests/support/polygons.h"

namespace remesh::bench {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// A table with one line per thing that is measured and one column per size. All times are also added to the rows.
class Table {
 public:
  Table(std::string part, std::string title, std::vector<int> sizes, Rows& rows)
      : part_(std::move(part)), title_(std::move(title)), sizes_(std::move(sizes)), rows_(rows) {}

  /// Measures the works, and adds their medians as the next column of their lines.
  void measure(const std::vector<NamedWork>& works) {
    const std::vector<double> medians = median_milliseconds(works);
    for (std::size_t w = 0; w < works.size(); ++w) add(works[w].name, medians[w]);
  }

  /// Adds a time as the next column of the line with this name.
  void add(const std::string& name, double ms) {
    auto line = std::find_if(lines_.begin(), lines_.end(), [&](const Line& l) { return l.name == name; });
    if (line == lines_.end()) line = lines_.insert(lines_.end(), Line{name, {}});
    rows_.push_back({part_, title_, name, static_cast<std::uint64_t>(sizes_[line->times.size()]), ms});
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
    std::fflush(stdout);
  }

 private:
  struct Line {
    std::string name;
    std::vector<double> times;
  };
  std::string part_;
  std::string title_;
  std::vector<int> sizes_;
  Rows& rows_;
  std::vector<Line> lines_;
};

void measure_polygons(const std::string& title, const std::vector<int>& sizes, polygons::Polygon (*make)(int),
                      Rows& rows) {
  using Structure = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Kernel>,
                                                         CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  RunControl control;
  Table table("polygons", title, sizes, rows);
  for (const int size : sizes) {
    const polygons::PatchInput input = polygons::patch_input(make(size));
    std::vector<Kernel::Point_2> cgal_points;
    for (const Vec2 p : input.points) cgal_points.emplace_back(p.x, p.y);
    std::vector<std::pair<std::size_t, std::size_t>> cgal_edges;
    for (const Segment& edge : input.edges) cgal_edges.emplace_back(edge[0], edge[1]);
    table.measure({
        {"triangulate_patch", [&] { triangulate_patch(input.points, input.edges, control); }},
        {"CGAL, without carving",
         [&] {
           CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure> mesh;
           mesh.insert_constraints(cgal_points.begin(), cgal_points.end(), cgal_edges.begin(), cgal_edges.end());
         }},
    });
  }
  table.print();
}

polygons::Polygon sieve(int size) { return polygons::sieve(static_cast<int>(std::sqrt(size / 4))); }
polygons::Polygon comb(int size) { return polygons::comb(size / 4, 100); }
/// Makes a star with about one hole per hundred corners.
polygons::Polygon star(int size) {
  return polygons::star_with_holes(1, size, static_cast<int>(1.2 * std::sqrt(size / 100)));
}
polygons::Polygon round_star(int size) {
  return smooth_star(size, static_cast<int>(std::lround(std::sqrt(size / 100))));
}

struct Part {
  std::string_view name;
  std::function<void(const std::vector<int>& sizes, int workers, Rows& rows)> run;
};

const std::vector<Part>& parts() {
  static const std::vector<Part> all{
      {"polygons",
       [](const std::vector<int>& sizes, int workers, Rows& rows) {
         tbb::task_arena(workers).execute([&] {
           measure_polygons("corners of a sieve", sizes, sieve, rows);
           measure_polygons("corners of a comb", sizes, comb, rows);
           measure_polygons("corners of a spiky star", sizes, star, rows);
           measure_polygons("corners of a star", sizes, round_star, rows);
         });
       }},
      {"refinement", [](const std::vector<int>&, int, Rows& rows) { measure_refinement(rows); }},
      {"hostile",
       [](const std::vector<int>& sizes, int workers, Rows& rows) {
         // No family may take a minute for 200,000 faces.
         std::vector<int> from_a_thousand{1000};
         for (const int size : sizes) {
           from_a_thousand.push_back(size);
           if (size == 100'000) from_a_thousand.push_back(200'000);
         }
         measure_hostile(from_a_thousand, workers, rows);
       }},
  };
  return all;
}

/// This part takes minutes.
constexpr std::string_view kOnlyIfAsked = "hostile";

int usage() {
  std::fprintf(stderr,
               "usage: remesh_bench [--only PART] [--json FILE] [max_size of at least 10000 [workers]]\nparts:");
  for (const Part& part : parts()) std::fprintf(stderr, " %s", std::string(part.name).c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

int run(std::vector<std::string> arguments) {
  std::string only, json;
  while (!arguments.empty() && arguments[0].starts_with("--")) {
    if (arguments.size() < 2 || (arguments[0] != "--only" && arguments[0] != "--json")) return usage();
    (arguments[0] == "--only" ? only : json) = arguments[1];
    arguments.erase(arguments.begin(), arguments.begin() + 2);
  }
  if (!only.empty() &&
      std::none_of(parts().begin(), parts().end(), [&](const Part& part) { return part.name == only; }))
    return usage();
  const int max_size = arguments.empty() ? 1000000 : std::atoi(arguments[0].c_str());
  const int workers = arguments.size() < 2 ? 1 : std::atoi(arguments[1].c_str());
  if (arguments.size() > 2 || max_size < 10000 || max_size > 100000000 || workers < 1) return usage();
  std::vector<int> sizes;
  for (int size = 10000; size <= max_size; size *= 10) sizes.push_back(size);
  Rows rows;
  for (const Part& part : parts())
    if (only.empty() ? part.name != kOnlyIfAsked : part.name == only) part.run(sizes, workers, rows);
  if (json.empty()) return 0;
  std::ofstream file(json, std::ios::binary);
  file << json_of(rows);
  return file.flush() ? 0 : 1;
}

}  // namespace
}  // namespace remesh::bench

int main(int argc, char** argv) {
  // These settings are those of the command `remesh`, and they hold for us and for the peers. Without them, each run
  // would give its memory back, and the next one would fetch it again, page by page.
  mallopt(M_MMAP_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  return remesh::bench::run({argv + 1, argv + argc});
}
