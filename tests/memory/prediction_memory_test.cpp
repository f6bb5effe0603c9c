/// Tests how much memory the close prediction holds.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "core/refinement/prediction/prediction.h"
#include "core/remesh.h"
#include "tests/memory/counted_new.h"
#include "tests/support/hostile_families.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

std::atomic<std::int64_t> held, peak;

void count(std::int64_t bytes) {
  const std::int64_t now = held.fetch_add(bytes) + bytes;
  for (std::int64_t before = peak; now > before && !peak.compare_exchange_weak(before, now);) continue;
}

/// Returns the largest number of bytes that are held at once while something is done.
template <class Work>
double peak_of(const Work& work) {
  held = peak = 0;
  memory::tell_allocations(count);
  work();
  memory::tell_allocations(nullptr);
  return static_cast<double>(peak);
}

/// These are the bytes of a prediction alone. What it adds to the peak of a run is less, and is not tested.
TEST(prediction_memory, the_close_prediction_holds_some_hundred_bytes_a_triangle) {
  constexpr double kMaxBytes = 800;
  const int n = unless_sanitized(12, 4);
  const auto size = static_cast<std::size_t>(100 * n);
  const std::vector<std::pair<std::string, PolygonMesh>> surfaces{
      {"box", shapes::box({1, 2, 3}, n)},
      {"cylinder", shapes::cylinder(40 * n, 1, 2)},
      {"sphere", shapes::sphere(4)},
      {"plate with a round hole", shapes::plate_with_round_hole(20 * n)},
      {"needles", hostile::family("parallel_needles").make(size)},
      {"fan", hostile::family("fan_around_a_vertex").make(size)}};
  for (const auto& surface : surfaces) {
    const std::string& name = surface.first;
    const PolygonMesh& mesh = surface.second;
    StageChain chain(mesh);
    const Goals goals = goals_of(Options{}, 1);
    const double of_prediction =
        peak_of([&] { predict_closely(chain.triangulated, goals, SizeField(goals.max_edge_length), chain.control); });
    const double of_run = peak_of([&] {
      RunControl control;
      remesh_surface(mesh, Options{}, RunSettings{.workers = 1}, control);
    });
    const auto triangles = static_cast<double>(chain.triangulated.triangle_count());
    std::printf("  %-24s %3.0f bytes a triangle, where the run holds %.0f\n", name.c_str(), of_prediction / triangles,
                of_run / triangles);
    EXPECT_LT(of_prediction, kMaxBytes * triangles) << name;
  }
}

}  // namespace
}  // namespace remesh
