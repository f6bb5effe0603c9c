// Cuts and unites solids that are less or a little more than the plane tolerance apart: with gaps, overlaps and tilts,
// parts that are moved at random, and coordinates that are rounded. `./dev solids near` runs it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/intersections/self_intersections.h"
#include "tests/solids/solid_measures.h"
#include "tests/solids/solid_rows.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

using Parts = std::vector<PolygonMesh>;

/// A fault is what may be wrong with a run. Thin triangles are counted, but are no failure where parts are moved by
/// about the tolerance: there, some features are joined and others are not.
enum Fault { kRefused, kPairs, kThin, kMoved, kOpen, kTriangles, kPieces, kVolume, kFaults };
constexpr std::array<const char*, kFaults> kNames{"refused", "pairs",     "thin",   "moved",
                                                  "open",    "triangles", "pieces", "volume"};

/// These are the known figures of a union. Numbers below 0 are not known.
struct Known {
  double volume = -1;
  double off = 0;  ///< how far the volume may be off, but for what points have moved
  long shells = -1, triangles = -1;
};

Options options_for(bool is_union) {
  Options options = unrefined();
  options.repair.self_intersections = true;
  options.repair.make_union = is_union;
  return options;
}

double tolerance_of(const Parts& parts) { return remeshed(as_one(parts), unrefined()).report.first_plane_tolerance; }

/// Counts the runs of a family for one value that have each fault.
class Judge {
 public:
  explicit Judge(bool is_told) : is_told_(is_told) {}

  /// Input: `known` is of the union, and `triangles` the number of triangles of the arrangement.
  void run(const Parts& parts, const Known& known, long triangles = -1, bool may_be_thin = false) {
    for (const bool is_union : {false, true}) {
      std::array<bool, kFaults> is_faulty{};
      std::string said;
      try {
        const Result result = remeshed(as_one(parts), options_for(is_union));
        look(result, is_union, is_faulty);
        const long faces = static_cast<long>(result.mesh.faces.size());
        const long expected = is_union ? known.triangles : triangles;
        is_faulty[kTriangles] = expected >= 0 && faces != expected;
        if (is_union) hold_against(known, result, is_faulty);
        for (const Diagnostic& told : result.report.diagnostics)
          if (told.count == 0) {
            is_faulty[kRefused] = true;
            said = told.message;
          }
      } catch (const Error& error) {
        is_faulty[kRefused] = true;
        said = error.what();
      }
      ++runs_;
      bool is_any = false;
      for (int i = 0; i < kFaults; ++i) {
        count_[static_cast<std::size_t>(i)] += is_faulty[static_cast<std::size_t>(i)] ? 1 : 0;
        is_any = is_any || (is_faulty[static_cast<std::size_t>(i)] && !(may_be_thin && i == kThin));
      }
      if (is_any) ++failures_;
      if (is_told_ && !said.empty()) std::printf("    %s\n", said.c_str());
    }
  }

  void print(const std::string& family, const std::string& value) const {
    std::printf("%s, %s: %zu of %zu runs failed", family.c_str(), value.c_str(), failures_, runs_);
    for (std::size_t i = 0; i < kFaults; ++i)
      if (count_[i] > 0) std::printf("; %s %zu", kNames[i], count_[i]);
    std::printf("\n");
    std::fflush(stdout);
  }

  std::size_t runs() const { return runs_; }
  std::size_t failures() const { return failures_; }

 private:
  void look(const Result& result, bool is_union, std::array<bool, kFaults>& is_faulty) {
    RunControl control;
    const Measures measures = measures_of(result.mesh);
    const double tolerance = result.report.first_plane_tolerance;
    is_faulty[kPairs] =
        !self_intersections(result.mesh.positions.items(), result.mesh.faces.items(), {}, SearchLimits(1000), control)
             .pairs.empty() ||
        pairs_by_cgal(result.mesh, 1) > 0;
    is_faulty[kThin] = measures.narrowest < tolerance / 2;
    is_faulty[kMoved] = moved(result) > tolerance;
    is_faulty[kOpen] = is_union && measures.other_edges > 0;
  }

