/// Fixed pieces of work, small enough to run where every instruction is counted: `./dev bench --check`.
/// Usage: remesh_cases NAME does one of them on one thread, remesh_cases --list tells the names, and
/// remesh_cases --write SHAPE FACES writes a mesh of about so many triangles as OBJ for larger measurements;
/// remesh_cases --rate FACES THREADS SECONDS prints how many requests a second to remesh a box are answered without
/// HTTP.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "api/json_reader.h"
#include "api/operations.h"
#include "core/io/obj/obj.h"
#include "core/remesh.h"
#include "core/triangulation/delaunay_divide_conquer.h"
#include "core/triangulation/patch_triangulation.h"
#include "tests/bench/inputs.h"
#include "tests/bench/json_text.h"
#include "tests/support/hostile_solids.h"
#include "tests/support/polygons.h"
#include "tests/support/shapes.h"

namespace remesh::bench {
namespace {

std::string obj_of(const PolygonMesh& mesh) {
  RunControl control;
  return write_obj(shapes::as_triangles(mesh), {}, control);
}

PolygonMesh turned_box(int n) { return shapes::rotated(shapes::box({1, 2, 3}, n), {1, 2, 3}, 30); }
PolygonMesh turned_bracket(int cuts) { return shapes::rotated(shapes::l_bracket(cuts), {1, 2, 3}, 30); }

using Work = std::function<void()>;

void read(const std::string& text) {
  RunControl control;
  (void)read_obj(text, {}, control);
}

Work remeshing(PolygonMesh mesh, bool refine) {
  Options options;
  options.refine = refine;
  return [mesh = std::move(mesh), options] {
    RunControl control;
    (void)remesh_surface(mesh, options, {}, control);
  };
}

struct Case {
  std::string_view name;
  Work (*prepare)();  ///< prepares the work; only running the work is counted
};

const Case kCases[] = {
    {"read_obj", [] { return Work([text = obj_of(turned_box(40))] { read(text); }); }},
    {"read_odd_obj", [] { return Work([text = obj_of(turned_box(20)) + "vn 0 \\\n0 1\n"] { read(text); }); }},
    {"write_obj",
     [] {
       return Work([mesh = shapes::as_triangles(turned_box(40))] {
         RunControl control;
         (void)write_obj(mesh, {}, control);
       });
     }},
    {"read_json",
     [] {
       return Work([text = json_of(shapes::as_triangles(turned_box(40)))] {
         RunControl control;
         api::OptionReader options;
         (void)api::read_json(text, {}, control, options);
       });
     }},
    {"triangulate_points",
     [] {
       return Work([points = polygons::scattered(1, 20'000)] {
         RunControl control;
         (void)delaunay_divide_conquer(points, control);
       });
     }},
    {"triangulate_star",
     [] {
       return Work([input = polygons::patch_input(polygons::star_with_holes(1, 10'000, 10))] {
         RunControl control;
         (void)triangulate_patch(input.points, input.edges, control);
       });
     }},
    {"remesh_box",
     [] {
       return remeshing(shapes::box({1, 2, 3}, 40), false);
     }},
    {"remesh_turned_bracket", [] { return remeshing(turned_bracket(25), false); }},
    {"remesh_sphere", [] { return remeshing(shapes::sphere(5), false); }},
    {"remesh_ball", [] { return remeshing(bumpy_ball(20), false); }},
    {"refine_ball", [] { return remeshing(bumpy_ball(20), true); }},
    {"refine_plate", [] { return remeshing(shapes::plate_with_round_hole(256), true); }},
};

struct LargeShape {
  std::string_view name;
  PolygonMesh (*make)(double faces);
};

int root(double x) { return static_cast<int>(std::sqrt(x)); }

const LargeShape kLargeShapes[] = {
    {"box",
     [](double faces) {
       return shapes::box({1, 2, 3}, root(faces / 12));
     }},
    {"bracket", [](double faces) { return turned_bracket(root(faces / 28)); }},
    {"plate",
     [](double faces) {
       constexpr int kCorners = 24;
       return mesh_of(polygons::patch_input(plate(root(faces / (kCorners + 2)), kCorners)));
     }},
    {"ball", [](double faces) { return bumpy_ball(root(faces / 20)); }},
    {"terrain", [](double faces) { return terrain(root(faces / 2)); }},
    // The surface crosses about 1.5 n^2 cells, and has about twelve triangles in each.
    {"isosurface", [](double faces) { return isosurface(root(faces / 17)); }},
    {"knot", [](double faces) { return knot_tube(root(faces / 50)); }},
    {"enneper", [](double faces) { return enneper_patch(root(faces / 2)); }},
    {"two_boxes",
     [](double faces) {
       const PolygonMesh one = shapes::box({1, 1, 1}, root(faces / 24));
       return shapes::joined(one, shapes::moved(one, {0.5, 0.25, 0.125}));
     }},
};

/// Makes a large shape, or a member of a family of solids that meet.
std::optional<PolygonMesh> make_shape(std::string_view name, double faces) {
  for (const LargeShape& shape : kLargeShapes)
    if (shape.name == name) return shape.make(faces);
  for (const hostile::Family& family : hostile::meeting_families())
    if (family.name == name) return family.make(static_cast<std::size_t>(faces));
  return std::nullopt;
}

/// Runs the work that is measured. Under callgrind, everything within this function is counted (see instructions.py).
[[gnu::noinline]] void run_case(const Work& work) { work(); }

double requests_a_second(double faces, int threads, double seconds) {
  const std::string text = obj_of(shapes::box({1, 2, 3}, static_cast<int>(std::sqrt(faces / 12))));
  api::Request request;
  request.body = text;
  request.query = {{"refine", "false"}};
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::atomic<std::uint64_t> answered = 0;
  std::vector<std::thread> workers;
  for (int t = 0; t < threads; ++t)
    workers.emplace_back([&] {
      tbb::task_arena arena(1);
      for (; elapsed() < seconds; ++answered)
        arena.execute([&] {
          RunControl control;
          (void)api::run_remesh(request, {}, control);
        });
    });
  for (std::thread& worker : workers) worker.join();
  return static_cast<double>(answered) / elapsed();
}

int usage() {
  std::fprintf(stderr,
               "usage: remesh_cases NAME | --list | --write SHAPE FACES | --rate FACES THREADS SECONDS\nshapes:");
  for (const LargeShape& shape : kLargeShapes) std::fprintf(stderr, " %s", std::string(shape.name).c_str());
  for (const hostile::Family& family : hostile::meeting_families())
    std::fprintf(stderr, " %s", std::string(family.name).c_str());
  std::fprintf(stderr, "\n");
  return 2;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && arguments[0] == "--list") {
    for (const Case& c : kCases) std::printf("%s\n", std::string(c.name).c_str());
    return 0;
  }
  if (arguments.size() == 3 && arguments[0] == "--write") {
    const double faces = std::atof(arguments[2].c_str());
    if (!(faces >= 100 && faces <= 1e8)) return usage();
    const std::optional<PolygonMesh> mesh = make_shape(arguments[1], faces);
    if (!mesh) return usage();
    const std::string text = obj_of(*mesh);
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() ? 0 : 1;
  }
  if (arguments.size() == 4 && arguments[0] == "--rate") {
    const double faces = std::atof(arguments[1].c_str()), seconds = std::atof(arguments[3].c_str());
    const int threads = std::atoi(arguments[2].c_str());
    if (!(faces >= 12 && faces <= 1e8 && seconds > 0) || threads < 1) return usage();
    std::printf("%.1f\n", requests_a_second(faces, threads, seconds));
    return 0;
  }
  if (arguments.size() != 1) return usage();
  const auto* found =
      std::find_if(std::begin(kCases), std::end(kCases), [&](const Case& c) { return c.name == arguments[0]; });
  if (found == std::end(kCases)) return usage();
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  tbb::task_arena(1).execute([&] { run_case(found->prepare()); });
  return 0;
}

}  // namespace
}  // namespace remesh::bench

int main(int argc, char** argv) { return remesh::bench::run({argv + 1, argv + argc}); }
