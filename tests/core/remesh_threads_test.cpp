/// Tests the threads of a run: how many there are, and what is left of them.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>

#include "core/remesh.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

TEST(thread_count, one_thread_takes_a_small_input_that_is_not_refined) {
  const tbb::global_control eight(tbb::global_control::max_allowed_parallelism, 8);
  const PolygonMesh mesh = shapes::box({1, 2, 3}, 10);
  const std::size_t corners = mesh.corners.size();
  const auto count = [&](std::size_t serial_corners, bool refine, int workers = 6) {
    Options options;
    options.refine = refine;
    return thread_count(mesh, options, {workers, false, serial_corners});
  };
  EXPECT_EQ(count(corners + 1, false), 1);
  EXPECT_EQ(count(corners, false), 6);
  EXPECT_EQ(count(0, false), 6);
  EXPECT_EQ(count(0, false, 100), 8) << "more than the process has";
  EXPECT_EQ(count(corners + 1, true), 6) << "what is refined may become large";
}

/// Returns how much memory of this process is resident, in MiB.
double resident_mib() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

TEST(remesh, run_after_run_takes_no_more_memory) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer keeps what is freed";
  const PolygonMesh box = shapes::box({1, 1, 1});
  // As many threads as a loop of the caller would have anyway, and some others, whatever the machine has.
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
  for (const int workers : {2, 3, 4}) {
    const auto run = [&](int times) {
      for (int i = 0; i < times; ++i) {
        RunControl control;
        remesh_surface(box, Options{}, {workers, false}, control);
      }
    };
    run(500);
    const double before = resident_mib();
    run(2000);
    EXPECT_LT(resident_mib(), before + 2) << workers << " workers, from " << before << " MiB";
  }
}

}  // namespace
}  // namespace remesh