  static double moved(const Result& result) { return result.report.solids ? result.report.solids->moved : 0; }

  static void hold_against(const Known& known, const Result& result, std::array<bool, kFaults>& is_faulty) {
    const Measures measures = measures_of(result.mesh);
    is_faulty[kPieces] = known.shells >= 0 && measures.shells != static_cast<std::size_t>(known.shells);
    constexpr double kPlaces = 8 * 0x1p-52;
    const double slack =
        measures.area * (kPlaces * measures.largest + moved(result) + result.report.first_plane_tolerance);
    is_faulty[kVolume] = known.volume >= 0 && !(std::fabs(measures.volume - known.volume) <= slack + known.off);
  }

  const bool is_told_;
  std::size_t runs_ = 0, failures_ = 0;
  std::array<std::size_t, kFaults> count_{};
};

/// The extent of the runs.
struct Extent {
  int values = 20, turns = 20, moves = 100;
  bool is_told = true;
};

class Families {
 public:
  /// Input: `only` is empty, or part of the name of families and values.
  Families(const Extent& extent, std::string only) : extent_(extent), only_(std::move(only)), random_(base_seed(63)) {}

  /// Two equal faces with a gap (above 0) or an overlap (below 0) between them.
  void gaps() {
    for (int i = 0; i < extent_.values; ++i)
      for (const int sign : {1, -1}) {
        const double gap = sign * value(i, -13, -3);
        judge(sign > 0 ? "gap" : "overlap", text(gap), extent_.turns, [&](Judge& judge) {
          const Parts parts = turned({box(), shapes::moved(box(), {0, 0, 1 + gap})});
          const double tolerance = tolerance_of(parts);
          if (std::fabs(gap) < kSurely * tolerance)
            judge.run(parts, {2, 0, 1, 12}, 22);
          else if (std::fabs(gap) > tolerance / kSurely && gap > 0)
            judge.run(parts, {2, 0, 2, 24}, 24);
          else
            judge.run(parts, {2, std::fabs(gap), gap < 0 ? 1 : -1, gap < 0 ? 12 : -1});
        });
      }
  }

  /// Two equal faces, one of which is turned about a side, or about its middle.
  void tilts() {
    for (int i = 0; i < extent_.values; ++i)
      for (const bool is_about_side : {true, false}) {
        const double angle = value(i, -12, -2);
        judge(is_about_side ? "tilt about a side" : "tilt about the middle", text(angle), extent_.turns,
              [&](Judge& judge) {
                const Vec3 pivot{is_about_side ? 0 : -.5, -.5, 0};
                PolygonMesh upper =
                    shapes::rotated(shapes::moved(box(), pivot), {0, 1, 0}, -angle * 180 / std::numbers::pi);
                upper = shapes::moved(upper, Vec3{0, 0, 1} - pivot);
                const Parts parts = turned({box(), upper});
                const double tolerance = tolerance_of(parts);
                Known known{2, angle, is_about_side ? -1 : 1};
                if (angle < kSurely * tolerance) known = {2, angle, 1, 12};
                judge.run(parts, known, angle < kSurely * tolerance ? 22 : -1);
              });
      }
  }

  /// Parts of the table, each of them moved by some tolerances.
  void moves() {
    for (const SolidRow& row : rows()) {
      const double tolerance = tolerance_of(row.parts);
      for (const double factor : {.2, .5, 1., 2., 5., 100.}) {
        // Many cubes of which some are joined and others are not take seconds.
        if (!extent_.is_told && row.parts.size() > 20 && factor > .5 && factor < 100) continue;
        judge("moved row " + std::to_string(row.number), text(factor), extent_.moves, [&](Judge& judge) {
          Parts parts = turned(row.parts);
          const auto [triangles, of_union] = triangles_of(parts);
          for (PolygonMesh& part : parts) part = shapes::moved(part, factor * tolerance * direction());
          Known known{row.volume, row.area * factor * tolerance};
          if (factor < .5) known.triangles = of_union;
          if (factor < .5) known.shells = static_cast<long>(row.shells);
          judge.run(parts, known, factor < .5 ? triangles : -1, factor >= .5);
        });
      }
    }
  }

