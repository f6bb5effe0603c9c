#include "tests/bench/hostile.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "core/remesh.h"
#include "tests/support/hostile_families.h"
#include "tests/support/hostile_solids.h"

namespace remesh::bench {
namespace {

/// A family is not measured in larger sizes after a run of this many milliseconds.
constexpr double kLongRun = 120'000;
/// Growth with the faces of input and output is told where there are more than this many times as many as in the size
/// before.
constexpr double kMoreFaces = 2;

/// Other programs do not lengthen the time of the processor, and some sizes take minutes.
double processor_milliseconds() { return 1000 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Returns how many bytes the process has had at most since forget_peak, or 0 where the system does not tell.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
  return 0;
}
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// Looks at the progress of a run from a thread of its own, and finds where it stands longest. Time is that of the
/// processor, so other programs do not lengthen it.
class ProgressWatch {
 public:
  explicit ProgressWatch(const RunControl& control) : control_(control), thread_([this] { look(); }) {}
  ~ProgressWatch() {
    is_over_ = true;
    thread_.join();
  }
  ProgressWatch(const ProgressWatch&) = delete;
  ProgressWatch& operator=(const ProgressWatch&) = delete;

  /// Ends the watch. Returns for how many milliseconds progress stood, and in which stage.
  std::pair<double, Stage> longest() {
    is_over_ = true;
    while (!has_ended_) std::this_thread::yield();
    return longest_;
  }

 private:
  void look() {
    auto last = std::pair(control_.stage(), control_.fraction());
    double since = processor_milliseconds();
    while (!is_over_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const auto now = std::pair(control_.stage(), control_.fraction());
      const double ms = processor_milliseconds();
      if (ms - since > longest_.first) longest_ = {ms - since, last.first};
      if (now != last) since = ms;
      last = now;
    }
    has_ended_ = true;
  }

  const RunControl& control_;
  std::atomic<bool> is_over_{false}, has_ended_{false};
  std::pair<double, Stage> longest_{0, Stage::kQueued};
  std::thread thread_;
};

bool is_cut_short(const Report& report) {
  return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                     [](const Diagnostic& d) { return d.code == DiagnosticCode::kIncompleteCheck; });
}

/// Returns by how much a time of `before` grows in a decade of sizes if it becomes `now` from one size to another.
double growth_a_decade(double before, double now, double size_before, double size) {
  return std::pow(now / before, 1 / std::log10(size / size_before));
}

/// Returns what became of faces that meet, in a few letters.
std::string_view fate_of(const Report& report, const Options& options) {
  if (!options.repair.self_intersections && !options.repair.make_union) return {};
  const auto has = [&](DiagnosticCode code) {
    return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                       [&](const Diagnostic& d) { return d.code == code && d.count == 0; });
  };
  if (has(DiagnosticCode::kCutIntersections)) return "not cut";
  if (report.solids && report.solids->left > 0) return "some left";
  return has(DiagnosticCode::kDroppedPieces) ? "not united" : "";
}

void measure_families(std::span<const hostile::Family> families, const Options& options, const std::vector<int>& sizes,
                      int workers, Rows& rows) {
  bool is_any_cut_short = false;
  for (const hostile::Family& family : families) {
    std::printf("  %-22s", std::string(family.name).c_str());
    double before = 0, all_before = 0, bytes_a_face = 0;
    std::pair<double, Stage> longest{0, Stage::kQueued};  // for which progress stood, in any size
    int size_before = 0;
    for (const int size : sizes) {
      if (before > kLongRun) break;
      const PolygonMesh mesh = family.make(static_cast<std::size_t>(size));
      RunControl control;
      Report report;
      forget_peak();
      const double begin = processor_milliseconds();
      ProgressWatch watch(control);
      std::string_view fate;
      try {
        report = remesh_surface(mesh, options, {.workers = workers}, control).report;
        fate = fate_of(report, options);
      } catch (const Error& error) {
        if (error.code != Code::kOutputTooLarge) throw;
        fate = "too large";
      }
      const double ms = processor_milliseconds() - begin;
      if (const auto stood = watch.longest(); stood.first > longest.first) longest = stood;
      const double all = size + static_cast<double>(report.output.faces);
      bytes_a_face = peak_bytes() / all;
      is_any_cut_short = is_any_cut_short || is_cut_short(report);
      std::printf("%11.3f%s", ms / 1000, is_cut_short(report) ? "*" : " ");
      if (before > 0)
        std::printf(" x%-6.1f", growth_a_decade(before, ms, size_before, size));
      else
        std::printf("%8s", "");
      if (before > 0 && all > kMoreFaces * all_before)
        std::printf("x%-5.1f", growth_a_decade(before, ms, all_before, all));
      else
        std::printf("%6s", "");
      if (!fate.empty()) std::printf(" (%s)", std::string(fate).c_str());
      std::fflush(stdout);
      rows.push_back({"hostile", std::string(family.name), "total", static_cast<std::uint64_t>(size), ms,
                      static_cast<std::uint64_t>(report.output.faces)});
      before = ms;
      all_before = all;
      size_before = size;
    }
    std::printf("%8.0f bytes a face; progress stood for %.1f s in %s%s\n", bytes_a_face, longest.first / 1000,
                std::string(stage_name(longest.second)).c_str(),
                family.answer == hostile::Answer::kQuadratic ? "  a large share of all pairs meet" : "");
  }
  if (is_any_cut_short) std::printf("  * the search for intersections was cut short\n");
}

}  // namespace

void measure_hostile(const std::vector<int>& sizes, int workers, Rows& rows) {
  std::printf("\nseconds, and their growth in a decade: of the input, and of input and output\n%-24s", "");
  for (const int size : sizes) std::printf("%26d", size);
  std::printf("\n");
  measure_families(hostile::families(), Options{}, sizes, workers, rows);
  std::printf("\nthe same with repair=union, of solids and sheets that meet\n");
  Options uniting;
  uniting.repair.self_intersections = true;
  uniting.repair.make_union = true;
  measure_families(hostile::meeting_families(), uniting, sizes, workers, rows);
}

}  // namespace remesh::bench
