#include "tests/bench/hostile.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>

#include "core/remesh.h"
#include "tests/bench/timing.h"
#include "tests/support/hostile_families.h"

namespace remesh::bench {
namespace {

/// A family is not measured in larger sizes after a run of this many milliseconds.
constexpr double kLongRun = 300'000;

bool is_cut_short(const Report& report) {
  return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                     [](const Diagnostic& d) { return d.code == DiagnosticCode::kIncompleteCheck; });
}

}  // namespace

void measure_hostile(const std::vector<int>& sizes, int workers, Rows& rows) {
  std::printf("\n%-24s", "seconds, and growth");
  for (const int size : sizes) std::printf("%20d", size);
  std::printf("\n");
  bool is_any_cut_short = false;
  for (const hostile::Family& family : hostile::families()) {
    std::printf("  %-22s", std::string(family.name).c_str());
    double before = 0;
    for (const int size : sizes) {
      if (before > kLongRun) break;
      const PolygonMesh mesh = family.make(static_cast<std::size_t>(size));
      RunControl control;
      Report report;
      const double ms =
          milliseconds([&] { report = remesh_surface(mesh, Options{}, {.workers = workers}, control).report; });
      is_any_cut_short = is_any_cut_short || is_cut_short(report);
      std::printf("%11.3f%s", ms / 1000, is_cut_short(report) ? "*" : " ");
      if (before > 0)
        std::printf(" x%-6.1f", ms / before);
      else
        std::printf("%8s", "");
      std::fflush(stdout);
      rows.push_back({"hostile", std::string(family.name), "total", static_cast<std::uint64_t>(size), ms,
                      static_cast<std::uint64_t>(report.output.faces)});
      before = ms;
    }
    std::printf("%s\n", family.answer == hostile::Answer::kQuadratic ? "  a large share of all pairs meet" : "");
  }
  if (is_any_cut_short) std::printf("  * the search for intersections was cut short\n");
}

}  // namespace remesh::bench