  /// Coordinates with few digits, or as float32.
  void rounded() {
    for (const SolidRow& row : rows())
      for (int digits = 2; digits <= 6; ++digits) {
        const bool is_float = digits == 2;
        judge("rounded row " + std::to_string(row.number), is_float ? "float32" : std::to_string(digits) + " digits",
              extent_.turns, [&](Judge& judge) {
                Parts parts = turned(row.parts);
                const double step = std::pow(10, digits);
                for (PolygonMesh& part : parts)
                  for (Vec3& p : part.positions.items())
                    for (int axis = 0; axis < 3; ++axis)
                      p[axis] = is_float ? static_cast<double>(static_cast<float>(p[axis]))
                                         : std::round(p[axis] * step) / step;
                judge.run(parts, {row.volume, row.area * (is_float ? 1e-6 : 1 / step)}, -1, true);
              });
      }
  }

  std::size_t runs() const { return runs_; }
  std::size_t failures() const { return failures_; }

 private:
  /// A gap counts as smaller than the tolerance below this share of it.
  static constexpr double kSurely = 0.9;

  static PolygonMesh box() { return shapes::box({1, 1, 1}); }

  /// The rows in which parts touch or lie on each other, and 27 cubes.
  static std::vector<SolidRow> rows() {
    std::vector<SolidRow> chosen;
    for (SolidRow& row : solid_rows())
      for (const int number : {3, 5, 7, 13, 14, 15})
        if (row.number == number) chosen.push_back(std::move(row));
    SolidRow cubes{27, "cubes", {}, 27, 54, 2};
    for (int i = 0; i < 27; ++i) cubes.parts.push_back(shapes::moved(box(), {i % 3 + 0., i / 3 % 3 + 0., i / 9 + 0.}));
    chosen.push_back(std::move(cubes));
    return chosen;
  }

  double value(int i, int first, int last) const {
    return std::pow(10, first + (last - first) * (i + 0.) / (extent_.values - 1));
  }
  static std::string text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return text;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)};
      if (norm(v) > .1 && norm(v) < 1) return (1 / norm(v)) * v;
    }
  }
  Parts turned(const Parts& parts) {
    const Vec3 axis = direction();
    const double degrees = random_.uniform(0, 360);
    Parts all;
    for (const PolygonMesh& part : parts) all.push_back(shapes::rotated(part, axis, degrees));
    return all;
  }
  static std::pair<long, long> triangles_of(const Parts& parts) {
    const auto count = [&](bool is_union) {
      return static_cast<long>(remeshed(as_one(parts), options_for(is_union)).mesh.faces.size());
    };
    return {count(false), count(true)};
  }

  void judge(const std::string& family, const std::string& value, int times, const std::function<void(Judge&)>& run) {
    if ((family + ", " + value).find(only_) == std::string::npos) return;
    Judge judge(extent_.is_told);
    for (int i = 0; i < times; ++i) run(judge);
    runs_ += judge.runs();
    failures_ += judge.failures();
    if (extent_.is_told || judge.failures() > 0) judge.print(family, value);
  }

  const Extent extent_;
  const std::string only_;
  Random random_;
  std::size_t runs_ = 0, failures_ = 0;
};

int run(int argc, char** argv) {
  Extent extent;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--short")
      extent = {5, 2, 3, false};
    else if (std::string_view(argv[i]) == "--times" && i + 1 < argc)
      extent.turns = extent.moves = std::atoi(argv[++i]);
    else
      only = argv[i];
  }
  Families families(extent, only);
  families.gaps();
  families.tilts();
  families.moves();
  families.rounded();
  std::printf("%zu of %zu runs failed\n", families.failures(), families.runs());
  return families.failures() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace remesh

int main(int argc, char** argv) { return remesh::run(argc, argv); }
